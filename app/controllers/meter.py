"""Frame rate, times and dropped frames of the live view."""

import time
from collections import deque
from collections.abc import Callable
from threading import Lock

from core.records import FaceState, Frame

#: Frames over which the frame rate is taken, and the age from which they no longer count.
RATE_FRAMES, RATE_AGE_S = 30, 1.0
#: Weight of a new time in the shown average.
NEW_SHARE = 0.1
#: Compilers and caches make the first frames slow; what is dropped meanwhile says nothing.
WARM_UP_FRAMES = 10


class Meter:
    """Counts frames in the live thread; read in the window's."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        self._clock, self._lock = clock, Lock()
        self.reset()

    def reset(self) -> None:
        """Begin anew with a new source."""
        with self._lock:
            self._arrivals_s: deque[float] = deque(maxlen=RATE_FRAMES)
            self._last_index, self._solved = 0, 0
            self._dropped = 0
            self._solve_ms, self._latency_ms = 0.0, 0.0
            self._confidence = 0.0

    def count(self, frame: Frame, state: FaceState, solve_ms: float) -> None:
        """Count a frame that was solved."""
        with self._lock:
            self._arrivals_s.append(self._clock())
            if self._solved > WARM_UP_FRAMES:
                self._dropped += max(0, frame.index - self._last_index - 1)
                self._solve_ms = averaged(self._solve_ms, solve_ms)
            self._last_index = frame.index
            self._solved += 1
            self._confidence = averaged(self._confidence, state.confidence)

    def count_latency(self, latency_ms: float) -> None:
        """Count a painted picture."""
        with self._lock:
            self._latency_ms = averaged(self._latency_ms, latency_ms)

    @property
    def confidence(self) -> float:
        """How sure the tracker is, averaged."""
        return self._confidence

    @property
    def dropped(self) -> int:
        """Frames left out because solving took too long."""
        return self._dropped

    @property
    def solve_ms(self) -> float:
        """Time to solve a frame, averaged; 0 while nothing was solved."""
        return self._solve_ms

    @property
    def latency_ms(self) -> float:
        """Time from the delivery of a frame to the avatar's picture, averaged."""
        return self._latency_ms

    def frames_per_second(self) -> float:
        """Return the rate over the last second or so, 0 while nothing comes."""
        with self._lock:
            arrivals_s = self._arrivals_s
            if len(arrivals_s) < 2 or self._clock() - arrivals_s[-1] > RATE_AGE_S:
                return 0.0
            return (len(arrivals_s) - 1) / max(arrivals_s[-1] - arrivals_s[0], 1e-6)


def averaged(before: float, now: float) -> float:
    """Return the running average after another value; the first value stands for itself."""
    return now if before == 0 else before + NEW_SHARE * (now - before)
