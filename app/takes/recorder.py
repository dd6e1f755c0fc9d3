"""Records a performance while it happens, without ever making the live thread wait."""

import os
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from typing import BinaryIO

from app.errors import AppError
from app.priority import step_back
from app.recording.sink import reason
from app.takes.claims import claim, release, show_life
from app.takes.completing import STATES, complete
from app.takes.film import FILM_NAME, FilmWriter
from app.takes.library import Take, TakeFacts, write_facts
from app.takes.rows import Moment, row_of
from core.records import U8, FaceState, Frame

#: Pictures that may wait to be written; more are left out, the states are kept.
MOST_WAITING_BYTES = 96 << 20
#: States that may wait: a disk that stands still for so long has failed.
MOST_WAITING = 6000
#: What must stay free on the disk besides the room to complete the take.
SPARE_BYTES = 64 << 20
#: The writer wakes so often even if nothing comes, and as often pushes the rows to the disk.
SIGN_EVERY_S = 1.0
#: The writer gives way to the live thread, less than a training does.
NICENESS = 5
BROKEN = "an error of the program, of which the terminal shows the details"
UNCOMPLETED = (
    "the take cannot be completed now: {why}; it is kept, and completed when the program starts "
    "again and there is room"
)


class RecordingError(AppError):
    """A recording had to end."""

    def __init__(self, why: str) -> None:
        super().__init__(f"the recording has ended: {why}; what was recorded so far is kept")


@dataclass(frozen=True, slots=True)
class Ending:
    """How a recording ended.

    Attributes:
        take: What was recorded, None if that is nothing or could not be completed.
        trouble: Why it ended, None if that was wished.
    """

    take: Take | None
    trouble: AppError | None


@dataclass(frozen=True, slots=True, eq=False)
class _Waiting:
    moment: Moment
    rgb: U8 | None


class Recorder:
    """Writes frames, handed over in the live thread, in a thread of its own.

    Attributes:
        frames: Taken so far.
        seconds: Recorded so far, without pauses.
        pictures_left_out: Frames whose picture came too fast for the disk.
    """

    def __init__(
        self, part: Path, facts: TakeFacts, ended: Callable[[Ending], None],
        free_bytes: Callable[[Path], int] = lambda path: shutil.disk_usage(path).free,
    ) -> None:  # fmt: skip
        """Prepare a recording.

        Args:
            part: Folder to record into.
            facts: What is known of the take; `video` says whether pictures are wanted.
            ended: Called once, in the writer's thread.
            free_bytes: Tells what room the disk has.
        """
        self._part, self._facts, self._ended = part, facts, ended
        self._free_bytes = free_bytes
        self.frames, self.seconds, self.pictures_left_out = 0, 0.0, 0
        # Never makes the live thread wait, as a lock that the writer holds would; None wakes the
        # writer. Of each pair of counters one belongs to the live thread, the other to the writer.
        self._waiting: SimpleQueue[_Waiting | None] = SimpleQueue()
        self._put_bytes, self._written_bytes = 0, 0
        self._written = 0
        self._paused, self._stopping = False, False
        self._trouble: AppError | None = None
        self._last_s: float | None = None
        self._thread = Thread(target=self._run, name="recorder", daemon=False)

    @property
    def paused(self) -> bool:
        """Whether frames are left out on purpose."""
        return self._paused

    def start(self) -> None:
        """Begin.

        Raises:
            OutputError, OSError: Nothing can be written there.
        """
        self._part.mkdir(parents=True)
        write_facts(self._part, self._facts)
        claim(self._part)
        self._thread.start()

    def take(
        self, frame: Frame, solved: FaceState, driven: FaceState, delivered_s: float = 0.0
    ) -> None:
        """Record a frame; called in the live thread, returns at once.

        Args:
            frame: The picture.
            solved: The face in it.
            driven: What the avatar does.
            delivered_s: Not recorded; part of what the live thread tells its listeners.
        """
        if self._stopping or self._paused:
            self._last_s = None
            return
        waits = self.frames - self._written
        if frame.rgb.shape[1::-1] != self._facts.size_px or waits >= MOST_WAITING:
            self._give_up(frame)
            return
        self.seconds += self._passed_s(frame.time_s)
        self._put(frame, solved, driven)

    def pause(self, paused: bool) -> None:
        """Leave frames out from now on, or go on."""
        self._paused = paused

    def stop(self) -> None:
        """Ask for the end; `ended` tells when the take is complete."""
        self._stopping = True
        self._waiting.put(None)

    def wait(self) -> None:
        """Wait for the end after `stop`."""
        if self._thread.is_alive():
            self._thread.join()

    # -- in the live thread --------------------------------------------------------------

    def _passed_s(self, time_s: float) -> float:
        """Return the time since the frame before; a frame's time after a pause or a cut."""
        last_s, self._last_s = self._last_s, time_s
        if self.frames == 0:
            return 0.0
        if last_s is None or time_s <= last_s:
            return 1 / max(self._facts.fps, 1.0)
        return time_s - last_s

    def _put(self, frame: Frame, solved: FaceState, driven: FaceState) -> None:
        rgb: U8 | None = None
        if self._facts.video:
            waits = self._put_bytes - self._written_bytes
            if waits + frame.rgb.nbytes <= MOST_WAITING_BYTES:
                rgb = frame.rgb
                self._put_bytes += rgb.nbytes
            else:
                self.pictures_left_out += 1
        moment = Moment(self.seconds, frame.index, -1, solved, driven)
        self.frames += 1
        self._waiting.put(_Waiting(moment, rgb))

    def _give_up(self, frame: Frame) -> None:
        height, width = frame.rgb.shape[:2]
        asked = self._facts.size_px
        why = f"the pictures are {width}x{height} now, they were {asked[0]}x{asked[1]}"
        if (width, height) == asked:
            why = "the disk does not keep up"
        self._trouble = RecordingError(why)
        self.stop()

    # -- in the writer's thread ----------------------------------------------------------

    def _run(self) -> None:
        step_back(NICENESS)
        film: FilmWriter | None = None
        try:
            if self._facts.video:
                film = FilmWriter(self._part / FILM_NAME, self._facts.fps, self._facts.size_px)
            self._write_all(film)
        except (OSError, AppError) as error:
            told = error if isinstance(error, RecordingError) else RecordingError(_told(error))
            self._trouble = told
        except BaseException:
            self._trouble = RecordingError(BROKEN)
            raise
        finally:
            # Frames that still come are not waited for.
            self.stop()
            self._end(film)

    def _end(self, film: FilmWriter | None) -> None:
        """Tell of the end whatever happens, or the window would wait for it for ever."""
        ending = Ending(None, AppError(UNCOMPLETED.format(why=BROKEN)))
        try:
            if film is not None:
                film.close()
            ending = self._completed(film)
        finally:
            release(self._part)
            self._ended(ending)

    def _completed(self, film: FilmWriter | None) -> Ending:
        n_pictures = 0 if film is None else film.n_frames
        facts = replace(self._facts, video=n_pictures > 0, pictures_left_out=self.pictures_left_out)
        try:
            return Ending(complete(self._part, facts), self._trouble)
        except (OSError, AppError) as error:
            return Ending(None, AppError(UNCOMPLETED.format(why=_told(error))))

    def _write_all(self, film: FilmWriter | None) -> None:
        pushed_s = time.monotonic()
        with (self._part / STATES).open("ab") as file:
            while (some := self._next()) is not None:
                for one in some:
                    self._write(one, file, film)
                file.flush()
                if time.monotonic() - pushed_s > SIGN_EVERY_S:
                    os.fsync(file.fileno())
                    pushed_s = time.monotonic()
                    show_life(self._part)
                    self._check_room(file.tell())

    def _write(self, one: _Waiting, file: BinaryIO, film: FilmWriter | None) -> None:
        moment = one.moment
        if one.rgb is not None and film is not None:
            moment = replace(moment, video_index=film.write(one.rgb))
            self._written_bytes += one.rgb.nbytes
        file.write(row_of(moment).tobytes())
        self._written += 1

    def _next(self) -> list[_Waiting] | None:
        """Return what waits, perhaps nothing after some time; None at the end."""
        some: list[_Waiting] = []
        try:
            one = self._waiting.get(timeout=0.0 if self._stopping else SIGN_EVERY_S)
            while True:
                some += [] if one is None else [one]
                one = self._waiting.get_nowait()
        except Empty:
            return None if self._stopping and not some else some

    def _check_room(self, written_bytes: int) -> None:
        """End while there is room to complete the take: OpenCV does not tell of a full disk."""
        free = self._free_bytes(self._part)
        if free < written_bytes + SPARE_BYTES:
            raise RecordingError(f"the disk is almost full ({free >> 20} MB are left)")


def _told(error: OSError | AppError) -> str:
    return reason(error) if isinstance(error, OSError) else str(error)
