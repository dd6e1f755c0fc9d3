"""A light speed-adaptive filter for the head pose: steady when still, without lag when fast.

The registration's noise is white from frame to frame while a head's motion is smooth, so a
first-order low-pass whose cutoff rises with the speed [Casiez, Roussel and Vogel 2012] removes
most of it. The rotation is filtered on the sphere of quaternions; the translation's depth apart
from its other two axes, since it is several times noisier. We measure the speed from the filtered
value to the new one, not between new ones: a lag then opens the filter by itself.
"""

from dataclasses import astuple, dataclass

import numpy as np

from core.kernels.pose import filter_pose
from core.records import FloatArray


@dataclass(frozen=True, slots=True)
class LowPassSettings:
    """How one quantity is filtered.

    Attributes:
        cutoff_hz: At rest.
        cutoff_per_speed: Added to the cutoff per unit of speed, Hz / (unit / s).
        speed_cutoff_hz: For the speed itself.
    """

    cutoff_hz: float
    cutoff_per_speed: float
    speed_cutoff_hz: float = 1.5


@dataclass(frozen=True, slots=True)
class PoseFilterSettings:
    """How the pose is filtered.

    Attributes:
        rotation: In rad.
        across: Translation along x and y, mm.
        along: Translation along the view, mm.
        longest_step_s: After a longer gap the filter starts anew.
    """

    rotation: LowPassSettings = LowPassSettings(0.7, 40.0)
    across: LowPassSettings = LowPassSettings(0.7, 0.35)
    along: LowPassSettings = LowPassSettings(0.5, 0.08)
    longest_step_s: float = 0.25


class PoseFilter:
    """Filters the poses of a video; remembers the last one."""

    def __init__(self, settings: PoseFilterSettings | None = None) -> None:
        self._settings = settings or PoseFilterSettings()
        parts = (self._settings.rotation, self._settings.across, self._settings.along)
        self._table = np.array([astuple(part) for part in parts])
        self._rotation, self._translation = np.empty(4), np.empty(3)
        self._speeds, self._work = np.zeros((2, 3)), np.empty(3)
        self._time_s: float | None = None

    def reset(self) -> None:
        """Forget the last pose: the next one passes unchanged."""
        self._time_s = None

    def stretch(self, factors: FloatArray) -> None:
        """Multiply what is kept of the translation by (3,): another focal length was found."""
        self._translation *= factors
        self._speeds[1] *= factors

    def step(
        self, rotation_wxyz: FloatArray, translation_mm: FloatArray, time_s: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return the filtered rotation (4,) and translation (3,) at `time_s`."""
        gap_s = np.inf if self._time_s is None else time_s - self._time_s
        self._time_s = time_s
        if not 0 < gap_s <= self._settings.longest_step_s:
            self._rotation[:], self._translation[:] = rotation_wxyz, translation_mm
            self._speeds[:] = 0
        else:
            filter_pose(
                rotation_wxyz, translation_mm, gap_s, self._table, self._speeds, self._work,
                self._rotation, self._translation,
            )  # fmt: skip
        return self._rotation.copy(), self._translation.copy()
