"""From a face that comes and goes to one that is always there.

A lost face is held, then eases to rest; one that is seen again is caught up with: the difference
between what was shown and what is seen is let go within a moment, while its motion passes at once.
"""

from typing import NamedTuple

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.drive_settings import IdleSettings
from core.idle import eased
from core.records import FloatArray

#: Shortest time in which the difference to what was shown is let go.
_LEAST_BACK_S = 0.1


class Face(NamedTuple):
    """What the avatar does: head from its centre (6,), coefficients (B,), gaze (2, 2)."""

    away: FloatArray
    expression: FloatArray
    gaze_rad: FloatArray


def resting_face() -> Face:
    """Return a head at its centre that shows nothing."""
    return Face(np.zeros(6), np.zeros(len(EXPRESSION_NAMES)), np.zeros((2, 2)))


class Presence:
    """Remembers what was shown last, and what is left of a difference."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the past: the next face is shown as it is."""
        self._face = self._last = self._gap = resting_face()
        self.lost_s = np.inf
        self._gap_s, self._gap_left_s, self._gap_is_new = 1.0, 0.0, False

    @property
    def was_lost(self) -> bool:
        """Whether the last face was lost, or there was none."""
        return self.lost_s > 0.0

    def bridge(self, duration_s: float) -> None:
        """Let the difference between what was shown last and the next face go in some time."""
        self._gap_s = self._gap_left_s = duration_s
        self._gap_is_new = True

    def seen(
        self, face: Face, settings: IdleSettings, step_s: float, from_rest: bool = False
    ) -> Face:
        """Return a face that is seen without a jump from what was shown before.

        Args:
            face: As it is seen.
            settings: How long a jump is stretched.
            step_s: Time since the last face.
            from_rest: Whether the first face of all comes out of rest, too.
        """
        if self.was_lost:
            if from_rest or np.isfinite(self.lost_s):
                least_s = min(_LEAST_BACK_S, settings.back_s)
                self.bridge(min(max(self.lost_s, least_s), settings.back_s))
            self.lost_s = 0.0
        shown = face if self._gap_left_s <= 0.0 else self._bent(face, step_s)
        self._face = self._last = shown
        return shown

    def unseen(self, settings: IdleSettings, step_s: float) -> Face:
        """Return the last face on its way to rest."""
        self.lost_s += step_s
        left = 1.0 - eased((self.lost_s - settings.hold_s) / settings.ease_s)
        self._face = Face(*(left * part for part in self._last))
        return self._face

    def _bent(self, face: Face, step_s: float) -> Face:
        if self._gap_is_new:
            self._gap_is_new = False
            self._gap = Face(*(old - new for old, new in zip(self._face, face, strict=True)))
        self._gap_left_s -= step_s
        share = eased(self._gap_left_s / self._gap_s)
        bent = Face(*(new + share * gap for new, gap in zip(face, self._gap, strict=True)))
        np.clip(bent.expression, 0.0, 1.0, out=bent.expression)
        return bent
