"""The page that takes the setup pictures: oneself as in a mirror beside what is asked for."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction, QFont, QKeySequence
from PySide6.QtWidgets import (
    QCheckBox,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from app.views.chooser import Chooser
from app.views.elided import Elided
from app.views.picture_view import PictureView
from app.views.setup.contact_sheet import CELL, ContactSheet
from app.views.setup.guide_view import GuideView

#: Key of a wish -> text of its button, key, what it does.
WISHES = {
    "shoot": ("&Shoot now", "Space", "Take the picture now, whatever it shows"),
    "retake": ("&Retake last", "Backspace", "Take the last picture again"),
    "skip": ("S&kip", "S", "Leave this one out for now"),
    "pause": ("&Pause", "P", "Take no pictures until you go on"),
}

#: Letters of a camera's name and of a set of pictures that are seen without dropping a list down.
NAME_LENGTH = 16
#: Letters of a prompt that are seen in any case.
TITLE_LENGTH = 36


class CapturePage(QWidget):
    """Shows the prompt, the live picture and all prompts."""

    wished = Signal(str)  # key of WISHES
    source_chosen = Signal(str)
    sources_wanted = Signal()
    plan_chosen = Signal(str)
    sound_wanted = Signal(bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.sources, self.plans = Chooser("Camera"), Chooser("Which pictures")
        for chooser in (self.sources, self.plans):
            chooser.setMinimumContentsLength(NAME_LENGTH)
            chooser.setMinimumWidth(10 * self.fontMetrics().averageCharWidth())
        self.live, self.target = GuideView("Live picture"), PictureView("What is asked for")
        self.live.setMinimumSize(200, 120)
        self.target.setMinimumSize(150, 110)
        self.target.set_mirrored(True)
        self.sheet = ContactSheet()
        self.title, self.instruction, self.note = Elided(), QLabel(), Elided()
        self.sheet.noted.connect(self.note.setText)
        self.progress = QProgressBar()
        self.progress.setAccessibleName("Pictures taken")
        self.sound_box = QCheckBox("S&ound")
        self.sound_box.setToolTip("Let hear when to hold still and when a picture was taken")
        self.buttons: dict[str, QPushButton] = {}
        self.actions_by_key: dict[str, QAction] = {}
        self._build()
        self.sources.chosen.connect(self.source_chosen)
        self.sources.list_wanted.connect(self.sources_wanted)
        self.plans.chosen.connect(self.plan_chosen)
        self.sound_box.toggled.connect(self.sound_wanted)

    def show_prompt(self, title: str, instruction: str) -> None:
        """Say what is asked for."""
        self.title.setText(title)
        # Which way to turn stands at the end: the lists give way first.
        most = TITLE_LENGTH * self.title.fontMetrics().averageCharWidth()
        self.title.setMinimumWidth(min(self.title.sizeHint().width(), most))
        self.instruction.setText(instruction)

    def show_progress(self, taken: int, total: int, weak: int = 0) -> None:
        """Say how many pictures are taken, and how many of them are weak."""
        self.progress.setRange(0, max(total, 1))
        self.progress.setValue(taken)
        noted = f", {weak} weak" if weak else ""
        self.progress.setFormat(f"{taken} of {total} pictures{noted}")

    def show_sound(self, heard: bool) -> None:
        """Show whether sounds are heard."""
        self.sound_box.blockSignals(True)
        self.sound_box.setChecked(heard)
        self.sound_box.blockSignals(False)

    def show_paused(self, paused: bool) -> None:
        """Say whether pictures are taken."""
        self.buttons["pause"].setText("&Go on" if paused else "&Pause")

    def _build(self) -> None:
        large = QFont(self.font())
        large.setPointSizeF(1.35 * large.pointSizeF())
        large.setBold(True)
        self.title.setFont(large)
        self.instruction.setWordWrap(True)
        self.instruction.setMinimumHeight(2 * self.fontMetrics().lineSpacing())
        self.instruction.setAlignment(Qt.AlignmentFlag.AlignTop)
        head = QHBoxLayout()
        head.addWidget(self.title, stretch=1)
        for text, chooser in (("P&ictures", self.plans), ("&Camera", self.sources)):
            label = QLabel(text)
            label.setBuddy(chooser)
            head.addWidget(label)
            head.addWidget(chooser)
        views = QHBoxLayout()
        views.addWidget(self.live, stretch=3)
        views.addWidget(self.target, stretch=2)
        foot = QHBoxLayout()
        for key, (text, keys, meaning) in WISHES.items():
            foot.addWidget(self._button(key, text, keys, meaning))
        foot.addWidget(self.sound_box)
        foot.addWidget(self.progress, stretch=1)
        # One row where the window is low, two elsewhere.
        self.sheet.setMinimumHeight(CELL.height() + 18)
        self.sheet.setMaximumHeight(146)
        layout = QVBoxLayout(self)
        layout.addLayout(head)
        layout.addWidget(self.instruction)
        layout.addLayout(views, stretch=1)
        layout.addLayout(foot)
        layout.addWidget(self.sheet)
        layout.addWidget(self.note)

    def _button(self, key: str, text: str, keys: str, meaning: str) -> QPushButton:
        button = QPushButton(text)
        button.setToolTip(f"{meaning} ({keys})")
        # Space belongs to the shutter, wherever the focus is.
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        action = QAction(self)
        action.setShortcut(QKeySequence(keys))
        action.triggered.connect(lambda: self.wished.emit(key))
        button.clicked.connect(lambda: self.wished.emit(key))
        self.addAction(action)
        self.buttons[key], self.actions_by_key[key] = button, action
        return button
