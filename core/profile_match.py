"""Is the face before the camera the one that a profile was made from?

Three measurements of one look by the generic aligner speak to that: how far the regressor is from
the aligner, how unlike the training pictures the face looks where the regressor puts it, and how
far the profile's face stays from the landmarks after pose and expression are fitted. Both distances
count in parts of what the model's mean face leaves over: blurred pictures, and an aligner that has
become better since the profile was made, then say nothing against anybody. The logarithms, each
against a level that own faces stay below and other faces stay above, add up as evidence does.
Turned heads say little: there the aligner itself is off.
"""

from dataclasses import dataclass

import numpy as np

from core.agreement import Look, Misfits


@dataclass(frozen=True, slots=True)
class MatchSettings:
    """How evidence is weighed.

    Measured on three performers and a real person before four profiles, medians of a video.

    Attributes:
        disagreement: Level of the regressor's distance from the aligner, in parts of the mean
            face's misfit; own faces have 0.7 to 0.75, others 1.3 to 3.5. An aligner with other
            mean errors than the profile was made with takes own faces to 0.85 to 1.3.
        residual: Level of the unlikeness; own 0.3 to 0.6, others 0.6 to 2.5.
        misfit: Level of the profile's face, in parts of the mean face's; own 0.45 to 0.55 (0.65
            to 0.75), others 0.7 to 1.4.
        usual_mean: Misfit of the mean face that counts at least: some people look like it.
        most_from_residual: Most that unlikeness may say against a match: a new lamp makes an own
            face unlike the pictures, too.
        turned_rad: A head turned so far says nothing.
        memory: Looks that are remembered.
        doubt: Weight of the doubt at the beginning, in looks.
        most: Most that one look may say.
        own: Evidence below which the face is the profile's.
        other: Evidence above which it is another's.
    """

    disagreement: float = 1.3
    residual: float = 0.68
    misfit: float = 0.8
    usual_mean: float = 0.009
    most_from_residual: float = 0.5
    turned_rad: float = 0.6
    memory: float = 6.0
    doubt: float = 0.7
    most: float = 1.5
    own: float = -0.25
    other: float = 0.05


class ProfileMatch:
    """Weighs looks one after the other; remembers the last few."""

    def __init__(self, settings: MatchSettings | None = None) -> None:
        self._settings = settings or MatchSettings()
        self.reset()

    @property
    def evidence(self) -> float:
        """Above 0 for another's face, below 0 for the profile's."""
        return self._sum / (self._weight + self._settings.doubt)

    @property
    def is_own(self) -> bool:
        """Whether the face is the profile's, as far as is known."""
        return self.evidence < self._settings.own

    @property
    def is_other(self) -> bool:
        """Whether the face is another's, as far as is known."""
        return self.evidence > self._settings.other

    @property
    def is_unsure(self) -> bool:
        """Whether another look would help: little is known, or the last one was odd."""
        return not self.is_own or self._last > self._settings.other

    def reset(self) -> None:
        """Know nothing: there was no face, so another may come."""
        self._sum, self._weight, self._last = 0.0, 0.0, 0.0

    def weigh(self, look: Look | None, misfits: Misfits, turned_rad: float) -> None:
        """Take a look into account.

        Args:
            look: What the aligner saw and the regressor made of it, None if that failed.
            misfits: Of the profile's face and the mean face in the same look.
            turned_rad: Angle between the head and one that faces the camera.
        """
        settings = self._settings
        weight = max(0.0, 1.0 - (turned_rad / settings.turned_rad) ** 2)
        # The older half as many looks ago as are remembered, the lighter.
        kept = 1.0 - weight / settings.memory
        said = strangeness(look, misfits, settings)
        self._last = weight * min(max(said, -settings.most), settings.most)
        self._sum = kept * self._sum + self._last
        self._weight = kept * self._weight + weight


def strangeness(look: Look | None, misfits: Misfits, settings: MatchSettings) -> float:
    """Return what one look says: above 0 for another's face, below 0 for the profile's."""
    mean = max(misfits.mean, settings.usual_mean)
    unfit = float(np.log(max(misfits.own, 1e-4) / mean / settings.misfit))
    if look is None:
        return unfit
    unlike = float(np.log(max(look.shape.residual, 1e-3) / settings.residual))
    apart = float(np.log(max(look.disagreement, 1e-4) / mean / settings.disagreement))
    return apart + min(unlike, settings.most_from_residual) + unfit
