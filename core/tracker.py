"""From the regressed 3D shape of a frame to head pose, expression coefficients and gaze.

[Cao13, face tracking, eq. 11-14]: registration and coefficients in turn, two iterations, with a
Gaussian-mixture prior over this and the previous frames. Where we differ, and why:

* The energies are in units of noise: points count as independent with a known noise in mm, so
  that the prior's weight 1 means probability rather than mm^2.
* The coefficients are solved with small rigid motions projected out of the deltas. A jaw that
  opens pulls the registration with it; in turn-taking both creep towards the answer, this way two
  iterations reach it. The data term's Hessian stays constant.
* The mixture's components enter as one quadratic, weighted by how well each explains the data
  with the coefficients integrated out, so that the box-constrained problem is solved exactly by
  coordinate descent instead of BFGS. Weighted by the previous coefficients, a face at rest would
  stay in the component of rest.
* A sparsity term of the size of the noise in each coefficient's own direction: noise alone does
  not excite a shape that the points hardly see.
* mouthClose is at most jawOpen.
* Dropped frames are integrated out of the prior, and other frame rates resampled to its own.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from core.animation_prior import N_LAGS, AnimationPrior, conditional_tables
from core.arkit import EXPRESSION_NAMES
from core.expression_history import History
from core.gaze import GazeFilter, GazeSettings, pupil_directions, vergence_rad
from core.geometry import quaternion_from_matrix
from core.kernels.tracking import FaceTables, PriorTables, Workspace, track
from core.landmarks import GROUPS
from core.pose_filter import PoseFilter, PoseFilterSettings
from core.records import FloatArray, freeze

#: The right eye's blink coefficient, then the left one's.
#: The right, then the left one.
BLINKS = [EXPRESSION_NAMES.index("eyeBlinkRight"), EXPRESSION_NAMES.index("eyeBlinkLeft")]
#: Where the eyes look (2, 2) in rad when the head has a pose (4, 3).
Looks = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class TrackerModel:
    """The user's face as far as the tracker needs it.

    Attributes:
        neutral_mm: (L, 3) the shape's landmarks in the head frame, without the pupils.
        deltas_mm: (B, L, 3).
        eye_centers_mm: (2, 3) eyeball centres, the right eye first.
        pupil_radii_mm: (2,) distance of each pupil from its eyeball's centre.
    """

    neutral_mm: FloatArray
    deltas_mm: FloatArray
    eye_centers_mm: FloatArray
    pupil_radii_mm: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            neutral_mm=(np.float64, ("L", 3)),
            deltas_mm=(np.float64, ("B", "L", 3)),
            eye_centers_mm=(np.float64, (2, 3)),
            pupil_radii_mm=(np.float64, (2,)),
        )


@dataclass(frozen=True, slots=True)
class TrackerSettings:
    """How a frame is solved.

    Attributes:
        noise_mm: Standard deviation of a point's coordinate from frame to frame, at
            `distance_mm`; it grows with the distance, being one of pixels.
        distance_mm: See above.
        prior_weight: Of -log p, w_prior of [Cao13, eq. 14].
        sparsity: Threshold of a coefficient in units of its own noise.
        brow_weight: Weight of the brows' points; only ratios count.
        lid_weight: Of the lids' points.
        nose_weight: Of the nose's points.
        lip_weight: Of the lips' points.
        replacement_weight: Of the 15 points on cheeks, forehead and jaw [Cao13, 3].
        iterations: Registrations and solves in turn.
        pose_filter: How the pose is filtered.
        gaze: How gaze is measured and filtered.
    """

    noise_mm: float = 0.2
    distance_mm: float = 600.0
    prior_weight: float = 1.0
    sparsity: float = 0.3
    brow_weight: float = 1.5
    lid_weight: float = 2.0
    nose_weight: float = 1.0
    lip_weight: float = 2.0
    replacement_weight: float = 0.6
    iterations: int = 2
    pose_filter: PoseFilterSettings = field(default_factory=PoseFilterSettings)
    gaze: GazeSettings = field(default_factory=GazeSettings)


class TrackedFace(NamedTuple):
    """The solved face of one frame: rotation (4,), translation (3,), (B,), (2, 2)."""

    rotation_wxyz: FloatArray
    translation_mm: FloatArray
    expression: FloatArray
    gaze_rad: FloatArray


@dataclass(frozen=True, slots=True)
class TrackerState:
    """What the last step did besides its result.

    Attributes:
        pose: (4, 3) unfiltered rotation matrix, then the translation in mm.
        first_lag: First previous frame that the prior was conditioned on; N_LAGS + 1 = none.
        rms_mm: Weighted distance of the solved face from the points, per coordinate.
    """

    pose: FloatArray
    first_lag: int
    rms_mm: float


def point_weights(settings: TrackerSettings, n_points: int) -> FloatArray:
    """Return the weight of every landmark of the shape, mean 1."""
    weights = np.full(n_points, settings.replacement_weight)
    by_group = {
        "brow": settings.brow_weight,
        "eye": settings.lid_weight,
        "nose": settings.nose_weight,
        "lips": settings.lip_weight,
    }
    for name, points in GROUPS.items():
        if name != "contour":
            weights[list(points)] = by_group[name.split("_")[0]]
    return np.asarray(weights / weights.mean())


def without_rigid_motion(
    neutral: FloatArray, deltas: FloatArray, weights: FloatArray
) -> FloatArray:
    """Return the deltas (B, L, 3) less their weighted least-squares rigid parts.

    Args:
        neutral: (L, 3) the shape about which rotations are linearised.
        deltas: (B, L, 3).
        weights: (L,).
    """
    centred = neutral - np.average(neutral, axis=0, weights=weights)
    motions = [np.broadcast_to(axis, centred.shape) for axis in np.eye(3)]
    motions += [np.cross(axis, centred) for axis in np.eye(3)]
    root = np.sqrt(np.repeat(weights, 3))
    basis, _ = np.linalg.qr((np.stack(motions).reshape(6, -1) * root).T)
    flat = deltas.reshape(deltas.shape[0], -1) * root
    return np.asarray((flat - flat @ basis @ basis.T) / root).reshape(deltas.shape)


def face_tables(model: TrackerModel, settings: TrackerSettings) -> FaceTables:
    """Return the constant arrays of the solve."""
    weights = point_weights(settings, model.neutral_mm.shape[0])
    free = without_rigid_motion(model.neutral_mm, model.deltas_mm, weights)
    directions = free * (weights / settings.noise_mm**2)[:, None]
    gram = np.einsum("alx,blx->ab", directions, free)
    return FaceTables(
        neutral=np.array(model.neutral_mm),
        deltas=np.array(model.deltas_mm),
        weights=weights,
        directions=directions,
        gram=0.5 * (gram + gram.T),
        sparsity=settings.sparsity * np.sqrt(np.diag(gram)),
        jaw_open=EXPRESSION_NAMES.index("jawOpen"),
        mouth_close=EXPRESSION_NAMES.index("mouthClose"),
    )


def workspace_for(face: FaceTables, prior: PriorTables) -> Workspace:
    """Return memory for solving frames."""
    n_coefficients, n_points = face.deltas.shape[:2]
    components = prior.log_weights.shape
    return Workspace(
        shape=np.zeros((n_points, 3)),
        quartic=np.zeros((2, 4, 4)),
        pull=np.zeros(n_coefficients),
        hessian=np.zeros((n_coefficients, n_coefficients)),
        gradient=np.zeros(n_coefficients),
        log_weights=np.zeros(components),
        means=np.zeros((*components, prior.members.shape[1])),
        shares=np.zeros(components[1]),
        difference=np.zeros(max(prior.maps.shape[2:])),
        residual=np.zeros(n_coefficients),
        pulled=np.zeros(prior.members.shape[1]),
        factor=np.zeros((prior.members.shape[1], prior.members.shape[1])),
    )


class Tracker:
    """Solves the frames of one user's video; remembers the last few."""

    def __init__(
        self, model: TrackerModel, prior: AnimationPrior, settings: TrackerSettings | None = None
    ) -> None:
        self._settings = settings or TrackerSettings()
        self._model = model
        self._face = face_tables(model, self._settings)
        self._priors = [conditional_tables(prior, lag) for lag in range(1, N_LAGS + 2)]
        self._work = workspace_for(self._face, self._priors[0])
        self._expression, self._pose = np.zeros(len(EXPRESSION_NAMES)), np.zeros((4, 3))
        self._history = History(len(EXPRESSION_NAMES), prior.frame_s)
        self._pose_filter = PoseFilter(self._settings.pose_filter)
        self._gaze_filter = GazeFilter(self._settings.gaze)
        self._last_s, self._first_lag, self._rms_mm = -np.inf, N_LAGS + 1, 0.0

    @property
    def state(self) -> TrackerState:
        """What the last step did."""
        return TrackerState(self._pose.copy(), self._first_lag, self._rms_mm)

    def reset(self) -> None:
        """Forget the past: the face was lost, or the video changed."""
        self._history.clear()
        self._pose_filter.reset()
        self._gaze_filter.reset()
        self._expression[:] = 0
        self._last_s = -np.inf

    def step(
        self, points_mm: FloatArray, time_s: float, confidence: float = 1.0,
        looks: Looks | None = None,
    ) -> TrackedFace:  # fmt: skip
        """Return pose, expression and gaze of one frame.

        Args:
            points_mm: (L + 2, 3) the regressed shape in the camera frame, pupils last.
            time_s: Time of the frame; earlier than the last one's starts anew.
            confidence: In (0, 1], scales the data against the prior.
            looks: Tells where the eyes look (2, 2) in rad under the pose (4, 3) just found; without
                it the pupils among the points do.

        Raises:
            ValueError: Another number of points, or one that is not finite.
        """
        if time_s <= self._last_s:
            self.reset()
        self._last_s = time_s
        points = np.ascontiguousarray(points_mm, float)
        self._check(points)
        self._solve(points[:-2], time_s, confidence)
        self._history.append(time_s, self._expression)
        rotation = quaternion_from_matrix(self._pose[:3])
        rotation, translation = self._pose_filter.step(rotation, self._pose[3], time_s)
        directions = self._pupil_directions(points) if looks is None else looks(self._pose)
        inward = vergence_rad(self._model.eye_centers_mm, float(np.linalg.norm(translation)))
        gaze = self._gaze_filter.step(directions, self._expression[BLINKS], time_s, inward)
        return TrackedFace(rotation, translation, self._expression.copy(), gaze)

    def _pupil_directions(self, points: FloatArray) -> FloatArray:
        model = self._model
        return pupil_directions(points[-2:], self._pose, model.eye_centers_mm, model.pupil_radii_mm)

    def _check(self, points: FloatArray) -> None:
        """Refuse points that would spoil the history."""
        promised = (self._model.neutral_mm.shape[0] + 2, 3)
        if points.shape != promised or not np.isfinite(points).all():
            raise ValueError(f"tracker needs {promised[0]} finite points, got {points.shape}")

    def _solve(self, points: FloatArray, time_s: float, confidence: float) -> None:
        """Find pose and expression of the points."""
        self._first_lag = self._history.first_lag(time_s)
        distance_mm = max(float(points[:, 2].mean()), 1.0)
        data_weight = confidence * (self._settings.distance_mm / distance_mm) ** 2
        amounts = np.array([data_weight, self._settings.prior_weight])
        self._rms_mm = track(
            self._face,
            self._priors[self._first_lag - 1],
            points,
            self._history.sample(time_s, self._first_lag),
            amounts,
            self._settings.iterations,
            self._work,
            self._expression,
            self._pose,
        )
