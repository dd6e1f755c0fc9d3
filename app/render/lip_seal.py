"""Lips that nearly touch do touch: what a mesh leaves open at rest is drawn together."""

from dataclasses import dataclass

import numpy as np

from core.records import F32, I32, FloatArray, freeze

#: Gaps from here on begin to stay open, and stay as they are from there on.
_CLOSED_MM, _OPEN_MM = 0.8, 3.0
#: A mouth open so far anywhere loses the seal at its corners, too.
_PARTED_MM, _WIDE_MM = 2.0, 6.0
#: Lips that overlap so far are left alone.
_PRESSED_MM = 0.4


@dataclass(frozen=True, slots=True, eq=False)
class LipSeal:
    """Where lips meet, and what moves when they are drawn together.

    Attributes:
        upper: (K,) vertices of the upper lip's inner edge.
        lower: (K,) what lies opposite.
        rows: (n,) vertices that move along y.
        follow: (n, K) how far for each mm that is to be closed at each pair.
    """

    upper: I32
    lower: I32
    rows: I32
    follow: F32

    def __post_init__(self) -> None:
        freeze(
            self,
            upper=(np.int32, ("K",)),
            lower=(np.int32, ("K",)),
            rows=(np.int32, ("n",)),
            follow=(np.float32, ("n", "K")),
        )

    def close(self, vertices_mm: F32) -> None:
        """Draw lips that nearly touch together, in place (V, 3)."""
        gap = vertices_mm[self.lower, 1] - vertices_mm[self.upper, 1]
        closing = closing_mm(gap)
        if closing.any():
            vertices_mm[self.rows, 1] += self.follow @ closing


def closing_mm(gap_mm: FloatArray | F32) -> F32:
    """Return by how much each gap (K,) is to be closed: all of a small one, nothing of a wide."""
    over = np.maximum(gap_mm + _PRESSED_MM, 0)
    excess = np.where(over < _PRESSED_MM, over**2 / (2 * _PRESSED_MM), over - _PRESSED_MM / 2)
    kept = _ramp(gap_mm, _CLOSED_MM, _OPEN_MM)
    parted = _ramp(np.asarray(gap_mm.max()), _PARTED_MM, _WIDE_MM)
    return np.asarray(excess * (1 - kept) * (1 - parted), np.float32)


def _ramp(value: FloatArray | F32, low: float, high: float) -> FloatArray:
    """Return 0 up to low, 1 from high on, smooth between."""
    share = np.clip((value - low) / (high - low), 0, 1)
    return np.asarray(share * share * (3 - 2 * share))
