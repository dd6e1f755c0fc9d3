"""The landmark editor: pictures on the left, one of them large, what can be done on the right."""

from collections.abc import Callable
from typing import NamedTuple

from PySide6.QtCore import QSize, Signal
from PySide6.QtGui import QAction, QCloseEvent, QKeySequence
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMainWindow, QPushButton, QVBoxLayout, QWidget

from app.views.editor.canvas import LandmarkCanvas
from app.views.editor.filmstrip import Filmstrip
from app.views.editor.help_card import HelpCard
from app.views.editor.side_panel import SidePanel
from app.views.job_row import JobRow
from app.views.message_bar import MessageBar


class Deed(NamedTuple):
    """Something that can be done: its key in `wished`, its text, its keys, what it does."""

    key: str
    text: str
    keys: tuple[str, ...]
    meaning: str


#: Those with a button, then those with keys only.
BUTTONS = (
    Deed("undo", "Undo", ("Ctrl+Z",), "Take back the last change"),
    Deed("redo", "Redo", ("Ctrl+Shift+Z", "Ctrl+Y"), "Do again what was taken back"),
    Deed("refit", "Refit to my points", ("R",), "The face model places what you did not place"),
    Deed("previous", "Copy from previous", ("Ctrl+C",), "Points as in the previous picture"),
    Deed(
        "similar", "Copy from similar", ("Ctrl+Shift+C",), "Points as in the most similar picture"
    ),
    Deed(
        "mirror", "Mirror from opposite", ("Ctrl+M",), "Mirrored points of the opposite head turn"
    ),
    Deed("hide", "Hidden / seen", ("X",), "Call the points hidden, or seen again"),
    Deed(
        "reset", "As found", ("Backspace", "Del"), "Points as the program found them; all if none"
    ),
    Deed(
        "out", "Leave this picture out", ("O",), "Take the picture out of the training, or back in"
    ),
)
KEYS_ONLY = (
    Deed("back", "Previous picture", ("A", "PgUp"), ""),
    Deed("forth", "Next picture", ("D", "PgDown"), ""),
    Deed("point_back", "Previous point", ("J",), ""),
    Deed("point_forth", "Next point", ("K",), ""),
    Deed("group", "The whole feature", ("G",), ""),
    Deed("all", "All points", ("Ctrl+A",), ""),
    Deed("none", "No points", ("Esc",), ""),
)


class EditorWindow(QMainWindow):
    """Shows scenes and cells; says what the user wishes."""

    wished = Signal(str)  # key of a Deed
    retrain_wanted = Signal()
    cancel_wanted = Signal()
    model_wanted = Signal(bool)
    closing = Signal()

    def __init__(self, title: str) -> None:
        super().__init__()
        self.setWindowTitle(f"{title} – landmarks – facepuppet")
        self.canvas, self.strip, self.panel = LandmarkCanvas(), Filmstrip(), SidePanel()
        self.message_bar, self.job_row = MessageBar(), JobRow()
        self.saved_label, self.outdated_label = QLabel(), QLabel()
        self.retrain_button = QPushButton("&Train again")
        self.help_button = QPushButton("&Keys (?)")
        self.help_card = HelpCard(self.canvas)
        self.deeds: dict[str, QAction] = {}
        self._build()
        self._connect()
        self.show_outdated(False)

    def sizeHint(self) -> QSize:
        """Return a size that suits small laptop screens, too."""
        return QSize(1240, 680)

    def show_outdated(self, outdated: bool) -> None:
        """Say whether the training knows the landmarks as they are now."""
        text = "Changed since the last training." if outdated else "Trained with these landmarks."
        self.outdated_label.setText(text)
        self.retrain_button.setEnabled(outdated)

    def show_deed(self, key: str, possible: bool, text: str = "") -> None:
        """Say whether something can be done now, and in other words."""
        action = self.deeds[key]
        action.setEnabled(possible)
        if text:
            action.setText(text)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Let everything be kept before the window goes."""
        self.closing.emit()
        super().closeEvent(event)

    def _build(self) -> None:
        for deed in (*BUTTONS, *KEYS_ONLY):
            self.deeds[deed.key] = self._action(deed)
        self.panel.add_actions(self.deeds[deed.key] for deed in BUTTONS)
        body = QHBoxLayout()
        body.addWidget(self.strip)
        body.addWidget(self.canvas, stretch=1)
        body.addWidget(self.panel)
        foot = QHBoxLayout()
        foot.addWidget(self.saved_label, stretch=1)
        foot.addWidget(self.help_button)
        foot.addWidget(self.outdated_label)
        foot.addWidget(self.retrain_button)
        central = QWidget()
        layout = QVBoxLayout(central)
        layout.addWidget(self.message_bar)
        layout.addLayout(body, stretch=1)
        layout.addWidget(self.job_row)
        layout.addLayout(foot)
        self.setCentralWidget(central)

    def _action(self, deed: Deed) -> QAction:
        action = QAction(deed.text, self)
        action.setShortcuts([QKeySequence(keys) for keys in deed.keys])
        if deed.meaning:
            action.setToolTip(f"{deed.meaning} ({deed.keys[0]})")
        action.triggered.connect(lambda: self._wish(deed.key))
        self.addAction(action)
        return action

    def _wish(self, key: str) -> None:
        """Pass a wish on; while the card of the keys is shown any key only puts it away."""
        if self.help_card.isVisible():
            self.help_card.toggle()
        else:
            self.wished.emit(key)

    def _key(self, keys: str, do: Callable[[], object]) -> None:
        action = QAction(self)
        action.setShortcut(QKeySequence(keys))
        action.triggered.connect(lambda: do())
        self.addAction(action)

    def _connect(self) -> None:
        panel = self.panel
        self._key("F", self.canvas.fit)
        self._key("Shift+F", self.canvas.fit_face)
        self._key("V", panel.model_box.toggle)
        self._key("N", panel.names_box.toggle)
        self._key("?", self.help_card.toggle)
        self._key("F1", self.help_card.toggle)
        panel.names_box.toggled.connect(self.canvas.show_all_names)
        panel.model_box.toggled.connect(self.model_wanted)
        self.help_button.clicked.connect(self.help_card.toggle)
        self.retrain_button.clicked.connect(self.retrain_wanted)
        self.job_row.cancel_wanted.connect(self.cancel_wanted)
