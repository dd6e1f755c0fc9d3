"""Whether the face that is tracked has become somebody else's.

A tracker bends any face to the landmarks it sees, so a single frame hardly tells. But what remains
is systematic: the mean of the remainders of frames that look ahead, landmark by landmark, is small
for the person whose offsets were fitted, and grows within seconds for anybody else.
"""

from dataclasses import dataclass

import numpy as np

from core.camera import project
from core.fit_space import Face
from core.geometry import head_angles_from_matrix, rotation_facing_camera
from core.landmarks import N_INTERNAL
from core.quick_frames import Keyframe
from core.records import Camera, FloatArray


@dataclass(frozen=True, slots=True)
class StrangerSettings:
    """When a face counts as another one.

    Attributes:
        ahead_rad: Heads turned further are not looked at.
        memory: Frames in which the mean remainder forgets.
        level_memory: Frames in which its usual size is learned.
        patience: Frames before anything is said, and again after each new face.
        least_mm: No smaller mean remainder is strange. On rendered people the one who was learned
            stays below 0.45, others come to between 0.6 and 1.3.
        times_usual: Nor is one that is less than so many times the usual one.
        lasting: Frames that it has to last; a hand before the mouth is usually gone by then.
    """

    ahead_rad: float = 0.35
    memory: int = 45
    level_memory: int = 200
    patience: int = 150
    least_mm: float = 0.5
    times_usual: float = 1.4
    lasting: int = 60


class StrangerWatch:
    """Watches the mean remainder."""

    def __init__(self, face: Face, camera: Camera, settings: StrangerSettings) -> None:
        self._settings = settings
        self._mean_mm, self._level_mm = np.zeros((N_INTERNAL, 2)), 0.0
        self._seen, self._strange = 0, 0
        self.use(face, camera)

    def use(self, face: Face, camera: Camera) -> None:
        """Go on with a better face."""
        self._neutral = face.neutral_mm[:N_INTERNAL].copy()
        self._deltas = face.deltas_mm[:, :N_INTERNAL].reshape(len(face.deltas_mm), -1).copy()
        self._camera = camera

    @property
    def mean_remainder_mm(self) -> float:
        """Return the size of the mean remainder, the root of the mean square."""
        return float(np.sqrt(np.mean(np.sum(self._mean_mm**2, axis=1))))

    def is_stranger(self, frame: Keyframe) -> bool:
        """Look at a tracked frame; return whether these have long been of somebody else."""
        settings = self._settings
        towards = rotation_facing_camera(frame.translation_mm).T @ frame.rotation
        yaw, pitch, roll = head_angles_from_matrix(towards)
        if max(abs(yaw), abs(pitch)) > settings.ahead_rad:
            return False
        self._seen += 1
        share = 1 / min(self._seen, settings.memory)
        self._mean_mm += share * (self._remainder_mm(frame, roll) - self._mean_mm)
        remainder = self.mean_remainder_mm
        if self._seen <= settings.patience:
            self._level_mm = remainder
            return False
        limit = max(settings.least_mm, settings.times_usual * self._level_mm)
        self._strange = self._strange + 1 if remainder > limit else 0
        if not self._strange:
            self._level_mm += (remainder - self._level_mm) / settings.level_memory
        return self._strange > settings.lasting

    def _remainder_mm(self, frame: Keyframe, roll_rad: float) -> FloatArray:
        """Return projection minus landmark, (60, 2) in mm at the upright head."""
        points = self._neutral + (frame.expression @ self._deltas).reshape(-1, 3)
        in_camera = points @ frame.rotation.T + frame.translation_mm
        seen = frame.landmarks.points_px[:N_INTERNAL]
        off_px = project(self._camera, in_camera) - seen
        c, s = np.cos(roll_rad), np.sin(roll_rad)
        upright = off_px @ np.array([[c, -s], [s, c]])
        return np.asarray(upright * (frame.translation_mm[2] / self._camera.focal_px))
