"""Progress in the terminal: what is being done, how far it is, how long it will still take."""

import time
from collections.abc import Callable, Generator
from typing import TextIO, TypeVar

from core.records import Progress

T = TypeVar("T")

#: Seconds between two lines where lines cannot be overwritten, as in a log file.
LINE_EVERY_S = 5.0
#: Seconds between two updates of the line of a terminal.
UPDATE_EVERY_S = 0.1


class TerminalProgress:
    """Writes progress as one line that changes, or in a log file as a line now and then."""

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        """Write to a stream.

        Args:
            stream: Usually stderr, so that results on stdout stay clean.
            clock: Gives seconds.
        """
        self._stream, self._clock = stream, clock
        self._overwrite = stream.isatty()
        self._every_s = UPDATE_EVERY_S if self._overwrite else LINE_EVERY_S
        self._shown_s, self._label, self._width = -1e9, "", 0

    def follow(self, steps: Generator[Progress, None, T]) -> T:
        """Run a generator to its end and return its record, showing its progress."""
        self._shown_s, self._label = -1e9, ""
        # The first step may hold a start-up that says nothing about the pace of the others.
        first: tuple[float, float] | None = None
        while True:
            try:
                progress = next(steps)
            except StopIteration as end:
                self._close()
                return end.value  # type: ignore[no-any-return]
            except BaseException:
                self._close()
                raise
            now_s = self._clock()
            first = first or (share_done(progress), now_s)
            self._show(progress, now_s, share_done(progress) - first[0], now_s - first[1])

    def _show(self, progress: Progress, now_s: float, gained: float, elapsed_s: float) -> None:
        if progress.label == self._label and now_s - self._shown_s < self._every_s:
            return
        self._shown_s, self._label = now_s, progress.label
        text = progress_line(progress, gained, elapsed_s)
        if self._overwrite:
            self._stream.write("\r" + text.ljust(self._width))
            self._width = len(text)
        else:
            self._stream.write(text + "\n")
        self._stream.flush()

    def _close(self) -> None:
        """Clear the line for what comes next."""
        if self._overwrite and self._width:
            self._stream.write("\r" + " " * self._width + "\r")
            self._stream.flush()
            self._width = 0


def progress_line(progress: Progress, gained: float, elapsed_s: float) -> str:
    """Return one line: label, percentage, remaining time as far as it can be told.

    Args:
        progress: To tell. Work of unknown length has the total 0; then the steps are counted.
        gained: Share of the whole done in the time that has elapsed.
        elapsed_s: Time for that.
    """
    if progress.total == 0:
        return f"{progress.label:<32} {progress.done}"
    share = share_done(progress)
    line = f"{progress.label:<32} {100 * share:3.0f} %"
    # In the first moments the estimate is noise.
    if gained >= 0.02 and elapsed_s >= 1:
        line += f"  {duration(elapsed_s * (1 - share) / gained)} left"
    return line


def share_done(progress: Progress) -> float:
    """Return how much of the work is done, in [0, 1]."""
    return min(max(progress.done / max(progress.total, 1), 0.0), 1.0)


def duration(seconds: float) -> str:
    """Return a time like 0:07 or 1:02:30."""
    minutes, left = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{left:02d}" if hours else f"{minutes}:{left:02d}"
