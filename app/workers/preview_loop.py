"""Reads one camera for its preview: the newest picture, and how many there are a second."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import Any

from PySide6.QtCore import QObject, QThread, Signal

from app.capture.source import FrameSource
from app.errors import AppError, CameraLostError
from app.workers.latest import Latest
from core.errors import CoreError
from core.records import Frame
from core.shot_quality import is_blank

#: Frames over which the speed is measured, and how many it takes at least.
SPEED_FRAMES, LEAST_FRAMES = 45, 8
#: A look takes about as long as a frame: with every one the camera would seem slow.
LOOK_EVERY = 2
#: Time and number of a frame.
Mark = tuple[float, int]


@dataclass(frozen=True, slots=True, eq=False)
class Preview:
    """What a camera shows.

    Attributes:
        frame: The newest frame.
        fps: Measured frames per second, NaN while there are too few.
        blank: Whether the picture shows nothing, as behind a closed lid.
        seen: What the look at it or the frame before returned, None if nobody looks.
    """

    frame: Frame
    fps: float
    blank: bool
    seen: Any


class PreviewLoop(QThread):
    """Opens and reads a source until it is told to end; closes it before `finished`."""

    posted = Signal()  # at most once per emptied `previews`
    failed = Signal(object)  # CoreError or AppError
    answered = Signal(object)  # what a wish returned

    def __init__(
        self, open_source: Callable[[], FrameSource], parent: QObject | None = None
    ) -> None:
        """Prepare.

        Args:
            open_source: Called in the thread.
            parent: Of the thread object.
        """
        super().__init__(parent)
        self._open_source = open_source
        self._wishes: SimpleQueue[Callable[[FrameSource], object]] = SimpleQueue()
        self.previews: Latest[Preview] = Latest()
        #: Called in the thread with every LOOK_EVERY-th frame.
        self.look: Callable[[Frame], object] | None = None

    def ask(self, wish: Callable[[FrameSource], object]) -> None:
        """Do something with the source between two frames; `answered` comes afterwards."""
        self._wishes.put(wish)

    def run(self) -> None:
        """Read the source; called by QThread in the new thread."""
        try:
            with self._open_source() as source:
                self._read(source)
        except (CoreError, AppError) as error:
            self.failed.emit(error)

    def stop(self) -> None:
        """Ask for an end and wait for it; at most one frame later."""
        self.requestInterruption()
        self.wait()

    def _read(self, source: FrameSource) -> None:
        marks: deque[Mark] = deque(maxlen=SPEED_FRAMES)
        seen: object = None
        while not self.isInterruptionRequested():
            self._fulfil(source, marks)
            frame = source.read()
            if frame is None:
                raise CameraLostError(source.name, 0)
            if not source.live:
                self.usleep(round(1e6 / source.fps))
            marks.append((frame.time_s, frame.index))
            look = self.look
            if look is None:
                seen = None
            elif frame.index % LOOK_EVERY == 0 or seen is None:
                seen = look(frame)
            if self.previews.put(Preview(frame, _fps(marks), is_blank(frame.gray), seen)):
                self.posted.emit()

    def _fulfil(self, source: FrameSource, marks: deque[Mark]) -> None:
        while True:
            try:
                wish = self._wishes.get_nowait()
            except Empty:
                return
            self.answered.emit(wish(source))
            # A wish takes its time, which says nothing about the camera's speed.
            marks.clear()


def _fps(marks: deque[Mark]) -> float:
    if len(marks) < LEAST_FRAMES:
        return float("nan")
    (first_s, first), (last_s, last) = marks[0], marks[-1]
    return (last - first) / (last_s - first_s) if last_s > first_s else float("nan")
