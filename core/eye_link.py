"""Both eyes together: lids that belong together, winks that stay winks, and one gaze.

People wink with one lid half following, and trackers let it follow more; and in a blink one lid is
often seen better than the other, in a turned head always.
"""

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.drive_settings import EyeSettings
from core.records import FloatArray
from core.tracker import BLINKS

#: Pairs of the right, then the left eye's coefficients.
_PAIRS = [BLINKS] + [
    [EXPRESSION_NAMES.index(name + "Right"), EXPRESSION_NAMES.index(name + "Left")]
    for name in ("eyeSquint", "eyeWide")
]
#: Lids that differ less move together; from the second number on it is a wink.
_SAME, _WINK = 0.3, 0.55
#: Yaw of the head at which only the nearer eye counts.
_TURNED_RAD = 0.6
#: A wink's other eye is opened by this much of what it follows.
_OPENED = 0.8


def wink_share(difference: float) -> float:
    """Return from 0 for a blink to 1 for a wink, by how much the lids differ."""
    share = min(max((abs(difference) - _SAME) / (_WINK - _SAME), 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)


def link_lids(expression: FloatArray, yaw_rad: float, way: str) -> None:
    """Let both eyes' lids move together, in place.

    Args:
        expression: (B,) changed.
        yaw_rad: Of the head: the eye nearer to the camera is seen better.
        way: "never", "blinks" or "always", see `EyeSettings`.
    """
    if way == "never":
        return
    right, left = float(expression[BLINKS[0]]), float(expression[BLINKS[1]])
    wink = 0.0 if way == "always" else wink_share(left - right)
    # A head that turns to its left shows the right eye.
    nearer = min(max(0.5 + 0.5 * yaw_rad / _TURNED_RAD, 0.0), 1.0)
    for pair in _PAIRS:
        both = nearer * expression[pair[0]] + (1.0 - nearer) * expression[pair[1]]
        for index in pair:
            expression[index] = wink * expression[index] + (1.0 - wink) * both
    if wink:
        other = BLINKS[0] if left > right else BLINKS[1]
        expression[other] *= 1.0 - _OPENED * wink


def turned_gaze(gaze_rad: FloatArray, settings: EyeSettings) -> FloatArray:
    """Return the gaze (2, 2) with the gain, the raise and the link of the settings."""
    gaze = settings.gaze_gain * gaze_rad
    if settings.gaze_up_rad:
        gaze[:, 1] += settings.gaze_up_rad
    if settings.link_gaze:
        gaze = np.broadcast_to(gaze.mean(axis=0), (2, 2)).copy()
    return np.asarray(gaze)
