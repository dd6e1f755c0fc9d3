"""How it feels: steadiness by group, head motion, centre, eyes, and what the avatar does alone."""

import math
from dataclasses import fields, replace
from typing import Any, NamedTuple

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFrame,
    QGridLayout,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from app.views.control.slider_row import SliderRow
from core.drive_settings import DriveSettings

PERCENT = "{:.0%}"
#: Of a value in radians; told in degrees.
DEGREES = "{:+.1f}°"
#: Words of the settings' choices.
WORDS = {
    "blinks": "Together, except in a wink",
    "never": "Never",
    "always": "Always",
    "lost": "While no face is seen",
}
LID_WORDS = WORDS | {"never": "Each for itself", "always": "Always together"}


class Row(NamedTuple):
    """One setting: of which part, its field, its name and what it does, how its value is told."""

    part: str
    name: str
    text: str
    tip: str
    form: str = PERCENT
    words: dict[str, str] = WORDS


SECTIONS: dict[str, tuple[Row, ...]] = {
    "Steady (left) or quick (right)": (
        Row("steadiness", "head", "Head", "How calmly the head follows. Further right: it "
            "follows quicker, and shakes more when you sit still; all the way right: as tracked."),
        Row("steadiness", "brows", "Brows", "The same for the brows."),
        Row("steadiness", "eyes", "Eyes", "The same for lids and gaze. Blinks are never slowed."),
        Row("steadiness", "mouth", "Mouth", "The same for mouth, jaw, cheeks and nose."),
    ),
    "Head motion": (
        Row("head", "yaw", "Turn", "How far the avatar turns its head when you turn yours."),
        Row("head", "pitch", "Nod", "How far it looks up and down."),
        Row("head", "roll", "Lean", "How far it leans to a shoulder."),
        Row("head", "x", "Sideways", "How far it moves to the side."),
        Row("head", "y", "Up and down", "How far it moves up and down."),
        Row("head", "z", "Near and far", "How far it moves to you and away."),
    ),
    "Eyes": (
        Row("eyes", "link_lids", "Lids", "Whether both lids move together.", words=LID_WORDS),
        Row("eyes", "link_gaze", "Both eyes look in one direction",
            "Takes off what little each eye is turned in."),
        Row("eyes", "own_levels", "Open and closed as in your face",
            "Your eyes wide enough open count as open and your closed ones as closed: by the "
            "pictures of your setup, or as they are seen in time."),
        Row("eyes", "gaze_gain", "Gaze", "How far the eyes turn."),
        Row("eyes", "gaze_up_rad", "Gaze height", "Raises or lowers the gaze.", DEGREES),
    ),
    "By itself": (
        Row("idle", "breathing", "Breathes", "A slow small movement of head and shoulders."),
        Row("idle", "breath", "Breath size", "How large that movement is."),
        Row("idle", "blinking", "Blinks", "Blinks by itself, at uneven times."),
        Row("idle", "hold_s", "Waits", "When your face is lost it stays as it was for so long.",
            "{:.1f} s"),
        Row("idle", "ease_s", "Goes to rest in", "Then it goes to rest in this time.",
            "{:.1f} s"),
    ),
}  # fmt: skip
CENTRE_ROWS = (
    Row("centring", "head", "Auto-centre the head",
        "Slowly takes the way you sit for straight ahead. It learns only while you look at the "
        "screen and show nothing."),
    Row("centring", "face", "Auto-centre the face",
        "Slowly takes your resting face for neutral. It never learns from an expression."),
    Row("centring", "time_s", "Within", "How slowly.", "{:.0f} s"),
)  # fmt: skip


class FeelPage(QScrollArea):
    """Shows the settings that are not of single coefficients; emits changed ones."""

    changed = Signal(object, str)  # DriveSettings, what was changed
    recentre_wanted = Signal()
    uncentre_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._settings = DriveSettings()
        self.editors: dict[tuple[str, str], QWidget] = {}
        self.recentre_button = QPushButton("&Recentre")
        self.uncentre_button = QPushButton("Forget")
        self.setAccessibleName("How it feels")
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._build()

    def show_settings(self, settings: DriveSettings) -> None:
        """Show settings; nothing is emitted."""
        self._settings = settings
        for (part, name), editor in self.editors.items():
            value = getattr(getattr(settings, part), name)
            if isinstance(editor, SliderRow):
                editor.show_value(value)
            elif isinstance(editor, QCheckBox):
                editor.setChecked(value)
            elif isinstance(editor, QComboBox):
                editor.setCurrentIndex(editor.findData(value))

    def show_centre(self, is_set: bool) -> None:
        """Let a centre be forgotten only if there is one."""
        self.uncentre_button.setEnabled(is_set)

    def _build(self) -> None:
        content = QWidget()
        layout = QVBoxLayout(content)
        layout.setContentsMargins(6, 6, 6, 6)
        sections = {name: self._section(rows) for name, rows in SECTIONS.items()}
        boxes = {"Centre": self._centre_section()} | sections
        for name in ("Steady (left) or quick (right)", "Centre", "Head motion", "Eyes",
                     "By itself"):  # fmt: skip
            box = QGroupBox(name)
            box.setLayout(boxes[name])
            layout.addWidget(box)
        layout.addStretch(1)
        self.setWidget(content)

    def _centre_section(self) -> QGridLayout:
        self.recentre_button.setToolTip(
            "Look at the screen with a resting face and press this: from now on the avatar looks "
            "straight ahead and shows nothing when you do so (Ctrl+R)"
        )
        self.uncentre_button.setToolTip("Use head and face as they are tracked")
        self.uncentre_button.setAccessibleName("Forget the centre")
        self.uncentre_button.setEnabled(False)
        self.recentre_button.clicked.connect(self.recentre_wanted)
        self.uncentre_button.clicked.connect(self.uncentre_wanted)
        buttons = QHBoxLayout()
        buttons.addWidget(self.recentre_button, stretch=1)
        buttons.addWidget(self.uncentre_button)
        grid = self._section(CENTRE_ROWS, first=1)
        grid.addLayout(buttons, 0, 0, 1, 3)
        return grid

    def _section(self, rows: tuple[Row, ...], first: int = 0) -> QGridLayout:
        """Return the editors of some settings below each other, their columns aligned."""
        grid = QGridLayout()
        grid.setColumnStretch(1, 1)
        grid.setVerticalSpacing(5)
        for line, row in enumerate(rows, first):
            editor = self._editor(row)
            self.editors[row.part, row.name] = editor
            if isinstance(editor, SliderRow):
                for column, piece in enumerate(
                    (editor.name_label, editor.slider, editor.value_label)
                ):
                    piece.setToolTip(editor.toolTip())
                    grid.addWidget(piece, line, column)
            elif isinstance(editor, QComboBox):
                label = QLabel(row.text)
                label.setBuddy(editor)
                label.setToolTip(row.tip)
                grid.addWidget(label, line, 0)
                grid.addWidget(editor, line, 1, 1, 2)
            else:
                grid.addWidget(editor, line, 0, 1, 3)
        return grid

    def _editor(self, row: Row) -> QWidget:
        part = getattr(DriveSettings(), row.part)
        usual = getattr(part, row.name)
        limits = next(entry.metadata for entry in fields(part) if entry.name == row.name)
        if "low" in limits:
            scale = math.degrees(1) if row.form == DEGREES else 1.0
            limited = limits["low"], limits["high"], usual
            slider = SliderRow(row.text, *limited, row.form, scale)
            # Only its pieces are laid out; the row itself stays hidden and owns nothing.
            slider.setParent(self)
            slider.hide()
            slider.set_tip(row.tip)
            slider.changed.connect(lambda value: self._change(row, value))
            return slider
        if "choices" in limits:
            return self._combo_box(row, limits["choices"])
        box = QCheckBox(row.text)
        box.setToolTip(row.tip)
        box.setAccessibleDescription(row.tip)
        box.clicked.connect(lambda checked: self._change(row, checked))
        return box

    def _combo_box(self, row: Row, choices: tuple[str, ...]) -> QComboBox:
        box = QComboBox()
        for choice in choices:
            box.addItem(row.words[choice], choice)
        box.setAccessibleName(row.text.replace("&", ""))
        box.setAccessibleDescription(row.tip)
        box.setToolTip(row.tip)
        box.activated.connect(lambda index: self._change(row, box.itemData(index)))
        return box

    def _change(self, row: Row, value: Any) -> None:
        part = replace(getattr(self._settings, row.part), **{row.name: value})
        if part == getattr(self._settings, row.part):
            return
        self._settings = replace(self._settings, **{row.part: part})
        self.changed.emit(self._settings, f"{row.part}.{row.name}")
