"""Solves one frame's landmarks for pose and expression, by either solver [FaceIt19, sec. 4]."""

from typing import NamedTuple

import numpy as np

from core.energy_face import ROBUST, landmark_rows, solver_face, workspace_for
from core.energy_terms import EnergySettings, joint_terms, paper_terms
from core.fit_space import Face
from core.geometry import rotation_vector_from_matrix
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
from core.posit import pose_from_points
from core.records import Camera, FloatArray

#: A face at rest where people usually sit.
USUAL_MM = (0.0, 0.0, 600.0)
#: Landmarks less sure than this are not used for a first pose, unless there are too few.
_SURE, _FEW = 0.3, 6
#: Distance at which a landmark is half explained, mm at the face.
_NEAR_MM = 6.0
#: Landmarks within so few px are no face.
_SMALLEST_PX = 3.0
#: Where a head can be, mm, and how far it can turn from the camera, as a cosine.
_NEAREST_MM, _FURTHEST_MM, _TURNED_AWAY = 80.0, 2e4, -0.2


class Past(NamedTuple):
    """What a frame inherits.

    Attributes:
        predicted: (6,) rotation vector and translation without acceleration.
        frames: Time since the last frame, in 30ths of a second.
        left_mm: Distance that solutions usually leave.
    """

    predicted: FloatArray
    frames: float
    left_mm: float


class Fit(NamedTuple):
    """How well a solution explains the landmarks, weighted by their confidence.

    Attributes:
        rms_px: Root mean square distance.
        near: Share of the landmarks that are near, in (0, 1]; one at `_NEAR_MM` counts a half.
    """

    rms_px: float
    near: float


class FaceSolver:
    """Holds a face, the landmarks of a frame, and the solution.

    Attributes:
        pose: (4, 3) rotation matrix, then the translation in mm.
        expression: (B,) in [0, 1].
        steps_taken: Of the paper's expression solver, that lowered the energy.
        outside: How far the furthest coefficient was out of [0, 1] before it was put back.
    """

    def __init__(self, face: Face, camera: Camera, settings: EnergySettings) -> None:
        self._settings = settings
        self._rows = landmark_rows(settings.n_landmarks)
        self._paper, self._joint = paper_terms(settings.paper), joint_terms(settings.joint)
        self.load(face, camera)
        n_fitted, n_shapes = len(self._rows), len(face.deltas_mm)
        self._points, self._weights = np.zeros((2, n_fitted)), np.zeros(n_fitted)
        self._last, self._shape = np.zeros(n_shapes), np.zeros((3, N_LANDMARKS))
        self.pose, self.expression = np.zeros((4, 3)), np.zeros(n_shapes)
        self.steps_taken, self.outside = 0, 0.0
        self.forget()

    def load(self, face: Face, camera: Camera) -> None:
        """Go on with this face and camera."""
        self._face, self._camera = solver_face(face, self._rows), camera
        self._work = workspace_for(self._face.tables)
        self._pinhole = np.array([camera.focal_px, *camera.center_px])

    def forget(self) -> None:
        """Go back to a face at rest before the camera."""
        self.expression[:] = 0
        self.pose[:3], self.pose[3] = np.eye(3), USUAL_MM

    def take(self, points_px: FloatArray, confidence: FloatArray) -> None:
        """Take the fitted ones of a frame's landmarks (75, 2) with their confidences (75,)."""
        self._points[:] = points_px[self._rows].T
        self._weights[:] = confidence[self._rows]

    @property
    def mm_per_px(self) -> float:
        """Size at the face of a pixel."""
        return float(self.pose[3, 2] / self._pinhole[0])

    @property
    def sees_something(self) -> bool:
        """Whether there are landmarks to be seen, and not all in one place."""
        total = float(self._weights.sum())
        if total <= 0:
            return False
        offsets = self._points - (self._points @ self._weights / total)[:, None]
        return bool(np.sum(offsets**2 @ self._weights) > total * _SMALLEST_PX**2)

    @property
    def is_possible(self) -> bool:
        """Whether a head can be where the solution has it."""
        return bool(
            np.isfinite(self.pose).all()
            and _NEAREST_MM < self.pose[3, 2] < _FURTHEST_MM
            and self.pose[2, 2] > _TURNED_AWAY
        )

    def pose_row(self) -> FloatArray:
        """Return rotation vector and translation (6,) of the solution."""
        return np.concatenate([rotation_vector_from_matrix(self.pose[:3]), self.pose[3]])

    def points_mm(self) -> FloatArray:
        """Return internal landmarks and replacement points (75, 3) of the solution."""
        express(self._face.shape_neutral, self._face.shape_deltas, self.expression, self._shape)
        return np.asarray((self.pose[:3] @ self._shape).T + self.pose[3])

    def start(self) -> None:
        """Find a first pose from the landmarks that expressions hardly move."""
        robust = np.isin(self._rows, ROBUST) & (self._weights > _SURE)
        if robust.sum() < _FEW:
            robust = self._weights > 0
        weights = np.where(robust, self._weights, 0.0)
        self._place_facing()
        rotation, place = pose_from_points(
            self._camera, self._face.tables.neutral.T, self._points.T, weights
        )
        if np.isfinite(place).all() and place[2] > _NEAREST_MM and rotation[2, 2] > 0:
            self.pose[:3], self.pose[3] = rotation, place
        self._fit_pose(weights, None)

    def solve(self, past: Past | None) -> Fit:
        """Solve the frame from the solution so far.

        Args:
            past: Of the frames before; None: there is none.
        """
        if self._settings.solver == "paper":
            self._solve_in_turn(past)
        else:
            self._solve_jointly(past)
        self.outside = float(max(-self.expression.min(), self.expression.max() - 1.0, 0.0))
        np.clip(self.expression, 0.0, 1.0, out=self.expression)
        tables = self._face.tables
        express(tables.neutral, tables.deltas, self.expression, self._work.shape)
        self._work.root[:] = 1.0
        reproject(self._points, self._pinhole, self.pose, self._work)
        squares, share = np.sum(self._work.residual**2, axis=0), self._weights / self._weights.sum()
        near = 1.0 / (1.0 + squares * (self.mm_per_px / _NEAR_MM) ** 2)
        return Fit(float(np.sqrt(squares @ share)), float(near @ share))

    def _place_facing(self) -> None:
        """Put a face that looks into the camera where the landmarks are, as large as they are."""
        tables, share = self._face.tables, self._weights / self._weights.sum()
        self.forget()
        self._pick_outline()
        middle, seen = tables.neutral @ share, self._points @ share
        size_mm = np.sqrt(np.sum((tables.neutral[:2] - middle[:2, None]) ** 2 @ share))
        size_px = np.sqrt(np.sum((self._points - seen[:, None]) ** 2 @ share))
        depth = self._pinhole[0] * size_mm / size_px
        across = (seen - self._pinhole[1:]) * depth / self._pinhole[0]
        self.pose[3] = np.array([*across, depth]) - middle

    def _pick_outline(self) -> None:
        pick_outline(self._face.tables, self.pose, self.expression, self._work)

    def _fit_pose(self, weights: FloatArray, predicted: FloatArray | None) -> None:
        """Solve [FaceIt19, eq. 8 and 9]; without a prediction only eq. 8."""
        vector, terms = self.pose_row(), self._paper
        if predicted is None:
            terms, predicted = terms._replace(smooth=np.zeros(6)), vector
        self._work.root[:] = np.sqrt(weights) * self.mm_per_px
        fit_pose(
            self._face.tables, self._points, self._pinhole, terms, predicted, self.expression,
            self._settings.paper.pose_iterations, self._work, vector,
        )  # fmt: skip
        unpack_pose(vector, self.pose)

    def _solve_in_turn(self, past: Past | None) -> None:
        self._pick_outline()
        self._fit_pose(self._weights, None if past is None else past.predicted)
        self._pick_outline()
        self._work.root[:] = np.sqrt(self._weights) * self.mm_per_px
        self.steps_taken = fit_expression(
            self._face.tables, self._points, self._pinhole, self._paper, self.pose,
            self._settings.paper.expression_iterations, self._work, self.expression,
        )  # fmt: skip

    def _solve_jointly(self, past: Past | None) -> None:
        settings, terms = self._settings.joint, self._joint
        least_mm, noise_mm = settings.noise_mm
        if past is None:
            terms = terms._replace(memory=np.zeros_like(terms.memory))
        else:
            terms = terms._replace(memory=terms.memory / past.frames)
            noise_mm = min(max(settings.noise_share * past.left_mm, least_mm), noise_mm)
        weights = self._weights / (settings.noise_px**2 + (noise_mm / self.mm_per_px) ** 2)
        weights[-len(self._face.tables.fixed) :] *= settings.outline_weight
        self._last[:] = self.expression
        fit_jointly(
            self._face.tables, self._points, self._pinhole, weights, terms, self._last,
            settings.iterations, self._work, self.pose, self.expression,
        )  # fmt: skip
