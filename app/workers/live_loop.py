"""The live thread: read, step, post."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from PySide6.QtCore import QObject, QThread, Signal

from app.capture.source import FrameSource
from app.errors import AppError
from app.workers.latest import Latest
from core.errors import CoreError
from core.records import FaceState, Frame


@dataclass(frozen=True, slots=True, eq=False)
class LiveResult:
    """A frame and what was made of it.

    Attributes:
        frame: The frame.
        state: The solved face.
        driven: What the avatar makes of it.
        step_ms: Wall time of the step.
    """

    frame: Frame
    state: FaceState
    driven: FaceState
    step_ms: float


class LiveLoop(QThread):
    """Reads a source at its pace, solves every frame and posts the newest result.

    `results` is emptied by the reader, best on a timer of its own; `posted` comes at most once
    per emptied result, so that signals cannot pile up. The source is closed in this thread,
    before `finished`.
    """

    posted = Signal()
    ended = Signal()  # the source has no more frames
    failed = Signal(object)  # CoreError or AppError

    def __init__(
        self,
        source: FrameSource,
        step: Callable[[Frame], tuple[FaceState, FaceState]],
        parent: QObject | None = None,
    ) -> None:
        """Prepare to play a source, which this loop owns from now on.

        Args:
            source: Read until it ends. One that is not live is played at its own frame rate;
                frames are left out where the step is slower than that.
            step: Returns the solved face of one frame and what the avatar makes of it; called in
                the live thread only.
            parent: Of the thread object.
        """
        super().__init__(parent)
        self._source, self._step = source, step
        self.results: Latest[LiveResult] = Latest()

    def run(self) -> None:
        """Play the source; called by QThread in the new thread."""
        with self._source:
            try:
                self._play()
            except (CoreError, AppError) as error:
                self.failed.emit(error)

    def stop(self) -> None:
        """Ask for an end and wait for it; at most one frame later."""
        self.requestInterruption()
        self.wait()

    def _play(self) -> None:
        started_s: float | None = None
        while not self.isInterruptionRequested():
            frame = self._source.read()
            if frame is None:
                # A source that waited for its camera may have been interrupted.
                if not self.isInterruptionRequested():
                    self.ended.emit()
                return
            now_s = time.perf_counter()
            if started_s is None:
                started_s = now_s - frame.time_s
            if not self._source.live and self._late(started_s + frame.time_s - now_s):
                continue
            self._post(frame)

    def _late(self, wait_s: float) -> bool:
        """Wait until a recorded frame is due; return whether it is more than a frame too late."""
        if wait_s > 0:
            self.usleep(round(1e6 * wait_s))
        return wait_s < -1 / self._source.fps

    def _post(self, frame: Frame) -> None:
        before_s = time.perf_counter()
        state, driven = self._step(frame)
        step_ms = 1000 * (time.perf_counter() - before_s)
        if self.results.put(LiveResult(frame, state, driven, step_ms)):
            self.posted.emit()
