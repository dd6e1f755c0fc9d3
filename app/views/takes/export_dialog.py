"""Asks in what form a take is wanted, and tells what is in each."""

from collections.abc import Sequence
from typing import NamedTuple

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QButtonGroup,
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QLayout,
    QRadioButton,
    QVBoxLayout,
    QWidget,
)

from app.views.choice import Choice

#: In widths of the letter x.
INDENT_X, WIDTH_X = 6, 74


class Form(NamedTuple):
    """A kind of file: its key, which is its suffix, its name, what is in it."""

    key: str
    text: str
    content: str


FORMS = (
    Form(
        ".mp4", "&Video of the avatar",
        "The avatar, seen and lit as in the live window, at an even frame rate. MPEG-4, no sound, "
        "no transparency: a chroma key takes its place.",
    ),
    Form(
        ".csv", "&Table",
        "A row per frame: time, head angles and position, gaze, the 46 coefficients and the 52 "
        "of ARKit. For spreadsheets; times begin at the trim mark.",
    ),
    Form(
        ".npz", "&Arrays",
        "Everything: what was solved (landmarks, 3D shape, head, coefficients, gaze, confidence) "
        "and what the avatar did, with exact capture times. For numpy.",
    ),
)  # fmt: skip
SIZES = ((1280, 720), (1920, 1080), (640, 480), (1080, 1080))
RATES = (30, 60, 25)
BACKGROUNDS = (
    Choice("", "As in the live window"),
    Choice("studio", "Studio"),
    Choice("key", "Chroma key"),
    Choice("blurred", "Blurred webcam"),
)
VALUES = (Choice("driven", "As the avatar moved"), Choice("solved", "As the face was solved"))


class ExportWish(NamedTuple):
    """What is wanted.

    Attributes:
        form: Key of a Form.
        avatar: Key of an avatar, for a video.
        size_px: (width, height) of the avatar's picture.
        fps: Of the video.
        beside: Whether the source stands beside the avatar.
        driven: Whether a table tells what the avatar did.
        background: Kind of the background of a video, "" as in the live window.
    """

    form: str
    avatar: str
    size_px: tuple[int, int]
    fps: float
    beside: bool
    driven: bool
    background: str = ""


class ExportDialog(QDialog):
    """Emits the wish when it is accepted."""

    wanted = Signal(object)  # ExportWish

    def __init__(
        self, told: str, avatars: Sequence[Choice], avatar: str, has_video: bool,
        parent: QWidget | None = None,
    ) -> None:  # fmt: skip
        """Ask.

        Args:
            told: Which take and how much of it.
            avatars: That can be shown.
            avatar: Key of the one to begin with.
            has_video: Whether there are pictures of the source.
            parent: The window.
        """
        super().__init__(parent)
        self.setWindowTitle("Export the take")
        self.forms = QButtonGroup(self)
        self.avatars, self.sizes, self.rates = QComboBox(), QComboBox(), QComboBox()
        self.backgrounds = QComboBox()
        self.values, self.beside_box = QComboBox(), QCheckBox("The &webcam's picture beside it")
        self.beside_box.setEnabled(has_video)
        self._fill(avatars, avatar)
        for choice in BACKGROUNDS if has_video else BACKGROUNDS[:-1]:
            self.backgrounds.addItem(choice.text, choice.key)
        layout = QVBoxLayout(self)
        intro = QLabel(told)
        intro.setWordWrap(True)
        layout.addWidget(intro)
        self._options = {".mp4": self._film_options(), ".csv": self._table_options()}
        for form in FORMS:
            self._add_form(layout, form)
        layout.addWidget(self._make_buttons())
        # The options come and go: only the height may change with them.
        layout.setSizeConstraint(QLayout.SizeConstraint.SetFixedSize)
        self.forms.buttons()[0].setChecked(True)
        self._show_options()
        self.forms.buttonToggled.connect(self._show_options)
        self.accepted.connect(lambda: self.wanted.emit(self.wish()))

    def wish(self) -> ExportWish:
        """Return what is chosen now."""
        return ExportWish(
            FORMS[self.forms.checkedId()].key, self.avatars.currentData(),
            SIZES[self.sizes.currentIndex()], float(RATES[self.rates.currentIndex()]),
            self.beside_box.isEnabled() and self.beside_box.isChecked(),
            self.values.currentData() == "driven", self.backgrounds.currentData(),
        )  # fmt: skip

    def _fill(self, avatars: Sequence[Choice], avatar: str) -> None:
        for choice in avatars:
            self.avatars.addItem(choice.text, choice.key)
        self.avatars.setCurrentIndex(max(self.avatars.findData(avatar), 0))
        self.sizes.addItems([f"{width} × {height}" for width, height in SIZES])
        self.rates.addItems([f"{rate} per second" for rate in RATES])
        for choice in VALUES:
            self.values.addItem(choice.text, choice.key)

    def _film_options(self) -> QWidget:
        box = QWidget()
        form = QFormLayout(box)
        form.addRow("A&vatar", self.avatars)
        form.addRow("&Background", self.backgrounds)
        form.addRow("&Size", self.sizes)
        form.addRow("&Frames", self.rates)
        form.addRow(self.beside_box)
        return box

    def _table_options(self) -> QWidget:
        box = QWidget()
        form = QFormLayout(box)
        form.addRow("V&alues", self.values)
        return box

    def _add_form(self, layout: QVBoxLayout, form: Form) -> None:
        button, content = QRadioButton(f"{form.text} ({form.key})"), QLabel(form.content)
        self.forms.addButton(button, FORMS.index(form))
        content.setWordWrap(True)
        indent = INDENT_X * self.fontMetrics().averageCharWidth()
        content.setContentsMargins(indent, 0, 0, 4)
        # A label with wrapped lines tells its height only for a known width.
        content.setFixedWidth(WIDTH_X * self.fontMetrics().averageCharWidth())
        content.setFixedHeight(content.heightForWidth(content.width()))
        layout.addWidget(button)
        layout.addWidget(content)
        if form.key in self._options:
            options = self._options[form.key]
            options.setContentsMargins(indent, 0, 0, 4)
            layout.addWidget(options)

    def _make_buttons(self) -> QDialogButtonBox:
        boxes = QDialogButtonBox.StandardButton
        buttons = QDialogButtonBox(boxes.Ok | boxes.Cancel)
        buttons.button(boxes.Ok).setText("&Export…")
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        return buttons

    def _show_options(self) -> None:
        chosen = FORMS[self.forms.checkedId()].key
        for key, options in self._options.items():
            options.setVisible(key == chosen)
