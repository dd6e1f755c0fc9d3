"""The take that is played: where it is, and what of it counts."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from app.views.takes.icons import sign
from app.views.takes.record_row import clock
from app.views.takes.trim_slider import TrimSlider

#: Key, sign, tool tip.
BUTTONS = (
    ("toggle", "pause", "Play or stop (Space)"),
    ("back", "back", "One frame back (Left)"),
    ("forth", "forth", "One frame forth (Right)"),
    ("in", "in", "Let the take begin here (I)"),
    ("out", "out", "Let the take end here (O)"),
)


class PlayerBox(QWidget):
    """Shows the take that is played; hidden without one."""

    wished = Signal(str)  # a key of BUTTONS, "start", "end", "whole"
    seek_wanted = Signal(float)
    trim_wanted = Signal(float, float)
    loop_wanted = Signal(bool)
    live_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.slider = TrimSlider()
        self.title, self.time_label = QLabel(), QLabel()
        self.loop_box = QCheckBox("&Loop")
        self.loop_box.setChecked(True)
        self.whole_button = QPushButton("&Untrim")
        self.whole_button.setToolTip("Let all of the take count again")
        self.live_button = QPushButton("&Back to live")
        self.buttons = {key: self._button(key, tip) for key, _, tip in BUTTONS}
        self._build()
        self._connect()
        self.hide()

    def show_take(self, name: str, length_s: float, range_s: tuple[float, float]) -> None:
        """Show which take is played."""
        self.title.setText(f"<b>{name}</b>")
        self.slider.show_take(length_s, range_s)
        self._length_s, self._range_s = length_s, range_s
        self.whole_button.setEnabled(range_s != (0.0, length_s))
        for key, icon, _ in BUTTONS:
            self.buttons[key].setIcon(sign(icon, self))
        self.show()

    def show_position(self, position_s: float, playing: bool) -> None:
        """Show where it is, and whether it goes on."""
        self.slider.show_position(position_s)
        kept_s = self._range_s[1] - self._range_s[0]
        text = f"{fine_clock(position_s)} of {fine_clock(self._length_s)}"
        if self.whole_button.isEnabled():
            text += f", {kept_s:.1f} s kept"
        self.time_label.setText(text)
        self.buttons["toggle"].setIcon(sign("pause" if playing else "play", self))

    def _button(self, key: str, tip: str) -> QToolButton:
        button = QToolButton()
        button.setToolTip(tip)
        button.setAccessibleName(tip)
        button.clicked.connect(lambda: self.wished.emit(key))
        return button

    def _build(self) -> None:
        self._length_s, self._range_s = 0.0, (0.0, 0.0)
        self.time_label.setAccessibleName("Position")
        keys = QHBoxLayout()
        keys.setSpacing(3)
        for key in ("toggle", "back", "forth", "in", "out"):
            keys.addWidget(self.buttons[key])
        keys.addStretch(1)
        keys.addWidget(self.loop_box)
        foot = QHBoxLayout()
        foot.addWidget(self.live_button, stretch=1)
        foot.addWidget(self.whole_button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 4, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.title)
        layout.addWidget(self.slider)
        layout.addWidget(self.time_label)
        layout.addLayout(keys)
        layout.addLayout(foot)

    def _connect(self) -> None:
        self.slider.moved.connect(self.seek_wanted)
        self.slider.trimmed.connect(self.trim_wanted)
        self.slider.wished.connect(self.wished)
        self.loop_box.toggled.connect(self.loop_wanted)
        self.live_button.clicked.connect(self.live_wanted)
        self.whole_button.clicked.connect(lambda: self.wished.emit("whole"))


def fine_clock(seconds: float) -> str:
    """Return a time with tenths of a second."""
    return f"{clock(seconds)}.{int(10 * seconds + 1e-6) % 10}"
