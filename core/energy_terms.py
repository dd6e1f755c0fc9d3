"""Weights and constants of the training-free solvers [FaceIt19, sec. 4], and what stands for them.

Where the paper's formulas cannot be used as they are printed (figures: performers' takes solved
with a face fitted to them, tests/benchmarks/energy_solvers.py):

* Eq. 12 is 0.03 in range and 2.5 outside, with walls 2e-5 wide between: beyond a wall nothing
  pulls back, and one coefficient that meets it refuses the step of all. Begun anew in each
  frame, a third of the 15 steps are refused, and coefficients above 0.3 are off by 0.26-0.28
  where plain bounds give 0.23; up to 0.02 of a coefficient stays out of range. A larger weight
  stops that, but an arctangent has long tails: they push resting coefficients up (error 0.006 ->
  0.013 at weight 100, 0.08 at 1e4), and so do wider walls (0.05 at 1e-3, 0.12 at 1e-2). We bound
  the coefficients instead: `box`. What is printed is kept for comparison.
* Eq. 9 adds rad^2 and mm^2. One weight that steadies the rotation (1e4) holds the translation
  back until the head is off by 2.8 degrees in motion; a weight each gives 0.3. It is one sum,
  not eta equal ones. Where a turn ends its prediction overshoots, more so with more weight.
* Eq. 10 has no pose: we project with the one just found.
* Eq. 11 has no derivative at 0: there it is smoothed over a thousandth.
* The weights of eq. 5-7 are not printed; energies here are in px^2 of a face of the usual size.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.fit_priors import USUAL_SPREAD, expression_spreads
from core.kernels.energy import BARRIER, BOX, JointTerms, PaperTerms
from core.pose_filter import LowPassSettings, PoseFilterSettings
from core.records import FloatArray

#: The filter believes a change of speed at once (8 Hz): it then needs less of it to follow.
_FILTER = PoseFilterSettings(
    rotation=LowPassSettings(0.3, 15.0, 8.0),
    across=LowPassSettings(0.3, 0.15, 8.0),
    along=LowPassSettings(0.3, 0.03, 8.0),
)


@dataclass(frozen=True, slots=True)
class PaperSettings:
    """How the paper's energy is minimised; energies in px^2 of a face of the usual size.

    Attributes:
        pose_iterations: Of Levenberg-Marquardt, rho.
        expression_iterations: Of Levenberg-Marquardt, epsilon.
        rotation_smoothness: Weight of eq. 9 per rad^2.
        translation_smoothness: Weight of eq. 9 per mm^2.
        sparsity: Weight of eq. 11.
        bounds: What keeps coefficients in [0, 1]: eq. 12, or plain bounds.
        barrier: Weight of eq. 12.
        barrier_a: Its walls stand at 1 - a and a.
        barrier_b: Their width.
        barrier_c: Makes it about zero in range.
    """

    pose_iterations: int = 15
    expression_iterations: int = 15
    rotation_smoothness: float = 1e4
    translation_smoothness: float = 0.1
    sparsity: float = 20.0
    bounds: Literal["barrier", "box"] = "box"
    barrier: float = 100.0
    barrier_a: float = 1.002
    barrier_b: float = 2e-5
    barrier_c: float = 2.5


@dataclass(frozen=True, slots=True)
class JointSettings:
    """How pose and expression are solved together; energies are in units of noise.

    Attributes:
        iterations: Most Gauss-Newton steps of a frame.
        noise_px: Standard deviation of a landmark from its own place, whatever its size.
        noise_mm: The part of it that grows with the face in the picture, at least and at most.
        noise_share: In between it is so much of the distance that solutions leave: a face of the
            wrong shape explains less, and its landmarks must not be taken at their word.
        noise_s: Time over which that distance is averaged.
        robust: Distance in noises at which a landmark counts a quarter.
        outline_weight: Of the outline's landmarks, which stand for no fixed point.
        slope: Cost of using a coefficient of the usual spread.
        spread_scale: Of the coefficients' usual spreads.
        memory: Usual change of a coefficient in a 30th of a second.
        escape: Change from the last frame at which a quarter of the memory is left.
    """

    iterations: int = 10
    noise_px: float = 0.3
    noise_mm: tuple[float, float] = (0.5, 2.5)
    noise_share: float = 0.7
    noise_s: float = 0.5
    robust: float = 4.0
    outline_weight: float = 0.4
    slope: float = 4.0
    spread_scale: float = 1.5
    memory: float = 0.12
    escape: float = 0.1


@dataclass(frozen=True, slots=True)
class EnergySettings:
    """How a frame is solved.

    Attributes:
        solver: `paper` or `joint`.
        n_landmarks: 68 as in the paper, or all 75.
        paper: Of the paper's solver.
        joint: Of ours.
        pose_filter: How the pose is filtered; None: not at all.
    """

    solver: Literal["paper", "joint"] = "joint"
    n_landmarks: int = 68
    paper: PaperSettings = field(default_factory=PaperSettings)
    joint: JointSettings = field(default_factory=JointSettings)
    pose_filter: PoseFilterSettings | None = _FILTER


def paper_terms(settings: PaperSettings) -> PaperTerms:
    """Return the paper's weights for the kernels."""
    smooth = np.repeat([settings.rotation_smoothness, settings.translation_smoothness], 3)
    barrier = [settings.barrier, settings.barrier_a, settings.barrier_b, settings.barrier_c]
    bounds = BOX if settings.bounds == "box" else BARRIER
    return PaperTerms(smooth, settings.sparsity, np.array(barrier), bounds)


def joint_terms(settings: JointSettings) -> JointTerms:
    """Return what the joint solver knows of coefficients, for the kernels."""
    spreads = expression_spreads()
    return JointTerms(
        robust=settings.robust,
        slope=settings.slope * USUAL_SPREAD / spreads,
        precision=(settings.spread_scale * spreads) ** -2.0,
        memory=np.full(len(spreads), settings.memory**-2.0),
        escape=settings.escape,
        jaw_open=EXPRESSION_NAMES.index("jawOpen"),
        mouth_close=EXPRESSION_NAMES.index("mouthClose"),
    )


def predicted_pose(history: FloatArray, times_s: FloatArray, time_s: float) -> FloatArray:
    """Return the pose (6,) without acceleration since the last two [FaceIt19, eq. 9].

    Where frames were dropped the step is as much longer; a long gap is not looked across.

    Args:
        history: (2, 6) the last pose, then the one before: rotation vector and translation.
        times_s: (2,) of them; NaN where there is none.
        time_s: Of the new frame.
    """
    before_s, step_s = times_s[0] - times_s[1], time_s - times_s[0]
    if not (before_s > 0 and step_s < 0.25 and before_s < 0.25):
        return np.array(history[0])
    ahead: FloatArray = history[0] + step_s / before_s * (history[0] - history[1])
    return ahead
