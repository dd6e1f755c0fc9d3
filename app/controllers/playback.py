"""Pause, step and move what is played, where it can be."""

from PySide6.QtCore import QObject, QTimer

from app.capture.played import SPEEDS, Played
from app.controllers.live import LiveController
from app.controllers.player import Opened
from app.views.live_window import LiveWindow

SHOW_EVERY_MS = 100
KEYS = ("previous", "pause", "next", "loop")


class Playback(QObject):
    """Joins the row of buttons and the menu with the source, while that can be moved."""

    def __init__(self, controller: LiveController, window: LiveWindow) -> None:
        super().__init__(controller)
        self._window, self._row, deeds = window, window.transport, window.deeds
        self._source: Played | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(SHOW_EVERY_MS)
        self._timer.timeout.connect(self._show)
        self._row.show_speeds(SPEEDS)
        controller.player.opened.connect(self._on_opened)
        controller.source_changed.connect(lambda _: self._use(None))
        controller.player.failed.connect(lambda _: self._use(None))
        deeds["pause"].toggled.connect(self._on_pause)
        deeds["next"].triggered.connect(lambda: self._step(1))
        deeds["previous"].triggered.connect(lambda: self._step(-1))
        deeds["loop"].toggled.connect(self._on_loop)
        self._row.position_wanted.connect(self._on_position)
        self._row.speed_wanted.connect(self._on_speed)
        self._use(None)

    def _on_opened(self, opened: Opened) -> None:
        self._use(opened.source if isinstance(opened.source, Played) else None)

    def _use(self, source: Played | None) -> None:
        self._source, deeds = source, self._window.deeds
        for key in KEYS:
            deeds[key].setEnabled(source is not None)
        deeds["pause"].setChecked(False)
        self._row.setVisible(source is not None)
        if source is None:
            self._timer.stop()
            return
        source.set_loop(deeds.on("loop"))
        source.set_speed(float(self._row.speed.currentData()))
        self._timer.start()

    def _show(self) -> None:
        source = self._source
        if source is None:
            return
        self._row.show_position(source.position, source.n_frames, source.fps)
        # After the last frame it holds by itself.
        self._window.deeds["pause"].setChecked(source.paused)

    def _on_pause(self, paused: bool) -> None:
        if self._source is not None and self._source.paused != paused:
            self._source.pause(paused)

    def _step(self, by: int) -> None:
        if self._source is not None:
            self._window.deeds["pause"].setChecked(True)
            self._source.step(by)

    def _on_loop(self, loop: bool) -> None:
        if self._source is not None:
            self._source.set_loop(loop)

    def _on_position(self, position: int) -> None:
        if self._source is not None:
            self._source.go_to(position)

    def _on_speed(self, speed: float) -> None:
        if self._source is not None:
            self._source.set_speed(speed)
