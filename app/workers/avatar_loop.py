"""The render thread: newest face state in, newest avatar picture out."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from threading import Event
from typing import Protocol

from PySide6.QtCore import QObject, QThread, Signal

from app.errors import AppError
from app.workers.latest import Latest
from core.records import U8, FaceState


class Painter(Protocol):
    """Draws one avatar; made, used and released in the render thread."""

    def paint(self, state: FaceState) -> U8:
        """Return the avatar's picture (H, W, 4)."""
        ...

    def release(self) -> None:
        """Give the graphics resources back."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Painted:
    """A picture of the avatar and when it was ready.

    Attributes:
        picture: (H, W, 4) uint8.
        state: What it shows.
        ready_s: On the clock of time.perf_counter.
    """

    picture: U8
    state: FaceState
    ready_s: float


class AvatarLoop(QThread):
    """Paints the newest posted state; states that come too fast are skipped.

    OpenGL contexts belong to one thread, so the painter is made in `run`.
    """

    posted = Signal()
    failed = Signal(object)  # AppError

    def __init__(self, make_painter: Callable[[], Painter], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._make_painter = make_painter
        self._states: Latest[FaceState] = Latest()
        self._wake = Event()
        self.pictures: Latest[Painted] = Latest()

    def show_state(self, state: FaceState) -> None:
        """Ask for a picture of this state."""
        self._states.put(state)
        self._wake.set()

    def run(self) -> None:
        """Paint until stopped; called by QThread in the new thread."""
        try:
            painter = self._make_painter()
        except AppError as error:
            self.failed.emit(error)
            return
        try:
            while not self.isInterruptionRequested():
                self._wake.wait()
                self._wake.clear()
                self._paint_newest(painter)
        finally:
            painter.release()

    def stop(self) -> None:
        """Ask for an end and wait for it."""
        self.requestInterruption()
        self._wake.set()
        self.wait()

    def _paint_newest(self, painter: Painter) -> None:
        state = self._states.take()
        if state is None:
            return
        painted = Painted(painter.paint(state), state, time.perf_counter())
        if self.pictures.put(painted):
            self.posted.emit()
