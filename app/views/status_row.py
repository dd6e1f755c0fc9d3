"""The status line: is the face tracked, how well, and how fast."""

from dataclasses import dataclass

from PySide6.QtCore import QSize
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QLabel, QStatusBar, QWidget

from app.views.narrow import fit_row

#: Room for the state.
LEAST_PX = 200
GOOD, WAITING, OFF = QColor(46, 160, 67), QColor(219, 140, 0), QColor(128, 128, 128)
#: State -> what people read, colour of the lamp. The text says all that the colour says.
STATES = {
    "off": ("No source", OFF),
    "take": ("Playing a take", GOOD),
    "gone": ("Camera gone: waiting for it", WAITING),
    "opening": ("Opening…", WAITING),
    "searching": ("Searching for the face", WAITING),
    "trained": ("Tracking, trained", GOOD),
    "trained_unsure": ("Unsure: other light, or not the person of the profile?", WAITING),
    "free": ("Tracking, training-free", GOOD),
    "free_unsure": ("Unsure: is the whole face in the picture, and in the light?", WAITING),
}
#: Field -> the longest text, what it means.
FIELDS = {
    "confidence": ("confidence 100 %", "How sure the tracker is of the face it follows"),
    "rate": ("120 fps", "Frames per second"),
    "solve": ("solve 100.0 ms", "Time to find the face in one frame"),
    "latency": ("latency 1000 ms", "Time from a frame's arrival to the avatar's picture"),
    "dropped": ("10000 dropped", "Frames left out because the computer was too slow"),
    "cpu": ("CPU 100 %", "Share of this computer's processors that facepuppet uses"),
    "quality": ("avatar 100 %", "Sharpness of the avatar: less where drawing takes too long"),
}


ACCESSIBLE = {"cpu": "Processor share", "quality": "Avatar quality", "rate": "Frame rate"}


@dataclass(frozen=True, slots=True)
class LiveNumbers:
    """What the status line says.

    Attributes:
        state: A key of STATES.
        confidence: In [0, 1].
        frames_per_second: Frames shown or solved per second.
        solve_ms: Time to solve one frame.
        latency_ms: From the frame's delivery to the avatar's picture.
        dropped: Frames skipped because they came too fast.
        cpu_share: Of all processors, in [0, 1].
        avatar_scale: Share of its full width and height at which the avatar is drawn.
    """

    state: str
    confidence: float = 0.0
    frames_per_second: float = 0.0
    solve_ms: float = 0.0
    latency_ms: float = 0.0
    dropped: int = 0
    cpu_share: float = 0.0
    avatar_scale: float = 1.0


class Lamp(QWidget):
    """A coloured dot."""

    def __init__(self) -> None:
        super().__init__()
        self._color = OFF
        side = self.fontMetrics().ascent()
        self.setFixedSize(QSize(side + 6, side))

    def show_color(self, color: QColor) -> None:
        """Change the colour."""
        self._color = color
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the dot."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(self._color.darker(130))
        painter.setBrush(self._color)
        side = self.height() - 4
        painter.drawEllipse(5, 2, side, side)
        painter.end()


class StatusRow(QStatusBar):
    """A lamp, the state, and numbers that change without moving each other."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._lamp, self._state = Lamp(), QLabel()
        self._state.setAccessibleName("State")
        self.addWidget(self._lamp)
        self.addWidget(self._state, 1)
        self._fields = {name: self._add_field(name) for name in FIELDS}
        self.setMinimumWidth(LEAST_PX)
        self.show_numbers(LiveNumbers("off"))

    @property
    def state(self) -> str:
        """The shown state, for people."""
        return self._state.text()

    def field(self, name: str) -> str:
        """Return the text of one of FIELDS."""
        return self._fields[name].text()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Leave out the numbers that have no room."""
        super().resizeEvent(event)
        fields = list(self._fields.values())
        fit_row(fields, fields[::-1], event.size().width() - LEAST_PX)

    def show_numbers(self, numbers: LiveNumbers) -> None:
        """Show the state and the numbers that mean something in it."""
        text, color = STATES[numbers.state]
        self._state.setText(text)
        self._lamp.show_color(color)
        sees = numbers.state not in ("off", "gone", "opening", "searching")
        solves = sees or numbers.state == "searching"
        texts = {
            "confidence": (f"confidence {100 * numbers.confidence:.0f} %", sees),
            "rate": (f"{numbers.frames_per_second:.0f} fps", solves),
            "solve": (f"solve {numbers.solve_ms:.1f} ms", solves and numbers.solve_ms > 0),
            "latency": (f"latency {numbers.latency_ms:.0f} ms", solves and numbers.latency_ms > 0),
            "dropped": (f"{numbers.dropped} dropped", solves),
            "cpu": (f"CPU {100 * numbers.cpu_share:.0f} %", numbers.cpu_share > 0),
            "quality": (
                f"avatar {100 * numbers.avatar_scale:.0f} %", solves and numbers.latency_ms > 0
            ),
        }  # fmt: skip
        for name, (shown, means_something) in texts.items():
            self._fields[name].setText(shown if means_something else "")

    def _add_field(self, name: str) -> QLabel:
        longest, meaning = FIELDS[name]
        label = QLabel()
        label.setMinimumWidth(self.fontMetrics().horizontalAdvance(longest) + 12)
        label.setAccessibleName(ACCESSIBLE.get(name, name.capitalize()))
        label.setToolTip(meaning)
        self.addPermanentWidget(label)
        return label
