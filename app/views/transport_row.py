"""The buttons below the pictures for what can be paused and moved: videos and the performer."""

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QLabel,
    QToolButton,
    QWidget,
)

from app.views.seek_slider import SeekSlider
from app.views.takes.icons import sign


class TransportRow(QWidget):
    """Shows where a recording is; the buttons are those of the menu."""

    position_wanted = Signal(int)  # number of a frame
    speed_wanted = Signal(float)

    def __init__(
        self, actions: tuple[QAction, QAction, QAction, QAction], parent: QWidget | None = None
    ) -> None:
        """Make the row.

        Args:
            actions: Previous frame, pause, next frame, loop.
            parent: Of the widget.
        """
        super().__init__(parent)
        self.slider, self.time = SeekSlider(), QLabel()
        self.speed = QComboBox()
        self.slider.setAccessibleName("Position")
        self.slider.setToolTip("Position in the recording")
        self.time.setAccessibleName("Time")
        self.speed.setAccessibleName("Speed")
        self.speed.setToolTip("Speed")
        self._actions = actions
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        for action in actions:
            action.setIconVisibleInMenu(False)
            button = QToolButton()
            button.setDefaultAction(action)
            button.setAutoRaise(True)
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            row.addWidget(button)
        row.addWidget(self.slider, stretch=1)
        row.addWidget(self.time)
        row.addWidget(self.speed)
        actions[1].toggled.connect(self._draw_signs)
        self._draw_signs()
        self.slider.valueChanged.connect(self.position_wanted)
        self.speed.activated.connect(
            lambda place: self.speed_wanted.emit(self.speed.itemData(place))
        )
        self.hide()

    def changeEvent(self, event: QEvent) -> None:
        """Take on another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._draw_signs()

    def _draw_signs(self) -> None:
        back, pause, forth, _ = self._actions
        paused = pause.isChecked()
        for action, name in ((back, "back"), (pause, "play" if paused else "pause")):
            action.setIcon(sign(name, self))
        forth.setIcon(sign("forth", self))

    def show_speeds(self, speeds: tuple[float, ...]) -> None:
        """List the speeds; the usual one is chosen."""
        self.speed.clear()
        for speed in speeds:
            self.speed.addItem(f"{speed:g}×", speed)
        self.speed.setCurrentIndex(speeds.index(1.0))

    def show_position(self, position: int, n_frames: int, fps: float) -> None:
        """Show where the recording is; a slider that is being dragged stays with the mouse."""
        self.slider.setMaximum(max(n_frames - 1, 0))
        if not self.slider.isSliderDown():
            self.slider.blockSignals(True)  # shown, not wished for
            self.slider.setValue(position)
            self.slider.blockSignals(False)
        self.time.setText(f"{clock_text(position / fps)} / {clock_text(n_frames / fps)}")


def clock_text(time_s: float) -> str:
    """Return a time as minutes, seconds and tenths."""
    minutes, seconds = divmod(max(time_s, 0.0), 60)
    return f"{int(minutes)}:{seconds:04.1f}"
