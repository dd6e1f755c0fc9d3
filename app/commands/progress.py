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
        started_s = self._clock()
        self._shown_s, self._label = -1e9, ""
        while True:
            try:
                progress = next(steps)
            except StopIteration as end:
                self._close()
                return end.value  # type: ignore[no-any-return]
            except BaseException:
                self._close()
                raise
            self._show(progress, started_s)

    def _show(self, progress: Progress, started_s: float) -> None:
        now_s = self._clock()
        if progress.label == self._label and now_s - self._shown_s < self._every_s:
            return
        self._shown_s, self._label = now_s, progress.label
        text = progress_line(progress, now_s - started_s)
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


def progress_line(progress: Progress, elapsed_s: float) -> str:
    """Return one line: label, percentage, remaining time as far as it can be told.

    Work of unknown length has the total 0; then the steps are counted.
    """
    if progress.total == 0:
        return f"{progress.label:<32} {progress.done}"
    share = min(max(progress.done / progress.total, 0.0), 1.0)
    line = f"{progress.label:<32} {100 * share:3.0f} %"
    # In the first moments the estimate is noise.
    if share >= 0.02 and elapsed_s >= 1:
        line += f"  {duration(elapsed_s * (1 - share) / share)} left"
    return line


def duration(seconds: float) -> str:
    """Return a time like 0:07 or 1:02:30."""
    minutes, left = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{left:02d}" if hours else f"{minutes}:{left:02d}"
