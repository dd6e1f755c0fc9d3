"""Which frame a live source gives when: by the clock, never late by more than one frame."""

import time
from collections.abc import Callable


class Pacer:
    """Remembers when a source was started and which frame it gave last."""

    def __init__(
        self,
        fps: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._fps, self._clock, self._sleep = fps, clock, sleep
        self._started_s: float | None = None
        self._last = -1

    def next_index(self) -> int:
        """Wait until a new frame is due and return its number; missed frames are left out."""
        now = self._clock()
        if self._started_s is None:
            self._started_s = now
        due = int((now - self._started_s) * self._fps + 1e-6)
        if due <= self._last:
            due = self._last + 1
            self._sleep(max(0.0, self._started_s + due / self._fps - now))
        self._last = due
        return due
