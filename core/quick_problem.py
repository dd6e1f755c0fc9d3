"""What one step of the quick identity fit looks at, and how free the focal length is in it."""

from dataclasses import dataclass

import numpy as np

from core.fit_priors import expression_prior
from core.fit_space import FitSpace
from core.model_fit import Fit, FitSettings, choose_picks, observe, trust_in_motion
from core.picture_fit import Problem
from core.quick_frames import Keyframe
from core.quick_step import Guess, QuickProblem, quick_precision


@dataclass(frozen=True, slots=True)
class FocalSettings:
    """How free the focal length is.

    Attributes:
        spread: How far webcams are from the first guess, as a ratio; it stands against the
            landmarks of all frames.
        known_spread: The same where the focal length is known.
        turned_rad: Range of yaw or pitch among the frames at which it is as free as that.
        frontal_share: Share of the spread that it has while nobody has turned the head.
        dispersion: What the energy is divided by where uncertainty is told: landmark errors of
            one person agree from frame to frame, but are counted as independent.
    """

    spread: float = 0.2
    known_spread: float = 1e-4
    turned_rad: float = 1.0
    frontal_share: float = 0.15
    dispersion: float = 4.0


@dataclass(frozen=True, slots=True)
class FocalPrior:
    """What is known of the focal length beforehand.

    Attributes:
        usual_px: Its middle.
        known: Whether it is not to be touched.
        settings: How free it is.
    """

    usual_px: float
    known: bool
    settings: FocalSettings

    @property
    def widest(self) -> float:
        """Return the spread of the log focal length that turned heads may have."""
        return self.settings.known_spread if self.known else self.settings.spread

    def spread(self, frames: tuple[Keyframe, ...], angle_rad: float) -> float:
        """Return the spread of the log focal length, the narrower the less heads turned.

        What frontal faces seem to tell of it is the systematic error of the landmarks.

        Args:
            frames: What is looked at.
            angle_rad: Unit of the frames' places.
        """
        angles = angle_rad * np.stack([one.place[:2] for one in frames])
        share = float(np.ptp(angles, axis=0).max()) / self.settings.turned_rad
        return self.widest * min(max(share, self.settings.frontal_share), 1.0)

    def told(self, spread: float, prior_spread: float) -> float:
        """Return the spread to be told.

        What frontal faces do not tell is unknown, even though the prior was held narrow for them.

        Args:
            spread: What the equations promise.
            prior_spread: Spread of the prior among them.
        """
        honest = spread * float(np.sqrt(self.settings.dispersion))
        return min(honest * self.widest / prior_spread, self.widest)


def quick_problem(
    space: FitSpace, guess: Guess, frames: tuple[Keyframe, ...], settings: FitSettings,
    usual_focal_px: float, focal_spread: float,
) -> QuickProblem:  # fmt: skip
    """Return the problem at a guess: contour points and weights are those of its poses.

    Args:
        space: The model at the points of a fit.
        guess: Where the step starts.
        frames: The frames of `guess.state`.
        settings: Weights.
        usual_focal_px: Middle of the focal length's prior.
        focal_spread: Its spread, as a ratio.
    """
    state = guess.state
    picks = choose_picks(guess.face, state)
    observations = observe(guess.camera, state, [one.landmarks for one in frames], settings)
    fit = Fit(guess.person, state, picks, np.inf)
    observations = trust_in_motion(observations, guess.face, fit, settings)
    unprompted = np.full(state.expressions.shape, np.nan)
    prior = expression_prior(unprompted, settings.prior)
    precision = quick_precision(
        space.n_identities, settings.identity_weight, focal_spread, settings.offset_mm
    )
    pictures = Problem(guess.camera, observations, prior, settings.pictures)
    return QuickProblem(space, pictures, picks, precision, usual_focal_px)
