"""The training-free tracker: 2D landmarks -> head pose and expression [FaceIt19, sec. 4].

Two solvers. `paper` is the paper's: pose, then expression, each by Levenberg-Marquardt.
`joint` is ours: both move together by Gauss-Newton, with bounds instead of a barrier, a robust
distance weighted by the aligner's confidence, and a memory that a quick movement escapes.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from core.energy_solver import USUAL_MM, FaceSolver, Fit, Past
from core.energy_terms import EnergySettings, predicted_pose
from core.fit_space import Face
from core.geometry import quaternion_from_matrix
from core.landmarks import N_LANDMARKS
from core.pose_filter import PoseFilter
from core.records import Camera, FloatArray

__all__ = ["EnergySettings", "EnergyTracker", "Solved", "SolverState"]

#: Share of near landmarks at which a solution is hopeless, doubtful, and good. A hand over the
#: mouth leaves two thirds; a head that is elsewhere leaves a quarter.
_HOPELESS, _DOUBTFUL, _GOOD = 0.35, 0.55, 0.7
#: Distance beyond twice the usual one that makes a solution doubtful, too.
_SUDDEN_MM = 3.0
#: A new beginning must explain so much more than going on.
_BETTER = 0.05
#: The distance that is expected of a face of which nothing is known, mm.
_FIRST_MM = 3.0
#: Frame rate for which the settings are given.
_USUAL_FPS = 30.0


class Solved(NamedTuple):
    """The solved face of one frame.

    Attributes:
        rotation_wxyz: (4,) model to camera.
        translation_mm: (3,).
        expression: (B,) in [0, 1].
        rms_px: Distance of the landmarks from the solution, weighted by their confidence.
        confidence: In [0, 1]; 0: no face can be there, the rest is the last one's.
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


class EnergyTracker:
    """Solves the frames of a video without any training; remembers the last few."""

    def __init__(self, face: Face, camera: Camera, settings: EnergySettings | None = None) -> None:
        self._settings = settings or EnergySettings()
        self._solver = FaceSolver(face, camera, self._settings)
        self._filter = PoseFilter(self._settings.pose_filter)
        self._view = _view(camera)
        self._shown = Solved(
            np.array([1.0, 0.0, 0.0, 0.0]), np.array(USUAL_MM), np.zeros(len(face.deltas_mm)),
            0.0, 0.0,
        )  # fmt: skip
        self._history, self._times_s = np.zeros((2, 6)), np.full(2, np.nan)
        self._left_mm = _FIRST_MM

    @property
    def state(self) -> SolverState:
        """What the last step did."""
        solver = self._solver
        return SolverState(solver.steps_taken, solver.outside, solver.pose.copy())

    def use(self, face: Face, camera: Camera) -> None:
        """Go on with another face, focal length or size of pictures; the past is kept.

        A face seen with a longer lens is as much further away.
        """
        stretch = np.array([1.0, 1.0, _view(camera) / self._view])
        self._solver.load(face, camera)
        self._view = _view(camera)
        self._solver.pose[3] *= stretch
        self._history[:, 3:] *= stretch
        self._filter.stretch(stretch)
        self._shown = self._shown._replace(translation_mm=self._shown.translation_mm * stretch)

    def reset(self) -> None:
        """Forget the past: the face was lost, or the video changed."""
        self._forget_past()
        self._solver.forget()

    def step(self, points_px: FloatArray, confidence: FloatArray, time_s: float) -> Solved:
        """Return pose and expression of one frame.

        Args:
            points_px: (75, 2) landmarks.
            confidence: (75,) in [0, 1]; 0 leaves a landmark out.
            time_s: Time of the frame; not later than the last one's starts anew.

        Raises:
            ValueError: Other numbers of points, or one that is not finite.
        """
        _check(points_px, confidence)
        if time_s <= self._times_s[0]:
            self.reset()
        self._solver.take(points_px, confidence)
        if not self._solver.sees_something:
            return self._held(0.0)
        fit = self._track(time_s)
        if not self._solver.is_possible:
            self.reset()
            return self._held(fit.rms_px)
        self._remember(time_s, fit.rms_px * self._solver.mm_per_px)
        quality = np.clip((fit.near - _HOPELESS) / (_GOOD - _HOPELESS), 0.0, 1.0)
        seen = np.clip(confidence, 0.0, 1.0).mean()
        return self._show(time_s, fit.rms_px, float(quality * seen))

    def points_mm(self) -> FloatArray:
        """Return internal landmarks and replacement points (75, 3) of the last solution.

        In the camera frame, and not filtered: they lie on the face in the picture.
        """
        return self._solver.points_mm()

    def _forget_past(self) -> None:
        self._times_s[:] = np.nan
        self._left_mm = _FIRST_MM
        self._filter.reset()

    def _track(self, time_s: float) -> Fit:
        """Solve a frame from the last one; if that is doubtful also anew, and keep the better."""
        if np.isnan(self._times_s[0]):
            self._solver.start()
            return self._solver.solve(None)
        predicted = predicted_pose(self._history, self._times_s, time_s)
        frames = _USUAL_FPS * (time_s - self._times_s[0])
        fit = self._solver.solve(Past(predicted, frames, self._left_mm))
        sudden = fit.rms_px * self._solver.mm_per_px > 2.0 * self._left_mm + _SUDDEN_MM
        if self._solver.is_possible and fit.near > _DOUBTFUL and not sudden:
            return fit
        pose, expression = self._solver.pose.copy(), self._solver.expression.copy()
        possible = self._solver.is_possible
        self._solver.start()
        anew = self._solver.solve(None)
        if possible and anew.near < fit.near + _BETTER:
            self._solver.pose[:], self._solver.expression[:] = pose, expression
            return fit
        self._forget_past()
        return anew

    def _remember(self, time_s: float, left_mm: float) -> None:
        """Keep the pose and the distance for the next frames."""
        gap_s = 0.0 if np.isnan(self._times_s[0]) else time_s - self._times_s[0]
        share = 1.0 - np.exp(-gap_s / self._settings.joint.noise_s)
        self._left_mm += share * (left_mm - self._left_mm)
        self._history[1], self._times_s[1] = self._history[0], self._times_s[0]
        self._history[0], self._times_s[0] = self._solver.pose_row(), time_s

    def _show(self, time_s: float, rms_px: float, confidence: float) -> Solved:
        """Return the solution, its pose filtered, and keep it."""
        rotation, translation = quaternion_from_matrix(self._solver.pose[:3]), self._solver.pose[3]
        if self._settings.pose_filter is not None:
            rotation, translation = self._filter.step(rotation, translation, time_s)
        self._shown = Solved(
            rotation, translation.copy(), self._solver.expression.copy(), rms_px, confidence
        )
        return self._shown

    def _held(self, rms_px: float) -> Solved:
        """Return the last face that was found."""
        return self._shown._replace(rms_px=rms_px, confidence=0.0)


def _view(camera: Camera) -> float:
    """Return the focal length in parts of the picture's longer side."""
    return camera.focal_px / max(camera.size_px)


def _check(points_px: FloatArray, confidence: FloatArray) -> None:
    """Refuse landmarks that are not 75 finite ones with their confidences."""
    if points_px.shape != (N_LANDMARKS, 2) or confidence.shape != (N_LANDMARKS,):
        raise ValueError(
            f"energy tracker needs {N_LANDMARKS} points and confidences, got {points_px.shape} "
            f"and {confidence.shape}"
        )
    if not (np.isfinite(points_px).all() and np.isfinite(confidence).all()):
        raise ValueError("energy tracker needs finite points and confidences")
