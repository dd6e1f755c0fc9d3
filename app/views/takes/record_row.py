"""Record, pause, and how long it has been going on."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import (
    QCheckBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from app.views.takes.icons import RECORD_COLOR, sign


class RecordRow(QWidget):
    """Says when to record; shows that it is done."""

    record_wanted = Signal()
    pause_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.record_button, self.pause_button = QPushButton("&Record"), QPushButton("Pa&use")
        self.video_box = QCheckBox("With the &webcam's pictures")
        self.video_box.setToolTip(
            "Then a take can be seen beside the avatar, and solved again with another profile"
        )
        self.time_label = QLabel()
        self.time_label.setAccessibleName("Recorded time")
        self.record_button.setToolTip("Record what the avatar does, or end the recording (R)")
        self.pause_button.setToolTip("Leave out what follows, or go on (P)")
        row = QHBoxLayout()
        row.addWidget(self.record_button, stretch=1)
        row.addWidget(self.pause_button, stretch=1)
        row.addWidget(self.time_label)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(row)
        layout.addWidget(self.video_box)
        self.record_button.clicked.connect(self.record_wanted)
        self.pause_button.clicked.connect(self.pause_wanted)
        self.show_state("off", 0.0)

    @property
    def with_video(self) -> bool:
        """Whether the pictures are wanted, too."""
        return self.video_box.isChecked()

    def show_state(self, state: str, seconds: float) -> None:
        """Show "off", "recording", "paused" or "saving", and the time."""
        names = {"off": "&Record", "saving": "Saving…"}
        self.record_button.setText(names.get(state, "&Stop"))
        self.record_button.setIcon(sign("record" if state == "off" else "stop", self))
        self.record_button.setEnabled(state != "saving")
        self.pause_button.setText("&Go on" if state == "paused" else "Pa&use")
        self.pause_button.setIcon(sign("record" if state == "paused" else "pause", self))
        self.pause_button.setEnabled(state in ("recording", "paused"))
        self.video_box.setEnabled(state == "off")
        self.time_label.setText("" if state == "off" else clock(seconds))


class TakeBadge(QLabel):
    """What the status line says while a take is recorded or played."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Take")
        self.hide()

    @property
    def shown(self) -> str:
        """What is said, empty while hidden."""
        return "" if self.isHidden() else self.text()

    def show_state(self, text: str, recording: bool) -> None:
        """Say something, or with an empty text nothing; a recording in red, with a dot."""
        colors = QPalette(self.palette())
        ground = RECORD_COLOR if recording else colors.color(QPalette.ColorRole.Highlight)
        colors.setColor(QPalette.ColorRole.Window, ground)
        colors.setColor(QPalette.ColorRole.WindowText, QColor("white"))
        self.setPalette(colors)
        self.setAutoFillBackground(True)
        self.setMargin(3)
        self.setText(f"● {text}" if recording else text)
        self.setVisible(bool(text))


class RecordingDot(QLabel):
    """A red dot with the time over a corner of the picture, also where there is no status line."""

    def __init__(self, pane: QWidget) -> None:
        """Lie over a picture."""
        super().__init__(pane)
        self.setAccessibleName("Recording")
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        colors = QPalette(self.palette())
        colors.setColor(QPalette.ColorRole.Window, QColor(20, 22, 24))
        colors.setColor(QPalette.ColorRole.WindowText, RECORD_COLOR.lighter(125))
        self.setPalette(colors)
        self.setAutoFillBackground(True)
        self.setMargin(5)
        self.hide()

    def show_state(self, state: str, seconds: float) -> None:
        """Show "recording" or "paused" with the time; nothing in other states."""
        signs = {"recording": "●", "paused": "❚❚"}
        self.setVisible(state in signs)
        self.setText(f"{signs.get(state, '')} {clock(seconds)}")
        self.adjustSize()
        self.move(8, 8)
        self.raise_()


def clock(seconds: float) -> str:
    """Return a time as 1:02 or 1:01:02."""
    whole = int(seconds)
    hours, minutes = whole // 3600, whole // 60 % 60
    start = f"{hours}:{minutes:02d}" if hours else f"{minutes}"
    return f"{start}:{whole % 60:02d}"
