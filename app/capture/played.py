"""A recording played like a camera: at its own pace, and as its buttons say."""

import time
from collections.abc import Callable
from threading import Condition
from typing import Protocol

from app.capture.source import ClosedOnExit
from core.records import Frame

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0)


class Recording(Protocol):
    """What is needed of a source that can be played.

    Attributes:
        n_frames: As far as it knows, else 0.
        skips: Whether frames are left out where solving is slower than the recording; what is
            made while it is read is slow itself, and played slower instead.
    """

    size_px: tuple[int, int]
    fps: float
    name: str
    n_frames: int
    skips: bool

    def read(self) -> Frame | None:
        """Return the next frame, None after the last one."""
        ...

    def seek(self, index: int) -> None:
        """Let the next frame be the one of this number."""
        ...

    def close(self) -> None:
        """Give the file back."""
        ...


class Played(ClosedOnExit):
    """Reads a recording by the clock; paused, stepped and moved from any thread.

    Times and numbers of its frames go on rising, whatever is played.
    """

    live = True

    def __init__(
        self,
        recording: Recording,
        cut: Callable[[], None],
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Play a recording, which belongs to this source from now on.

        Args:
            recording: From its beginning.
            cut: Called by who reads before a frame that does not follow the one before it.
            clock: In seconds.
        """
        self._recording, self._cut, self._clock = recording, cut, clock
        self.size_px, self.fps = recording.size_px, recording.fps
        self.name = recording.name
        self._changed = Condition()
        self._n_frames = recording.n_frames
        self._position, self._wish = -1, 0
        self._paused, self._stopped = False, False
        self._step_wanted, self._jumps = False, False
        self._loop, self._speed = True, 1.0
        self._due_s: float | None = None
        self._last_file_s, self._time_s, self._index = 0.0, 0.0, -1

    # -- from any thread -----------------------------------------------------------------

    @property
    def n_frames(self) -> int:
        """The number of frames, 0 as long as it is not known."""
        return self._n_frames

    @property
    def position(self) -> int:
        """The number of the frame read last, -1 before the first."""
        return self._position

    @property
    def paused(self) -> bool:
        """Whether it is held."""
        return self._paused

    def pause(self, paused: bool) -> None:
        """Hold, or go on; after the last frame from the beginning."""
        with self._changed:
            if self._paused and not paused and 0 < self._n_frames <= self._wish:
                self._wish = 0
            self._paused, self._due_s = paused, None
            self._changed.notify_all()

    def step(self, by: int) -> None:
        """Hold at the next frame (1) or the one before (-1)."""
        self.go_to(self._position + by)

    def go_to(self, index: int) -> None:
        """Show a frame and hold there, or go on from it if it is not held."""
        with self._changed:
            last = self._n_frames - 1 if self._n_frames else index
            self._wish, self._step_wanted = min(max(index, 0), max(last, 0)), True
            self._due_s = None
            self._changed.notify_all()

    def set_speed(self, speed: float) -> None:
        """Play so many times as fast."""
        with self._changed:
            self._speed, self._due_s = speed, None
            self._changed.notify_all()

    def set_loop(self, loop: bool) -> None:
        """Begin again after the last frame, or hold there."""
        with self._changed:
            self._loop = loop
            self._changed.notify_all()

    def interrupt(self) -> None:
        """End reading for good: `read` returns None at once."""
        with self._changed:
            self._stopped = True
            self._changed.notify_all()

    # -- who reads -----------------------------------------------------------------------

    def read(self) -> Frame | None:
        """Return the frame that is due, waiting for it; None once interrupted, or if empty.

        Raises:
            AppError: The recording can no longer be read.
        """
        while (index := self._next_index()) is not None:
            follows = index == self._position + 1
            if not follows:
                self._recording.seek(index)
            frame = self._recording.read()
            if frame is not None:
                return self._counted(frame, index, follows)
            if index == 0:
                return None
            self._end_at(index)
        return None

    def close(self) -> None:
        """Give the file back."""
        self.interrupt()
        self._recording.close()

    def _next_index(self) -> int | None:
        """Wait until a frame is due and return its number; None once interrupted."""
        with self._changed:
            while not self._stopped:
                self._jumps = self._step_wanted
                if self._step_wanted:
                    self._step_wanted = False
                    return self._wish
                if self._at_end() and not self._loop:
                    self._paused = True
                wait_s = None if self._paused else self._wait_s()
                if wait_s is not None and wait_s <= 0:
                    return self._due_index(-wait_s)
                self._changed.wait(wait_s)
            return None

    def _at_end(self) -> bool:
        return 0 < self._n_frames <= self._wish

    def _wait_s(self) -> float:
        """Return the time until the next frame is due, negative if it is late."""
        now_s = self._clock()
        if self._due_s is None:
            self._due_s = now_s
        return self._due_s - now_s

    def _due_index(self, late_s: float) -> int:
        """Return the next frame, or where that is late by more than a frame the one due now."""
        period_s = 1 / (self.fps * self._speed)
        late = int(late_s / period_s)
        if late > 0 and not self._recording.skips:
            self._due_s, late = self._clock(), 0
        due_s = self._clock() if self._due_s is None else self._due_s
        self._due_s = due_s + (late + 1) * period_s
        wish = self._wish + late
        if self._n_frames and wish >= self._n_frames:
            return 0 if self._at_end() else self._n_frames - 1
        return wish

    def _counted(self, frame: Frame, index: int, follows: bool) -> Frame:
        """Return a frame with the time and number that follow those before."""
        ahead = index - self._position
        smooth = self._position >= 0 and 0 < ahead <= self.fps and not self._jumps
        if self._index >= 0 and not (follows or smooth):
            self._cut()
        passed_s = frame.time_s - self._last_file_s
        if not (follows or smooth) or passed_s <= 0:
            passed_s = 1 / self.fps
        self._time_s = frame.time_s if self._index < 0 else self._time_s + passed_s
        self._index += ahead if smooth else 1
        self._last_file_s = frame.time_s
        with self._changed:
            self._position = index
            if not self._step_wanted:
                self._wish = index + 1
        return Frame(frame.rgb, frame.gray, self._time_s, self._index)

    def _end_at(self, index: int) -> None:
        """Learn that there are fewer frames than was said."""
        with self._changed:
            self._n_frames = self._wish = index
            self._due_s = None
