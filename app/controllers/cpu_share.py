"""How much of the computer this program uses."""

import os
import time
from collections.abc import Callable

#: Shorter times than this say nothing.
LEAST_S = 0.2
#: Weight of a new share in the shown one.
NEW_SHARE = 0.3


class CpuShare:
    """Compares the processor time of all threads with the time that passes."""

    def __init__(
        self,
        clock: Callable[[], float] = time.perf_counter,
        used: Callable[[], float] = time.process_time,
        n_processors: int | None = None,
    ) -> None:
        self._clock, self._used = clock, used
        self._n_processors = n_processors or os.cpu_count() or 1
        self._at_s, self._used_s = clock(), used()
        self._share = 0.0

    def look(self) -> float:
        """Return the share of all processors in [0, 1], of about the last second."""
        now_s, used_s = self._clock(), self._used()
        passed_s = now_s - self._at_s
        if passed_s >= LEAST_S:
            share = (used_s - self._used_s) / (passed_s * self._n_processors)
            self._share += (share - self._share) * (NEW_SHARE if self._share else 1.0)
            self._at_s, self._used_s = now_s, used_s
        return min(max(self._share, 0.0), 1.0)
