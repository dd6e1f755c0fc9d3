"""How a user usually holds the head, seen while tracking goes on."""

from collections import deque

import numpy as np

from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    matrix_from_quaternion,
    quaternion_from_matrix,
    rotation_facing_camera,
)
from core.records import FloatArray

#: Heads that are remembered, seconds between two of them, and fewest that tell anything.
_MOST, _EVERY_S, _FEWEST = 100, 0.2, 5


class UsualRotation:
    """Keeps the last heads, a few per second; their median is how the user looks at the screen."""

    def __init__(self) -> None:
        self._angles_rad: deque[FloatArray] = deque(maxlen=_MOST)
        self._next_s = -np.inf

    def add(self, rotation_wxyz: FloatArray, translation_mm: FloatArray, time_s: float) -> None:
        """Take a head into account, unless the last one is too recent.

        Args:
            rotation_wxyz: (4,) model to camera.
            translation_mm: (3,).
            time_s: When that was; a time before the last one's is of another turn of a video.
        """
        if self._next_s - _EVERY_S <= time_s < self._next_s:
            return
        self._next_s = time_s + _EVERY_S
        facing = rotation_facing_camera(translation_mm)
        turned = facing.T @ matrix_from_quaternion(rotation_wxyz)
        self._angles_rad.append(head_angles_from_matrix(turned))

    @property
    def seen_s(self) -> float:
        """For how long heads were seen, as far as that is remembered."""
        return len(self._angles_rad) * _EVERY_S

    def rotation_wxyz(self, unknown_wxyz: FloatArray) -> FloatArray:
        """Return the median rotation (4,) against a head that faces the camera.

        Args:
            unknown_wxyz: (4,) what to return while too few heads were seen.
        """
        # A list of all is taken in one step: the live view asks while another thread adds.
        angles = list(self._angles_rad)
        if len(angles) < _FEWEST:
            return unknown_wxyz
        middle = np.median(np.array(angles), axis=0)
        return quaternion_from_matrix(matrix_from_head_angles(*middle))
