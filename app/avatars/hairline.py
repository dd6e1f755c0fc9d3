"""Where the hair begins on the mean head; the painted scalp has the same line."""

import numpy as np

from core.records import FloatArray

#: The hairline: angle from straight ahead in degrees, height y in mm (down from the eyes).
HAIRLINE = (
    (0, -73), (20, -73), (36, -62), (50, -48), (60, -26), (67, 4), (74, 22), (80, 20), (86, -14),
    (104, -20), (118, 12), (128, 44), (150, 62), (180, 66),
)  # fmt: skip
#: The axis that the angle is measured about.
_AXIS_Z_MM = 78.0


def above_hairline_mm(points_mm: FloatArray) -> FloatArray:
    """Return how far points (..., 3) of the mean head lie above the hairline, negative below."""
    x, y, z = np.moveaxis(np.asarray(points_mm, float), -1, 0)
    angle = np.rad2deg(np.arctan2(np.abs(x), _AXIS_Z_MM - z))
    degrees, heights = np.array(HAIRLINE, float).T
    return np.asarray(np.interp(angle, degrees, heights) - y)
