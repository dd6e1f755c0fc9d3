"""A recording that begins again when it ends."""

from collections.abc import Callable

from app.capture.source import ClosedOnExit, FrameSource
from core.records import Frame


class Looped(ClosedOnExit):
    """Plays a source of recorded frames over and over; times and numbers go on rising."""

    live = False

    def __init__(
        self, open_source: Callable[[], FrameSource], began_again: Callable[[], None]
    ) -> None:
        """Open the source.

        Args:
            open_source: Opens the recording at its beginning.
            began_again: Called before the first frame of every further turn, by who reads.

        Raises:
            AppError: It cannot be read.
        """
        self._open_source, self._began_again = open_source, began_again
        self._source = open_source()
        self.size_px, self.fps = self._source.size_px, self._source.fps
        self.name = self._source.name
        self._offset_s, self._offset = 0.0, 0
        self._last: Frame | None = None

    def read(self) -> Frame | None:
        """Return the next frame; None only from a recording that has become empty.

        Raises:
            AppError: The recording can no longer be read.
        """
        frame = self._source.read()
        if frame is None and self._last is not None:
            frame = self._begin_again(self._last)
        if frame is None:
            return None
        time_s, index = frame.time_s + self._offset_s, frame.index + self._offset
        self._last = Frame(frame.rgb, frame.gray, time_s, index)
        return self._last

    def close(self) -> None:
        """Give the file back."""
        self._source.close()

    def _begin_again(self, last: Frame) -> Frame | None:
        self._source.close()
        self._source = self._open_source()
        self._offset_s, self._offset = last.time_s + 1 / self.fps, last.index + 1
        self._began_again()
        return self._source.read()
