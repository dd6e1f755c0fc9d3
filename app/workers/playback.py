"""Plays a take at its own times, in a thread of its own: forwards, to any frame, frame by frame."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from threading import Condition

from PySide6.QtCore import QObject, QThread, Signal

from app.errors import AppError
from app.takes.film import FilmReader, blank
from app.takes.library import Take
from app.takes.rows import Moment, Rows, moment_of
from app.workers.latest import Latest
from core.records import Frame, UserBlendshapes

#: Numbers of played frames begin here, after those of any live source: they always count as newer.
FIRST_INDEX = 1 << 40


@dataclass(frozen=True, slots=True, eq=False)
class Played:
    """A moment of a take that is shown.

    Attributes:
        number: Of the take's frames.
        moment: What was recorded.
        frame: The picture, dark where none was kept.
    """

    number: int
    moment: Moment
    frame: Frame


class Playback(QThread):
    """Shows the moments of a take; wishes may come from any thread."""

    ready = Signal(object)  # whose head the take's profile has, None if nobody's; then `begin`
    posted = Signal()  # `results` holds something new
    failed = Signal(object)  # AppError: the take cannot be played

    def __init__(
        self, take: Take, show: Callable[[Played], None],
        user_of: Callable[[str], UserBlendshapes | None], parent: QObject | None = None,
    ) -> None:  # fmt: skip
        """Prepare to play.

        Args:
            take: To play, from where its trim begins.
            show: Called in this thread with each moment.
            user_of: Returns whose head a profile has; called in this thread.
            parent: Of the thread object.
        """
        super().__init__(parent)
        self._take, self._show, self._user_of = take, show, user_of
        self.results: Latest[Played] = Latest()
        self._changed = Condition()
        self._range_s = take.range_s
        self._playing, self._loop, self._stopping = True, True, False
        self._begun = False
        self._seek_s: float | None = take.range_s[0]
        self._by = 0
        self._rows: Rows | None = None
        self._now = 0
        # When, on our clock, the take's time 0 would be.
        self._zero_s = 0.0
        self._index = FIRST_INDEX

    def begin(self) -> None:
        """Show the first moment, now that the avatar knows whose head it has."""
        with self._changed:
            self._begun = True
            self._changed.notify()

    @property
    def playing(self) -> bool:
        """Whether the take goes on; else it stays at a frame."""
        return self._playing

    def play(self, playing: bool) -> None:
        """Go on, from the beginning if this is the end; or stay at this frame."""
        with self._changed:
            if playing and not self._playing:
                self._seek_s = self._start_s()
            self._playing = playing
            self._changed.notify()

    def seek(self, play_s: float) -> None:
        """Show the frame of a time; go on from there if the take plays."""
        with self._changed:
            self._seek_s = play_s
            self._changed.notify()

    def step(self, by: int) -> None:
        """Stay, and go some frames forth or back."""
        with self._changed:
            self._playing = False
            self._by += by
            self._changed.notify()

    def use_range(self, range_s: tuple[float, float]) -> None:
        """Play from here to there."""
        with self._changed:
            self._range_s = range_s
            self._changed.notify()

    def repeat(self, loop: bool) -> None:
        """Begin again at the end, or stay there."""
        with self._changed:
            self._loop = loop

    def stop(self) -> None:
        """Ask for an end and wait for it."""
        with self._changed:
            self._stopping = True
            self._changed.notify()
        self.wait()

    # -- in this thread ------------------------------------------------------------------

    def run(self) -> None:
        """Play; called by QThread in the new thread."""
        film = self._take.film
        reader: FilmReader | None = None
        try:
            self._rows = self._take.rows()
            reader = None if film is None else FilmReader(film)
            self.ready.emit(self._user_of(self._take.facts.profile))
            while (number := self._next(self._rows)) is not None:
                self._present(number, self._rows, reader)
        except AppError as error:
            self.failed.emit(error)
        finally:
            if reader is not None:
                reader.close()

    def _next(self, rows: Rows) -> int | None:
        """Return the frame to show now, waiting for its time; None at the end of all."""
        with self._changed:
            while not self._stopping:
                number, wait_s = self._due(rows)
                if number is not None:
                    self._now = number
                    return number
                self._changed.wait(wait_s)
            return None

    def _due(self, rows: Rows) -> tuple[int | None, float | None]:
        """Return the frame that is due, or how long nothing is; None: until a wish comes."""
        now_s, times_s = time.perf_counter(), rows["play_s"]
        if not self._begun:
            return None, None
        if self._by:
            number, self._by = min(max(self._now + self._by, 0), len(rows) - 1), 0
            return number, None
        if self._seek_s is not None:
            number = int(times_s.searchsorted(self._seek_s + 1e-6, side="right")) - 1
            self._seek_s, self._zero_s = None, now_s - float(times_s[max(number, 0)])
            return max(number, 0), None
        if not self._playing:
            return None, None
        if self._now + 1 >= len(rows) or times_s[self._now + 1] > self._range_s[1]:
            return self._at_end(rows)
        wait_s = self._zero_s + float(times_s[self._now + 1]) - now_s
        if wait_s > 0:
            return None, wait_s
        # Frames whose time has passed are left out; the take never slows down.
        newest = int(times_s.searchsorted(now_s - self._zero_s, side="right")) - 1
        return max(newest, self._now + 1), None

    def _at_end(self, rows: Rows) -> tuple[int | None, float | None]:
        if self._loop and len(rows) > 1:
            self._seek_s = self._range_s[0]
            # The last frame has its time, too.
            return None, float(1 / max(self._take.facts.fps, 1.0))
        self._playing = False
        return self._now, None

    def _start_s(self) -> float:
        """Return from where to go on."""
        if self._rows is None:
            return self._range_s[0]
        now_s = float(self._rows["play_s"][self._now])
        ends = self._now + 1 >= len(self._rows) or now_s >= self._range_s[1] - 1e-3
        return self._range_s[0] if ends else now_s

    def _present(self, number: int, rows: Rows, reader: FilmReader | None) -> None:
        moment = moment_of(rows[number])
        time_s, size_px = moment.solved.time_s, self._take.facts.size_px
        self._index += 1
        frame = blank(size_px, time_s, self._index) if reader is None else reader.frame(
            moment.video_index, size_px, time_s, self._index
        )  # fmt: skip
        played = Played(number, moment, frame)
        self._show(played)
        if self.results.put(played):
            self.posted.emit()
