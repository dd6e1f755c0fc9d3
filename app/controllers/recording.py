"""Recording from the live window: begun, paused, ended; the live thread never waits for it."""

from dataclasses import replace
from datetime import datetime

from PySide6.QtCore import QObject, Qt, QTimer, Signal

from app.controllers.live import LiveController
from app.controllers.player import Opened
from app.errors import AppError
from app.recording.sink import reason
from app.takes.library import TakeFacts, name_at, part_folder
from app.takes.recorder import Ending, Recorder
from app.workers.live_loop import LiveResult

SHOW_EVERY_MS = 200
NOTHING = "There is no picture to record: choose a source first."


class RecordingDesk(QObject):
    """Records at most one take at a time."""

    changed = Signal()  # state or time
    ended = Signal(object)  # Ending
    _over = Signal(object)

    def __init__(self, controller: LiveController, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._controller = controller
        self._recorder: Recorder | None = None
        self._saving = False
        self._opened: Opened | None = None
        self._size_px: tuple[int, int] | None = None
        self._timer = QTimer(self)
        self._timer.timeout.connect(self.changed)
        # `ended` of the recorder comes in its own thread.
        self._over.connect(self._on_over, Qt.ConnectionType.QueuedConnection)
        controller.player.opened.connect(self._on_opened)
        controller.solved.connect(self._on_solved)
        controller.source_changed.connect(lambda _: self._on_source_changed())
        controller.ending.connect(self.finish)

    @property
    def state(self) -> str:
        """One of "off", "recording", "paused" and "saving"."""
        if self._recorder is None:
            return "off"
        if self._saving:
            return "saving"
        return "paused" if self._recorder.paused else "recording"

    @property
    def seconds(self) -> float:
        """What is recorded so far."""
        return 0.0 if self._recorder is None else self._recorder.seconds

    def begin(self, with_video: bool) -> None:
        """Record from the next frame on.

        Raises:
            AppError: There is nothing to record, or no place for it.
        """
        if self._recorder is not None:
            return
        opened, size_px = self._opened, self._size_px
        if size_px is None or opened is None or not self._controller.player.busy:
            raise AppError(NOTHING)
        now = datetime.now().astimezone()
        facts = self._facts(now, opened, size_px)
        part = part_folder(name_at(now))
        recorder = Recorder(part, replace(facts, video=with_video), self._over.emit)
        try:
            recorder.start()
        except OSError as error:
            raise AppError(f"cannot record: {reason(error)}; make room on the disk") from None
        self._recorder, self._saving = recorder, False
        self._controller.add_listener(recorder.take)
        self._timer.start(SHOW_EVERY_MS)
        self.changed.emit()

    def pause(self) -> None:
        """Leave out what follows, or go on."""
        if self._recorder is not None and not self._saving:
            self._recorder.pause(not self._recorder.paused)
            self.changed.emit()

    def stop(self) -> None:
        """End the recording; `ended` tells when the take is there."""
        if self._recorder is not None and not self._saving:
            self._saving = True
            self._controller.remove_listener(self._recorder.take)
            self._recorder.stop()
            self.changed.emit()

    def finish(self) -> None:
        """End the recording and wait until the take is complete."""
        self.stop()
        if self._recorder is not None:
            self._recorder.wait()

    def _facts(self, now: datetime, opened: Opened, size_px: tuple[int, int]) -> TakeFacts:
        tracker = getattr(opened.performer.tracker, "tracker", opened.performer.tracker)
        camera = getattr(tracker, "camera", None)
        return TakeFacts(
            made=now.isoformat(timespec="seconds"),
            source=opened.source.name,
            profile=self._controller.wanted.profile,
            avatar=self._controller.scene.avatar,
            mode="auto",
            fps=float(opened.source.fps),
            size_px=size_px,
            focal_px=float(max(size_px) if camera is None else camera.focal_px),
        )

    def _on_opened(self, opened: Opened) -> None:
        self._opened, self._size_px = opened, None

    def _on_solved(self, result: LiveResult) -> None:
        height, width = result.frame.gray.shape
        self._size_px = (width, height)

    def _on_source_changed(self) -> None:
        self._size_px = None
        self.stop()

    def _on_over(self, ending: Ending) -> None:
        """Tell of the end; the recorder's thread is about to be gone."""
        recorder, self._recorder, self._saving = self._recorder, None, False
        if recorder is not None:
            self._controller.remove_listener(recorder.take)
            recorder.wait()
        self._timer.stop()
        self.changed.emit()
        self.ended.emit(ending)
