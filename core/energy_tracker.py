"""The training-free tracker: 2D landmarks -> head pose and expression [FaceIt19, sec. 4].

Two solvers. `paper` is the paper's: pose, then expression, each by Levenberg-Marquardt.
`joint` is ours: both move together by Gauss-Newton, with bounds instead of a barrier, a robust
distance weighted by the aligner's confidence, and a memory that a quick movement escapes.
"""

from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np

from core.energy_face import ROBUST, landmark_rows, solver_face, workspace_for
from core.energy_terms import (
    JointSettings,
    PaperSettings,
    joint_terms,
    paper_terms,
    predicted_pose,
)
from core.fit_space import Face
from core.geometry import quaternion_from_matrix, rotation_vector_from_matrix
from core.kernels.energy import (
    express,
    fit_expression,
    fit_jointly,
    fit_pose,
    pick_outline,
    reproject,
    unpack_pose,
)
from core.landmarks import N_LANDMARKS
from core.pose_filter import PoseFilter, PoseFilterSettings
from core.posit import pose_from_points
from core.records import Camera, FloatArray

#: A face at rest where people usually sit.
_USUAL_MM = np.array([0.0, 0.0, 600.0])
#: Distance of the landmarks from the solution, in mm at the face, that is good, and hopeless.
_GOOD_MM, _HOPELESS_MM = 4.0, 14.0
#: Landmarks less sure than this are not used for a first pose.
_SURE = 0.3
#: Landmarks within so few px are no face.
_SMALLEST_PX = 3.0
#: Where a head can be, mm, and how far it can turn from the camera, as a cosine.
_NEAREST_MM, _FURTHEST_MM, _TURNED_AWAY = 80.0, 2e4, -0.2


class Solved(NamedTuple):
    """The solved face of one frame.

    Attributes:
        rotation_wxyz: (4,) model to camera.
        translation_mm: (3,).
        expression: (B,) in [0, 1].
        rms_px: Distance of the landmarks from the solution, weighted by their confidence.
        confidence: In [0, 1].
    """

    rotation_wxyz: FloatArray
    translation_mm: FloatArray
    expression: FloatArray
    rms_px: float
    confidence: float


@dataclass(frozen=True, slots=True)
class SolverState:
    """What the last step did besides its result.

    Attributes:
        steps_taken: Of the paper's expression solver, that lowered the energy.
        outside: How far the furthest coefficient was out of [0, 1] before it was put back.
        pose: (4, 3) unfiltered rotation matrix, then the translation in mm.
    """

    steps_taken: int
    outside: float
    pose: FloatArray


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
    pose_filter: PoseFilterSettings | None = field(default_factory=PoseFilterSettings)


class EnergyTracker:
    """Solves the frames of a video without any training; remembers the last few."""

    def __init__(self, face: Face, camera: Camera, settings: EnergySettings | None = None) -> None:
        self._settings = settings or EnergySettings()
        self._rows = landmark_rows(self._settings.n_landmarks)
        self._paper, self._joint = (
            paper_terms(self._settings.paper),
            joint_terms(self._settings.joint),
        )
        self._filter = PoseFilter(self._settings.pose_filter)
        self._face, self._camera = solver_face(face, self._rows), camera
        self._load(face, camera)
        n_fitted, n_shapes = len(self._rows), len(face.deltas_mm)
        self._points, self._weights = np.zeros((2, n_fitted)), np.zeros(n_fitted)
        self._pose, self._expression = np.zeros((4, 3)), np.zeros(n_shapes)
        self._last, self._shape = np.zeros(n_shapes), np.zeros((3, N_LANDMARKS))
        self._shown_wxyz, self._shown_mm = np.array([1.0, 0, 0, 0]), _USUAL_MM.copy()
        self._history, self._times_s = np.zeros((2, 6)), np.full(2, np.nan)
        self._steps_taken, self._outside = 0, 0.0
        self.reset()

    @property
    def state(self) -> SolverState:
        """What the last step did."""
        return SolverState(self._steps_taken, self._outside, self._pose.copy())

    def use(self, face: Face, camera: Camera) -> None:
        """Go on with another face, focal length or size of pictures; the past is kept.

        A face seen with a longer lens is as much further away.
        """
        before = self._camera.focal_px / self._camera.size_px[0]
        stretch = camera.focal_px / camera.size_px[0] / before
        self._load(face, camera)
        self._pose[3, 2] *= stretch
        self._shown_mm[2] *= stretch
        self._history[:, 5] *= stretch
        self._filter.stretch(np.array([1.0, 1.0, stretch]))

    def reset(self) -> None:
        """Forget the past: the face was lost, or the video changed."""
        self._times_s[:] = np.nan
        self._expression[:] = 0
        self._last[:] = 0
        self._pose[:3], self._pose[3] = np.eye(3), _USUAL_MM
        self._filter.reset()

    def step(self, points_px: FloatArray, confidence: FloatArray, time_s: float) -> Solved:
        """Return pose and expression of one frame.

        Args:
            points_px: (75, 2) landmarks.
            confidence: (75,) in [0, 1]; 0 leaves a landmark out.
            time_s: Time of the frame; not later than the last one's starts anew.

        Raises:
            ValueError: Other numbers of points, or one that is not finite.
        """
        self._take(points_px, confidence)
        if time_s <= self._times_s[0]:
            self.reset()
        if not self._looks_like_something():
            return self._solved(0.0, 0.0)
        rms_px = self._track(time_s)
        if not self._is_possible():
            self.reset()
            return self._solved(rms_px, 0.0)
        self._remember(time_s)
        quality = (_HOPELESS_MM - rms_px * self._mm_per_px()) / (_HOPELESS_MM - _GOOD_MM)
        return self._solved(
            rms_px, float(np.clip(quality, 0, 1) * np.clip(confidence, 0, 1).mean())
        )

    def points_mm(self) -> FloatArray:
        """Return internal landmarks and replacement points (75, 3) of the last solution."""
        express(self._face.shape_neutral, self._face.shape_deltas, self._expression, self._shape)
        return np.asarray((self._pose[:3] @ self._shape).T + self._pose[3])

    def _load(self, face: Face, camera: Camera) -> None:
        """Make the tables of a face and a camera."""
        self._face = solver_face(face, self._rows)
        self._work = workspace_for(self._face.tables)
        self._camera = camera
        self._pinhole = np.array([camera.focal_px, *camera.center_px])

    def _take(self, points_px: FloatArray, confidence: FloatArray) -> None:
        """Check the landmarks of a frame and keep those that are fitted."""
        if points_px.shape != (N_LANDMARKS, 2) or confidence.shape != (N_LANDMARKS,):
            raise ValueError(
                f"energy tracker needs {N_LANDMARKS} points and confidences, got "
                f"{points_px.shape} and {confidence.shape}"
            )
        if not (np.isfinite(points_px).all() and np.isfinite(confidence).all()):
            raise ValueError("energy tracker needs finite points and confidences")
        self._points[:] = points_px[self._rows].T
        self._weights[:] = confidence[self._rows]

    def _mm_per_px(self) -> float:
        return float(self._pose[3, 2] / self._pinhole[0])

    def _looks_like_something(self) -> bool:
        """Return whether there are landmarks to be seen, and not all in one place."""
        total = float(self._weights.sum())
        if total <= 0:
            return False
        offsets = self._points - (self._points @ self._weights / total)[:, None]
        return bool(np.sum(offsets**2 @ self._weights) > total * _SMALLEST_PX**2)

    def _is_possible(self) -> bool:
        """Return whether a head can be where the solver put it."""
        return bool(
            np.isfinite(self._pose).all()
            and _NEAREST_MM < self._pose[3, 2] < _FURTHEST_MM
            and self._pose[2, 2] > _TURNED_AWAY
        )

    def _track(self, time_s: float) -> float:
        """Solve a frame from the last one, or anew if that fails; return the distance in px."""
        if not np.isnan(self._times_s[0]):
            rms_px = self._solve(time_s)
            if self._is_possible() and rms_px * self._mm_per_px() < _HOPELESS_MM:
                return rms_px
            self.reset()
        self._start()
        return self._solve(time_s)

    def _start(self) -> None:
        """Find a first pose from the landmarks that expressions hardly move."""
        robust = np.isin(self._rows, ROBUST) & (self._weights > _SURE)
        if robust.sum() < 6:
            robust = self._weights > 0
        weights = np.where(robust, self._weights, 0.0)
        self._place_facing()
        rotation, place = pose_from_points(
            self._camera, self._face.tables.neutral.T, self._points.T, weights
        )
        if np.isfinite(place).all() and place[2] > _NEAREST_MM and rotation[2, 2] > 0:
            self._pose[:3], self._pose[3] = rotation, place
        self._fit_pose(weights, self._row(), free=True)

    def _place_facing(self) -> None:
        """Put a face that looks into the camera where the landmarks are, as large as they are."""
        tables, share = self._face.tables, self._weights / self._weights.sum()
        self._pose[:3], self._pose[3] = np.eye(3), _USUAL_MM
        pick_outline(tables, self._pose, self._expression, self._work)
        middle, seen = tables.neutral @ share, self._points @ share
        size_mm = np.sqrt(np.sum((tables.neutral[:2] - middle[:2, None]) ** 2 @ share))
        size_px = np.sqrt(np.sum((self._points - seen[:, None]) ** 2 @ share))
        depth = self._pinhole[0] * size_mm / size_px
        across = (seen - self._pinhole[1:]) * depth / self._pinhole[0]
        self._pose[3] = np.array([*across, depth]) - middle

    def _row(self) -> FloatArray:
        """Return rotation vector and translation in a row."""
        return np.concatenate([rotation_vector_from_matrix(self._pose[:3]), self._pose[3]])

    def _fit_pose(self, weights: FloatArray, predicted: FloatArray, *, free: bool) -> None:
        """Solve the paper's pose; free of the past or not."""
        terms = self._paper._replace(smooth=np.zeros(6)) if free else self._paper
        vector = self._row()
        self._work.root[:] = np.sqrt(weights) * self._mm_per_px()
        fit_pose(
            self._face.tables, self._points, self._pinhole, terms, predicted, self._expression,
            self._settings.paper.pose_iterations, self._work, vector,
        )  # fmt: skip
        unpack_pose(vector, self._pose)

    def _solve(self, time_s: float) -> float:
        """Solve a frame from where the last one ended; return the distance left in px."""
        if self._settings.solver == "paper":
            pick_outline(self._face.tables, self._pose, self._expression, self._work)
            self._solve_in_turn(time_s)
        else:
            self._solve_jointly()
        self._outside = float(max(-self._expression.min(), self._expression.max() - 1.0, 0.0))
        np.clip(self._expression, 0.0, 1.0, out=self._expression)
        tables = self._face.tables
        express(tables.neutral, tables.deltas, self._expression, self._work.shape)
        self._work.root[:] = np.sqrt(self._weights)
        square = reproject(self._points, self._pinhole, self._pose, self._work)
        return float(np.sqrt(square / self._weights.sum()))

    def _solve_in_turn(self, time_s: float) -> None:
        free = bool(np.isnan(self._times_s[0]))
        predicted = predicted_pose(self._history, self._times_s, time_s)
        self._fit_pose(self._weights, predicted, free=free)
        pick_outline(self._face.tables, self._pose, self._expression, self._work)
        self._work.root[:] = np.sqrt(self._weights) * self._mm_per_px()
        self._steps_taken = fit_expression(
            self._face.tables, self._points, self._pinhole, self._paper, self._pose,
            self._settings.paper.expression_iterations, self._work, self._expression,
        )  # fmt: skip

    def _solve_jointly(self) -> None:
        settings = self._settings.joint
        noise_px = np.hypot(settings.noise_px, settings.noise_mm / self._mm_per_px())
        self._last[:] = self._expression
        weights = self._weights / noise_px**2
        weights[-len(self._face.tables.fixed) :] *= settings.outline_weight
        fit_jointly(
            self._face.tables, self._points, self._pinhole, weights, self._joint, self._last,
            settings.iterations, self._work, self._pose, self._expression,
        )  # fmt: skip

    def _remember(self, time_s: float) -> None:
        """Keep the pose for the next frames, and filter what is shown."""
        self._history[1], self._times_s[1] = self._history[0], self._times_s[0]
        self._history[0], self._times_s[0] = self._row(), time_s
        self._shown_wxyz = quaternion_from_matrix(self._pose[:3])
        self._shown_mm = self._pose[3].copy()
        if self._settings.pose_filter is not None:
            self._shown_wxyz, self._shown_mm = self._filter.step(
                self._shown_wxyz, self._shown_mm, time_s
            )

    def _solved(self, rms_px: float, confidence: float) -> Solved:
        return Solved(
            self._shown_wxyz.copy(), self._shown_mm.copy(), self._expression.copy(), rms_px,
            confidence,
        )  # fmt: skip
