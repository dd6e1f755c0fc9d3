"""What open and closed lids look like in this user's coefficients.

A generic face's blink coefficient is not 0 for open and 1 for closed eyes of everybody. The setup
pictures say what they are; without them they show in time: eyes are open most of the time, and
blinks are short peaks.
"""

from dataclasses import dataclass

import numpy as np

from core.records import FloatArray, freeze
from core.tracker import BLINKS

#: Standard coefficient from which a picture shows a closed eye.
_CLOSED = 0.9
#: Limits of the levels: open is no less than lids tremble, no more than the second number, and
#: closed is this much above it.
LEAST_OPEN, MOST_OPEN, LEAST_SPAN = 0.03, 0.4, 0.3
#: Levels are learned from so many values, a bin each, and looked for so often.
_BINS, _EVERY_S = 64, 0.1


@dataclass(frozen=True, slots=True, eq=False)
class BlinkLevels:
    """Blink coefficients of open and of closed eyes.

    Attributes:
        open: (2,) of the right, then the left eye.
        closed: (2,) the same.
    """

    open: FloatArray
    closed: FloatArray

    def __post_init__(self) -> None:
        freeze(self, open=(np.float64, (2,)), closed=(np.float64, (2,)))

    def applied(self, blinks: FloatArray) -> FloatArray:
        """Return blink coefficients (2,) with open at 0 and closed at 1."""
        share = (blinks - self.open) / (self.closed - self.open)
        return np.asarray(np.minimum(np.maximum(share, 0.0), 1.0))


def sound_levels(opened: FloatArray, closed: FloatArray) -> BlinkLevels:
    """Return levels within what can be."""
    low = np.clip(opened, LEAST_OPEN, MOST_OPEN)
    return BlinkLevels(low, np.clip(closed, low + LEAST_SPAN, 1.0))


def blink_levels(standard: FloatArray, coefficients: FloatArray) -> BlinkLevels | None:
    """Return a user's levels from the setup pictures, None if no picture shows a closed eye.

    Closed is what three of four pictures of closed or squeezed eyes reach, so that nearly every
    blink is seen as one; open the middle of the neutral pictures. What has no pictures is 0 or 1.

    Args:
        standard: (N, B) coefficients that were asked for, NaN rows where none were.
        coefficients: (N, B) as tracked in the pictures.
    """
    neutral = (standard == 0).all(axis=1)
    if not (standard[:, BLINKS] >= _CLOSED).any():
        return None
    opened, closed = np.zeros(2), np.ones(2)
    for eye, index in enumerate(BLINKS):
        shut = standard[:, index] >= _CLOSED
        if neutral.any():
            opened[eye] = np.median(coefficients[neutral, index])
        if shut.any():
            closed[eye] = np.quantile(coefficients[shut, index], 0.25)
    return sound_levels(opened, closed)


@dataclass(frozen=True, slots=True)
class LevelSettings:
    """How levels are learned while tracking.

    Attributes:
        memory_s: Time in which what was seen is forgotten.
        seen_s: Time for which a face must have been seen.
        blinks_s: Time for which lids must have been down.
        open_share: Share of the time after which the level of open eyes is passed.
        closed_share: The same for closed eyes among lids that are down.
        down: Lids this far above the open level are down.
        follow_s: Time in which the levels in use follow those that are found.
    """

    memory_s: float = 120.0
    seen_s: float = 4.0
    blinks_s: float = 0.25
    open_share: float = 0.4
    closed_share: float = 0.85
    down: float = 0.3
    follow_s: float = 2.0


class LearnedLevels:
    """Learns the levels of whoever is tracked."""

    def __init__(self, settings: LevelSettings | None = None) -> None:
        self._settings = settings or LevelSettings()
        self._seen_s, self._waited_s = np.zeros((2, _BINS)), 0.0
        self._open, self._closed = np.zeros(2), np.ones(2)
        self.levels = sound_levels(self._open, self._closed)

    def forget(self) -> None:
        """Begin anew with another person."""
        self._seen_s[:] = 0
        self._open[:], self._closed[:] = 0, 1
        self.levels = sound_levels(self._open, self._closed)

    def add(self, blinks: FloatArray, step_s: float) -> BlinkLevels:
        """Take blink coefficients (2,) into account and return the levels.

        Args:
            blinks: Of the right, then the left eye.
            step_s: Time that they stand for.
        """
        for eye in range(2):
            self._seen_s[eye, min(int(blinks[eye] * _BINS), _BINS - 1)] += step_s
        self._waited_s += step_s
        if self._waited_s >= _EVERY_S:
            self._follow(self._waited_s)
            self._waited_s = 0.0
        return self.levels

    def _follow(self, step_s: float) -> None:
        """Move the levels towards those in what was seen, of which some is forgotten."""
        settings = self._settings
        self._seen_s *= np.exp(-step_s / settings.memory_s)
        found = [self._found(eye) for eye in range(2)]
        share = -np.expm1(-step_s / settings.follow_s)
        self._open += share * (np.array([one[0] for one in found]) - self._open)
        self._closed += share * (np.array([one[1] for one in found]) - self._closed)
        self.levels = sound_levels(self._open, self._closed)

    def _found(self, eye: int) -> tuple[float, float]:
        """Return the levels of an eye in what was seen; 0 and 1 as long as that is too little."""
        settings, seen_s = self._settings, self._seen_s[eye]
        if seen_s.sum() < settings.seen_s:
            return 0.0, 1.0
        low = min(_quantile(seen_s, settings.open_share), MOST_OPEN)
        down = seen_s.copy()
        down[: int((low + settings.down) * _BINS)] = 0
        if down.sum() < settings.blinks_s:
            return low, 1.0
        return low, _quantile(down, settings.closed_share)


def _quantile(seen_s: FloatArray, share: float) -> float:
    """Return the value that is not passed for a share of the time."""
    total = np.cumsum(seen_s)
    index = int(np.searchsorted(total, share * total[-1]))
    return float((index + 0.5) / _BINS) if index else 0.0
