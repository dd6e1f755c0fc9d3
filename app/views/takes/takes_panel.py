"""The panel of the takes: record, list, play, trim."""

from typing import NamedTuple

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from app.views.takes.player_box import PlayerBox
from app.views.takes.record_row import RecordRow
from app.views.takes.take_list import TakeList
from app.views.takes.work_box import WorkBox

EMPTY = (
    "No takes yet. Record (R) keeps what the avatar does: to see it again, to trim it, and as "
    "a video or a file for other programs."
)


class Deed(NamedTuple):
    """What can be done with a take: its key, its text, its shortcut, what it does."""

    key: str
    text: str
    shortcut: str
    tip: str


DEEDS = (
    Deed("play", "&Play", "", "Play the take in this window (Enter)"),
    Deed("export", "&Export…", "", "As a video, or a file for other programs"),
    Deed("solve", "&Solve again…", "", "Its video, with another profile or in another mode"),
    Deed("rename", "Re&name…", "F2", "Give the take another name (F2)"),
    Deed("delete", "&Delete…", "Del", "Delete the take (Del)"),
    Deed("folder", "Open &folder", "", "Show the take's files"),
)


class TakesPanel(QWidget):
    """Shows takes; says what the user wishes."""

    wished = Signal(str, str)  # key of a Deed, name of the take

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.record, self.list, self.player = RecordRow(), TakeList(), PlayerBox()
        self.work, self.empty_label = WorkBox(), QLabel(EMPTY)
        self.empty_label.setWordWrap(True)
        self.buttons = {deed.key: self._button(deed) for deed in DEEDS}
        self._has_video: dict[str, bool] = {}
        layout = QVBoxLayout(self)
        layout.addWidget(self.record)
        layout.addWidget(self.empty_label)
        layout.addWidget(self.list, stretch=1)
        layout.addLayout(self._make_grid())
        layout.addWidget(self.work)
        layout.addWidget(self.player)
        self.list.selected.connect(self._on_selected)
        self.list.opened.connect(lambda name: self.wished.emit("play", name))
        self._add_keys()

    def show_possible(self, name: str, has_video: bool, working: bool) -> None:
        """Say what can be done with the chosen take.

        Args:
            name: Of the take, "" without one.
            has_video: Whether it can be solved again.
            working: Whether work on a take goes on, and no other can begin.
        """
        for button in self.buttons.values():
            button.setEnabled(bool(name))
        self.buttons["solve"].setEnabled(bool(name) and has_video and not working)
        self.buttons["export"].setEnabled(bool(name) and not working)
        tip = "Its video, with another profile or in another mode"
        self.buttons["solve"].setToolTip(tip if has_video else "This take has no video")
        self.empty_label.setVisible(self.list.count() == 0)

    def _on_selected(self, name: str) -> None:
        self.wished.emit("select", name)

    def _button(self, deed: Deed) -> QPushButton:
        button = QPushButton(deed.text)
        button.setToolTip(deed.tip)
        button.clicked.connect(lambda: self.wished.emit(deed.key, self.list.current))
        return button

    def _make_grid(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setSpacing(4)
        for number, deed in enumerate(DEEDS):
            grid.addWidget(self.buttons[deed.key], number // 2, number % 2)
        return grid

    def _add_keys(self) -> None:
        """Let keys work while the list has the focus; the window has others of the same name."""
        for deed in DEEDS:
            if deed.shortcut in ("F2", "Del"):
                action = QAction(deed.text, self.list)
                action.setShortcut(QKeySequence(deed.shortcut))
                action.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)
                action.triggered.connect(self.buttons[deed.key].click)
                self.list.addAction(action)
