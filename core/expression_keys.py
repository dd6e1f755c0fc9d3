"""Faces that keys call up, faded in and out."""

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.drive_filter import group_of
from core.drive_settings import N_KEYS, ExpressionKey
from core.records import BoolArray, FloatArray

#: Least time of a fade: a face that jumps looks like an error.
_LEAST_S = 1e-3


class KeyFades:
    """How far every key's face is there."""

    def __init__(self) -> None:
        # Written by the thread that hears keys, read by the one that drives: single values only.
        self._wanted = [False] * N_KEYS
        self._levels = [0.0] * N_KEYS

    @property
    def shown(self) -> tuple[bool, ...]:
        """Which keys' faces are wanted now."""
        return tuple(self._wanted)

    def press(self, key: int, hold: bool) -> None:
        """Show a key's face, or take it off if it is there and not one to hold.

        Args:
            key: From 1.
            hold: Whether the key is one to hold.
        """
        self._wanted[key - 1] = hold or not self._wanted[key - 1]

    def release(self, key: int, hold: bool) -> None:
        """End a face that is shown while its key is held."""
        if hold:
            self._wanted[key - 1] = False

    @property
    def idle(self) -> bool:
        """Whether no key has any effect."""
        return not any(self._wanted) and not any(self._levels)

    def step(self, keys: tuple[ExpressionKey, ...], step_s: float) -> list[float]:
        """Return how far every face is there after a step of time, smooth from 0 to 1."""
        for index in range(N_KEYS):
            if index >= len(keys):
                self._wanted[index], self._levels[index] = False, 0.0
                continue
            wanted, key = self._wanted[index], keys[index]
            fade_s = max(key.fade_in_s if wanted else key.fade_out_s, _LEAST_S)
            change = step_s / fade_s if wanted else -step_s / fade_s
            self._levels[index] = min(max(self._levels[index] + change, 0.0), 1.0)
        return [level * level * (3.0 - 2.0 * level) for level in self._levels]


class KeyFaces:
    """The keys' faces as arrays."""

    def __init__(self, keys: tuple[ExpressionKey, ...]) -> None:
        self.keys = keys
        self._weights = [np.array(key.weights) for key in keys]
        self._replaced = [_replaced(key) for key in keys]

    def applied(self, expression: FloatArray, levels: list[float]) -> FloatArray:
        """Return the expression (B,) with the keys' faces as far as they are there."""
        shown = expression
        for weights, replaced, level in zip(self._weights, self._replaced, levels, strict=False):
            if level:
                # What is added brings the rest to 1 closer, so that sums cannot pass 1.
                kept = shown * np.where(replaced, 1.0 - level, 1.0)
                added = level * weights
                shown = np.where(replaced, kept + added, 1.0 - (1.0 - kept) * (1.0 - added))
        return shown


def _replaced(key: ExpressionKey) -> BoolArray:
    """Return which coefficients (B,) a key's face replaces."""
    if key.way == "face":
        return np.ones(len(EXPRESSION_NAMES), bool)
    if key.way == "add":
        return np.zeros(len(EXPRESSION_NAMES), bool)
    used = {group_of(n) for n, w in zip(EXPRESSION_NAMES, key.weights, strict=True) if w}
    return np.array([group_of(name) in used for name in EXPRESSION_NAMES])
