"""The training-free tracker's first steps, which compile its kernels, before anybody waits."""

import numpy as np

from core.blendshapes import mean_user
from core.camera import project
from core.face_model import FaceModel, eye_centers_mm, shape_vertices
from core.free_live import UNKNOWN_CAMERA, FreeSettings, FreeTracker
from core.geometry import matrix_from_head_angles
from core.landmark_flow import Followed
from core.landmarks import N_INTERNAL
from core.quick_identity import QuickSettings
from core.records import FloatArray, Frame, Landmarks2D

#: Frames shown; with the settings below the search for a face comes to its end in them.
_FRAMES = 40
_QUICK = FreeSettings(identity=QuickSettings(first_calls=10))


class _Turning:
    """Follows the model's mean face as it turns from side to side."""

    def __init__(self, model: FaceModel) -> None:
        neutral = mean_user(model).neutral_mm
        self._points = np.concatenate(
            [neutral[shape_vertices(model)], eye_centers_mm(model, neutral)]
        )

    def step(self, frame: Frame) -> Followed:
        """Return the landmarks of the next frame."""
        landmarks = _landmarks(self._points, 0.5 * np.sin(frame.index / 3))
        return Followed(landmarks, None, True, 1.0)

    def reset(self) -> None:
        """Nothing is remembered."""


def _landmarks(points_mm: FloatArray, yaw_rad: float) -> Landmarks2D:
    """Return what the camera sees of shape points (77, 3) turned by an angle; no outline."""
    rotation = matrix_from_head_angles(yaw_rad, 0.1 * yaw_rad, 0.0)
    seen = project(UNKNOWN_CAMERA, points_mm @ rotation.T + [0, 0, 600.0])
    n = len(seen) - 2
    sure = np.where(np.arange(n) < N_INTERNAL, 1.0, 0.0)
    return Landmarks2D(seen[:n], np.zeros(n, bool), sure, seen[n:], np.ones(2))


def warm_up(model: FaceModel) -> None:
    """Track an imagined face for a moment.

    Where numba's cache is empty that takes half a minute, else half a second. Live pictures shall
    not stand still meanwhile.
    """
    tracker = FreeTracker(model, _Turning(model), None, _QUICK)
    width, height = UNKNOWN_CAMERA.size_px
    gray, rgb = np.zeros((height, width), np.uint8), np.zeros((height, width, 3), np.uint8)
    for index in range(_FRAMES):
        tracker.step(Frame(rgb, gray, index / 30, index))
