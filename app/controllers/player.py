"""Plays one source at a time: opens it in the background, ends the one before first."""

import time
from collections.abc import Callable, Generator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, runtime_checkable

from PySide6.QtCore import QObject, QThread, Signal

from app.capture.source import FrameSource
from app.errors import AppError
from app.workers.job import Job
from app.workers.live_loop import LiveLoop
from core.blink_levels import BlinkLevels
from core.errors import CoreError
from core.fern_regressor import FernRegressor
from core.records import FaceState, Frame, Progress, UserBlendshapes


class SourceEndedError(AppError):
    """A source that was to go on has no more frames."""

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"{name} gives no more pictures: choose it again, or another source")


class FaceTracker(Protocol):
    """What is needed of the live tracker."""

    def step(self, frame: Frame) -> FaceState:
        """Return the face in a frame."""
        ...

    def reset(self) -> None:
        """Forget the past, as after a cut."""
        ...


@runtime_checkable
class Interruptible(Protocol):
    """A source whose `read` may take long."""

    def interrupt(self) -> None:
        """End reading for good, from any thread."""
        ...


def nobody() -> UserBlendshapes | None:
    """Return that nothing was learned of a user."""
    return None


@dataclass(frozen=True, slots=True, eq=False)
class Performer:
    """A tracker, and whose head it follows.

    Attributes:
        tracker: Solves the frames.
        user: Of the profile, None without one.
        learned: Asked in the background: who was seen meanwhile, None as long as nobody is known.
        regressor: Of the profile, None without one.
        levels: Of the user's lids, None where they have to be learned.
        folder: Of the profile, None without one.
    """

    tracker: FaceTracker
    user: UserBlendshapes | None
    learned: Callable[[], UserBlendshapes | None] = nobody
    regressor: FernRegressor | None = None
    levels: BlinkLevels | None = None
    folder: Path | None = None


class Opener(Protocol):
    """What is needed of the toolbox."""

    def open_source(self, key: str, began_again: Callable[[], None]) -> FrameSource:
        """Open a source; `began_again` is called where a recording starts once more."""
        ...

    def open_profile(self, key: str) -> Performer:
        """Load a profile and make its tracker."""
        ...

    def open_free(self) -> Performer:
        """Make a tracker that needs no profile."""
        ...


@dataclass(frozen=True, slots=True)
class Wanted:
    """What to play.

    Attributes:
        source: Key of a source.
        profile: Key of a profile; empty tracks without one.
    """

    source: str
    profile: str


@dataclass(frozen=True, slots=True, eq=False)
class Opened:
    """A source ready to play.

    Attributes:
        wanted: What was asked for.
        source: To be closed by who takes it.
        performer: Tracks the face; without the profile, if that cannot be used.
        trouble: Why the profile cannot be used, None if it can or none was asked for.
    """

    wanted: Wanted
    source: FrameSource
    performer: Performer
    trouble: CoreError | AppError | None


class Opening:
    """Opens what is wanted, in steps; `result` is there after the last one."""

    def __init__(self, opener: Opener, wanted: Wanted) -> None:
        self._opener, self._wanted = opener, wanted
        self.result: Opened | None = None

    def steps(self) -> Generator[Progress, None, None]:
        """Open the profile, then the source.

        Raises:
            AppError: The source cannot be read.
        """
        yield Progress(0, 2, "Preparing the tracker")
        performer, trouble = self._performer()
        yield Progress(1, 2, "Opening the source")
        source = self._opener.open_source(self._wanted.source, performer.tracker.reset)
        self.result = Opened(self._wanted, source, performer, trouble)

    def _performer(self) -> tuple[Performer, CoreError | AppError | None]:
        if not self._wanted.profile:
            return self._opener.open_free(), None
        try:
            return self._opener.open_profile(self._wanted.profile), None
        except (CoreError, AppError) as error:
            return self._opener.open_free(), error


class Player(QObject):
    """Runs at most one thread, which opens or plays; a new wish waits until that has ended.

    So a camera is free before it is opened again, and of several quick wishes only the last is
    fulfilled. Nothing here makes the Qt thread wait, except `stop`.
    """

    preparing = Signal(object)  # Progress towards `opened`
    opened = Signal(object)  # Opened, before its first frame
    framed = Signal(object)  # LiveResult
    failed = Signal(object)  # CoreError or AppError: nothing is played any more
    broken = Signal()  # an error of the program, which went to the except hook

    def __init__(
        self,
        opener: Opener,
        solved: Callable[[Frame, FaceState, float], FaceState | None],
        parent: QObject | None = None,
    ) -> None:
        """Prepare to play.

        Args:
            opener: Opens sources and profiles, in a background thread.
            solved: Called in the live thread with each frame, its state, and when the frame was
                delivered, on the clock of time.perf_counter. It returns what the avatar makes of
                the state, or None: just that.
            parent: Of the object.
        """
        super().__init__(parent)
        self._opener, self._solved = opener, solved
        self._next: Wanted | None = None
        self._thread: QThread | None = None
        self._opening: Opening | None = None
        self._loop: LiveLoop | None = None
        self._source: FrameSource | None = None
        self._leaving, self._failed = False, False

    @property
    def trouble(self) -> str:
        """Why the source gives no pictures now, for people: a camera that is gone, say; or empty.

        To be asked now and then by the window; the source goes on by itself when it can.
        """
        return str(getattr(self._source, "trouble", ""))

    @property
    def busy(self) -> bool:
        """Whether a thread opens, plays, or is about to end."""
        return self._thread is not None

    def play(self, wanted: Wanted | None) -> None:
        """Play this as soon as what is played now has ended; None plays nothing."""
        self._next = wanted
        if self._thread is None:
            self._open_next()
        else:
            self._leave(self._thread)

    def stop(self) -> None:
        """End everything and wait for it; the source is closed."""
        self._next, self._leaving = None, True
        if self._thread is not None:
            self._leave(self._thread)
            self._thread.wait()
            self._on_finished()

    def _leave(self, thread: QThread) -> None:
        """Ask a thread to end; a source that waits for its camera waits no longer."""
        self._leaving = True
        thread.requestInterruption()
        if isinstance(self._source, Interruptible):
            self._source.interrupt()

    def _open_next(self) -> None:
        wanted, self._next = self._next, None
        self._leaving, self._failed = False, False
        if wanted is None:
            return
        self._opening = Opening(self._opener, wanted)
        job = Job(self._opening.steps(), self)
        job.progressed.connect(self._on_progressed)
        job.failed.connect(self._on_failed)
        self._run(job)

    def _start_loop(self, opened: Opened) -> None:
        self.opened.emit(opened)
        loop = LiveLoop(opened.source, self._stepper(opened.performer), self)
        loop.posted.connect(self._on_posted)
        loop.failed.connect(self._on_failed)
        loop.ended.connect(self._on_ended)
        self._loop, self._source = loop, opened.source
        self._run(loop)

    def _run(self, thread: QThread) -> None:
        self._thread = thread
        thread.finished.connect(self._on_finished)
        thread.start()

    def _stepper(self, performer: Performer) -> Callable[[Frame], tuple[FaceState, FaceState]]:
        def step(frame: Frame) -> tuple[FaceState, FaceState]:
            delivered_s = time.perf_counter()
            state = performer.tracker.step(frame)
            return state, self._solved(frame, state, delivered_s) or state

        return step

    def _on_progressed(self, progress: Progress) -> None:
        if not self._leaving:
            self.preparing.emit(progress)

    def _on_posted(self) -> None:
        result = self._loop.results.take() if self._loop is not None else None
        if result is not None and not self._leaving:
            self.framed.emit(result)

    def _on_ended(self) -> None:
        self._on_failed(SourceEndedError(self._source.name if self._source is not None else ""))

    def _on_failed(self, error: CoreError | AppError) -> None:
        self._failed = True
        if not self._leaving:
            self.failed.emit(error)

    def _on_finished(self) -> None:
        thread, opening = self._thread, self._opening
        # After `stop` the signal of a thread that is gone may still come.
        if thread is None or not thread.isFinished():
            return
        thread.wait()
        thread.deleteLater()
        self._thread, self._opening, self._loop, self._source = None, None, None, None
        opened = opening.result if opening is not None else None
        if opened is not None and not self._leaving:
            self._start_loop(opened)
            return
        if opened is not None:
            opened.source.close()
        if not self._leaving and not self._failed:
            self.broken.emit()
        self._open_next()
