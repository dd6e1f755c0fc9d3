"""What the avatar does by itself: breathing, blinking, going to rest and coming back."""

import numpy as np

from core.records import FloatArray
from core.tracker import BLINKS

#: Breaths per second; size of the nod, rad, and of the way up and back, mm.
_BREATHS_HZ, _NOD_RAD, _RISE_MM, _BACK_MM = 0.23, 0.006, 3.0, 2.0
#: Time in which breathing and blinking by itself begins and ends.
_FADE_S = 1.5
#: Phases of a blink, and shortest and longest time between two.
_CLOSING_S, _CLOSED_S, _OPENING_S = 0.08, 0.04, 0.16
_BLINK_S = _CLOSING_S + _CLOSED_S + _OPENING_S
_LEAST_GAP_S, _MOST_GAP_S = 2.2, 6.0
#: Fraction that spreads multiples evenly between 0 and 1.
_GOLDEN = 0.6180339887498949


def eased(share: float) -> float:
    """Return 0 rising to 1, smooth at both ends."""
    inside = min(max(share, 0.0), 1.0)
    return inside * inside * (3.0 - 2.0 * inside)


class Breathing:
    """A slow movement of head and shoulders."""

    def __init__(self) -> None:
        self._phase, self._level = 0.0, 0.0

    def step(self, wanted: bool, size: float, step_s: float) -> FloatArray:
        """Return what to add to the head's deviation (6,) from its centre.

        Args:
            wanted: Whether to breathe; it fades in and out.
            size: Of the movement.
            step_s: Time since the last call.
        """
        change = step_s / _FADE_S if wanted else -step_s / _FADE_S
        self._level = min(max(self._level + change, 0.0), 1.0)
        out = np.zeros(6)
        if self._level == 0.0:
            self._phase = 0.0
            return out
        self._phase = (self._phase + step_s * _BREATHS_HZ) % 1.0
        # In faster than out, as people at rest do.
        wave = 0.5 - 0.5 * np.cos(2 * np.pi * self._phase**0.8)
        amount = size * eased(self._level) * float(wave)
        out[1], out[4], out[5] = _NOD_RAD * amount, -_RISE_MM * amount, -_BACK_MM * amount
        return out


class SelfBlink:
    """Blinks at uneven times, always the same ones: no chance is needed for that."""

    def __init__(self) -> None:
        self._count, self._next_s = 0, _LEAST_GAP_S
        self._since_s = np.inf

    def step(self, wanted: bool, step_s: float) -> float:
        """Return the lids' closure in [0, 1]; a blink that has begun is ended."""
        self._since_s += step_s
        self._next_s = self._next_s - step_s if wanted else _LEAST_GAP_S
        if wanted and self._next_s <= 0:
            self._since_s, self._count = 0.0, self._count + 1
            uneven = (self._count * _GOLDEN) % 1.0
            self._next_s = _LEAST_GAP_S + uneven * (_MOST_GAP_S - _LEAST_GAP_S)
        if self._since_s >= _BLINK_S:
            return 0.0
        closing = eased(self._since_s / _CLOSING_S)
        return closing - eased((self._since_s - _CLOSING_S - _CLOSED_S) / _OPENING_S)


def close_lids(expression: FloatArray, closure: float) -> FloatArray:
    """Return the expression (B,) with both lids closed at least so far."""
    if closure <= 0.0:
        return expression
    out = expression.copy()
    out[BLINKS] = np.maximum(out[BLINKS], closure)
    return out
