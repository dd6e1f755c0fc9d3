"""The render thread for Qt: newest wish in, newest avatar picture out."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from PySide6.QtCore import QObject, Signal

from app.errors import AppError
from app.painting import LiveWish
from app.render.quality import Drawn
from app.workers.latest import Latest
from core.records import U8


@dataclass(frozen=True, slots=True, eq=False)
class Painted:
    """A picture of the avatar and when it was ready.

    Attributes:
        picture: (H, W, 4) uint8.
        wish: What it shows.
        ready_s: On the clock of time.perf_counter.
        drawn: How well.
    """

    picture: U8
    wish: LiveWish
    ready_s: float
    drawn: Drawn = field(default_factory=Drawn)


class DrawingThread(Protocol):
    """What is needed of app.render.thread.RenderThread."""

    def start(self) -> None:
        """Begin to draw."""
        ...

    def ask(self, wish: LiveWish) -> None:
        """Wish for a picture in place of one that is not begun yet."""
        ...

    def stop(self) -> None:
        """End after the picture being drawn, and wait for that."""
        ...


#: Makes a thread from what is to be called, in that thread, with each picture and an error.
MakeThread = Callable[[Callable[[Painted], None], Callable[[AppError], None]], DrawingThread]


def painted(
    draw: Callable[[LiveWish], U8], drawn: Callable[[], Drawn] = Drawn
) -> Callable[[LiveWish], Painted]:
    """Return what draws a wish and notes when the picture was ready and how it was drawn."""
    return lambda wish: Painted(draw(wish), wish, time.perf_counter(), drawn())


class AvatarLoop(QObject):
    """Hands wishes to a render thread and its pictures to the Qt thread."""

    posted = Signal()
    failed = Signal(object)  # AppError; nothing more is drawn

    def __init__(self, make_thread: MakeThread, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.pictures: Latest[Painted] = Latest()
        self._thread = make_thread(self._on_done, self.failed.emit)

    def start(self) -> None:
        """Begin to draw; connect the signals before."""
        self._thread.start()

    def ask(self, wish: LiveWish) -> None:
        """Wish for a picture; from any thread."""
        self._thread.ask(wish)

    def stop(self) -> None:
        """Ask for an end and wait for it."""
        self._thread.stop()

    def _on_done(self, picture: Painted) -> None:
        """Leave a picture in the mailbox; called in the render thread."""
        if self.pictures.put(picture):
            self.posted.emit()
