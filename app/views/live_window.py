"""The live window: the source with its landmarks on the left, the avatar on the right."""

from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction, QCloseEvent, QKeySequence
from PySide6.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QProgressBar,
    QPushButton,
    QSplitter,
    QStatusBar,
    QToolBar,
    QVBoxLayout,
    QWidget,
)

from app.views.picture_view import PictureView


@dataclass(frozen=True, slots=True)
class Choice:
    """One entry of a chooser: what the program calls it and what people read."""

    key: str
    text: str


@dataclass(frozen=True, slots=True)
class LiveNumbers:
    """What the status line says.

    Attributes:
        state: "tracking", "searching" or "idle".
        confidence: In [0, 1].
        frames_per_second: Frames solved per second.
        solve_ms: Time to solve one frame.
        latency_ms: From the frame's delivery to the avatar's picture.
        dropped: Frames skipped because they came too fast.
    """

    state: str
    confidence: float
    frames_per_second: float
    solve_ms: float
    latency_ms: float
    dropped: int


STATE_TEXTS = {
    "tracking": "Tracking",
    "searching": "Searching for the face",
    "idle": "No profile: choose or make one",
}


class LiveWindow(QMainWindow):
    """Shows pictures and numbers; says what the user wishes."""

    source_chosen = Signal(str)
    file_wanted = Signal()
    profile_chosen = Signal(str)
    new_profile_wanted = Signal()
    cancel_wanted = Signal()
    avatar_chosen = Signal(str)
    closing = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setWindowTitle("facepuppet")
        self.resize(1180, 620)
        self.source_view = PictureView("Camera picture", "Choose a source above.")
        self.avatar_view = PictureView("Avatar", "The avatar appears with the first frame.")
        self._sources = self._chooser("Source", self.source_chosen)
        self._profiles = self._chooser("Profile", self.profile_chosen)
        self._avatars = self._chooser("Avatar", self.avatar_chosen)
        self._message = QLabel()
        self._message.setWordWrap(True)
        self._message.setAccessibleName("Message")
        self._message.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._message.hide()
        self._job_row, self._job_text, self._job_bar = self._make_job_row()
        self._labels: dict[str, QLabel] = {}
        self._build_toolbar()
        self._build_center()
        self._build_status()

    # -- what is shown -------------------------------------------------------------------

    def show_sources(self, choices: list[Choice], current: str) -> None:
        """List the sources."""
        self._fill(self._sources, choices, current)

    def show_profiles(self, choices: list[Choice], current: str) -> None:
        """List the profiles."""
        self._fill(self._profiles, choices, current)

    def show_avatars(self, choices: list[Choice], current: str) -> None:
        """List the avatars."""
        self._fill(self._avatars, choices, current)

    def show_message(self, text: str) -> None:
        """Show a message over the pictures, or hide it with an empty text."""
        self._message.setText(text)
        self._message.setVisible(bool(text))

    def show_job(self, text: str, percent: int) -> None:
        """Show that background work goes on; an empty text hides the row."""
        self._job_row.setVisible(bool(text))
        self._job_text.setText(text)
        self._job_bar.setValue(percent)

    def show_numbers(self, numbers: LiveNumbers) -> None:
        """Show the state of tracking and the speeds."""
        tracking = numbers.state == "tracking"
        self._labels["state"].setText(STATE_TEXTS[numbers.state])
        self._labels["confidence"].setText(
            f"confidence {100 * numbers.confidence:.0f} %" if tracking else ""
        )
        self._labels["fps"].setText(f"{numbers.frames_per_second:.0f} fps")
        self._labels["solve"].setText(f"solve {numbers.solve_ms:.1f} ms")
        self._labels["latency"].setText(f"latency {numbers.latency_ms:.0f} ms")
        self._labels["dropped"].setText(f"{numbers.dropped} dropped")

    @property
    def landmarks_wanted(self) -> bool:
        """Whether landmarks are to be drawn over the source."""
        return self._landmarks_action.isChecked()

    # -- construction --------------------------------------------------------------------

    def _chooser(self, name: str, signal: object) -> QComboBox:
        box = QComboBox()
        box.setAccessibleName(name)
        box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        box.setMinimumContentsLength(14)
        box.activated.connect(lambda row: signal.emit(box.itemData(row)))  # type: ignore[attr-defined]
        return box

    def _fill(self, box: QComboBox, choices: list[Choice], current: str) -> None:
        box.clear()
        for choice in choices:
            box.addItem(choice.text, choice.key)
        box.setCurrentIndex(max(0, box.findData(current)))

    def _build_toolbar(self) -> None:
        bar = QToolBar("Choices")
        bar.setMovable(False)
        bar.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
        for text, box in (
            ("&Source", self._sources),
            ("&Profile", self._profiles),
            ("&Avatar", self._avatars),
        ):
            label = QLabel(f" {text} ")
            label.setBuddy(box)
            bar.addWidget(label)
            bar.addWidget(box)
        self._add_button(bar, "&New profile…", self.new_profile_wanted.emit)
        bar.addSeparator()
        self._mirror_action = self._add_toggle(bar, "&Mirror", "Ctrl+M", self._set_mirrored)
        self._landmarks_action = self._add_toggle(bar, "&Landmarks", "Ctrl+L", lambda _on: None)
        self._landmarks_action.setChecked(True)
        self.addToolBar(bar)

    def _add_button(self, bar: QToolBar, text: str, answer: object) -> None:
        button = QPushButton(text)
        button.clicked.connect(answer)
        bar.addWidget(button)

    def _add_toggle(self, bar: QToolBar, text: str, keys: str, answer: object) -> QAction:
        action = QAction(text, self)
        action.setCheckable(True)
        action.setShortcut(QKeySequence(keys))
        action.setToolTip(f"{text.replace('&', '')} ({keys})")
        action.toggled.connect(answer)
        bar.addAction(action)
        return action

    def _make_job_row(self) -> tuple[QWidget, QLabel, QProgressBar]:
        row, text, bar = QWidget(), QLabel(), QProgressBar()
        text.setMinimumWidth(320)
        bar.setRange(0, 100)
        cancel = QPushButton("&Cancel")
        cancel.clicked.connect(self.cancel_wanted.emit)
        layout = QHBoxLayout(row)
        layout.setContentsMargins(0, 0, 0, 0)
        for widget in (text, bar, cancel):
            layout.addWidget(widget)
        row.hide()
        return row, text, bar

    def _build_center(self) -> None:
        splitter = QSplitter()
        splitter.setChildrenCollapsible(False)
        splitter.addWidget(self.source_view)
        splitter.addWidget(self.avatar_view)
        splitter.setSizes([590, 590])
        center = QWidget()
        layout = QVBoxLayout(center)
        layout.setContentsMargins(8, 8, 8, 4)
        layout.addWidget(self._message)
        layout.addWidget(self._job_row)
        layout.addWidget(splitter, stretch=1)
        self.setCentralWidget(center)

    def _build_status(self) -> None:
        status = QStatusBar()
        for name, width in (
            ("state", 220),
            ("confidence", 110),
            ("fps", 60),
            ("solve", 100),
            ("latency", 100),
            ("dropped", 90),
        ):
            label = QLabel()
            label.setMinimumWidth(width)
            label.setAccessibleName(name)
            self._labels[name] = label
            status.addWidget(label)
        self.setStatusBar(status)
        self.show_numbers(LiveNumbers("idle", 0.0, 0.0, 0.0, 0.0, 0))

    def _set_mirrored(self, mirrored: bool) -> None:
        self.source_view.set_mirrored(mirrored)
        self.avatar_view.set_mirrored(mirrored)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Let the work stop before the window goes."""
        self.closing.emit()
        super().closeEvent(event)
