"""Lets the avatar live on while a camera is gone and no frames come at all."""

import time
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer

from app.controllers.live import LiveController
from app.workers.live_loop import LiveResult

if TYPE_CHECKING:
    from core.records import FaceState

#: Looks whether the camera gives pictures, and pictures of the idle avatar.
LOOK_EVERY_MS, STEP_EVERY_MS = 250, 40


class Idling(QObject):
    """Drives a face that is lost, in place of the live thread, which waits for its camera."""

    def __init__(self, controller: LiveController) -> None:
        super().__init__(controller)
        self._controller = controller
        self._last: FaceState | None = None
        self._last_s = 0.0
        self._timer = QTimer(self)
        self._timer.setInterval(LOOK_EVERY_MS)
        self._timer.timeout.connect(self._look)
        self._timer.start()
        controller.solved.connect(self._on_solved)
        controller.source_changed.connect(self._forget)
        controller.ending.connect(self._timer.stop)

    def _on_solved(self, result: LiveResult) -> None:
        self._last, self._last_s = result.state, time.monotonic()

    def _forget(self) -> None:
        self._last = None

    def _look(self) -> None:
        """Step while the camera is gone; a paused film is left as it is."""
        idle = self._last is not None and bool(self._controller.player.trouble)
        self._timer.setInterval(STEP_EVERY_MS if idle else LOOK_EVERY_MS)
        if idle and self._last is not None:
            time_s = self._last.time_s + time.monotonic() - self._last_s
            lost = replace(self._last, time_s=time_s, confidence=0.0, lost=True)
            self._controller.scene.show(self._controller.drive.step(lost), time.perf_counter())
