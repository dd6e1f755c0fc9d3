"""The editor of the faces that the keys Ctrl+1 to Ctrl+9 call up."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QComboBox,
    QFormLayout,
    QGridLayout,
    QGroupBox,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from app.views.control.slider_row import SliderRow
from app.views.control.words import told_weights
from core.arkit import EXPRESSION_NAMES
from core.drive_settings import N_KEYS, DriveSettings, ExpressionKey, key_from
from core.records import FloatArray

UNUSED = "not used"
HOLD_WORDS = {True: "While it is held", False: "On and off with each press"}
WAY_WORDS = {
    "add": "Added to your face",
    "part": "In place of that part of your face",
    "face": "In place of your whole face",
}


def is_used(key: ExpressionKey) -> bool:
    """Return whether a key shows anything."""
    return any(key.weights)


def unused_key() -> ExpressionKey:
    """Return a key that shows nothing."""
    return ExpressionKey("", (0.0,) * len(EXPRESSION_NAMES))


class KeysPage(QWidget):
    """Shows the keys; emits changed settings, and keys that are tried."""

    changed = Signal(object, str)  # DriveSettings, what was changed
    pressed = Signal(int)  # key from 1
    released = Signal(int)
    face_wanted = Signal(int)  # the face of this moment for a key

    def __init__(self, faces: Mapping[str, Sequence[float]]) -> None:
        """Make the page.

        Args:
            faces: Faces to choose from, (B,) each, by name.
        """
        super().__init__()
        self._faces = {name: tuple(weights) for name, weights in faces.items()}
        self._settings = DriveSettings()
        self._shown: tuple[bool, ...] = ()
        self.list, self.name, self.face = QListWidget(), QLineEdit(), QComboBox()
        self.hold, self.way = QComboBox(), QComboBox()
        self.fade_in = SliderRow("Comes in", 0.0, 2.0, 0.2, "{:.2f} s")
        self.fade_out = SliderRow("Fades in", 0.0, 2.0, 0.35, "{:.2f} s")
        self.content = QLabel()
        self.mine_button = QPushButton("Use my face no&w")
        self.try_button = QPushButton("&Try")
        self.clear_button = QPushButton("Clear &key")
        self.box = QGroupBox()
        self._fill()
        self._build()
        self._connect()

    @property
    def key(self) -> int:
        """The key that is edited, from 1."""
        return max(self.list.currentRow(), 0) + 1

    def show_settings(self, settings: DriveSettings) -> None:
        """Show settings; nothing is emitted."""
        self._settings = settings
        self._show_list()
        self._show_key()

    def show_pressed(self, shown: tuple[bool, ...]) -> None:
        """Mark the keys whose faces are shown now."""
        if shown != self._shown:
            self._shown = shown
            self._show_list()

    def take_face(self, key: int, expression: FloatArray) -> None:
        """Let a key show a face (B,); its other settings stay."""
        old = self._key_at(key)
        name = old.name or f"Face {key}"
        self._replace(key, replace(old, name=name, weights=key_from(name, expression).weights))

    # -- construction ---------------------------------------------------------------------

    def _fill(self) -> None:
        for _ in range(N_KEYS):
            self.list.addItem(QListWidgetItem())
        self.list.setCurrentRow(0)
        self.list.setAccessibleName("Expression keys")
        rows = self.list.sizeHintForRow(0) * N_KEYS + 2 * self.list.frameWidth()
        # Where there is no room for all keys they are scrolled.
        self.list.setMinimumHeight(3 * self.list.sizeHintForRow(0))
        self.list.setMaximumHeight(rows + 4)
        self.face.addItem("Choose a face…", "")
        for name in self._faces:
            self.face.addItem(name, name)
        for hold, text in HOLD_WORDS.items():
            self.hold.addItem(text, hold)
        for way, text in WAY_WORDS.items():
            self.way.addItem(text, way)
        self.content.setWordWrap(True)
        self.content.setAccessibleName("What the key shows")
        self.fade_in.set_tip("How quickly the face comes.")
        self.fade_out.set_tip("How quickly it goes.")
        for widget, name, tip in (
            (self.name, "Name of the key", "What you call this face"),
            (self.face, "Face", "Take one of these faces for the key"),
            (self.hold, "When it is shown", "While you hold the key, or from press to press"),
            (self.way, "How it is shown", "Whether your own face is still to be seen"),
            (self.mine_button, "Use my face now", "Make a face, then press this: the key shows it "
             "from now on. Space or Alt+W leave your hands out of the picture"),
            (self.try_button, "Try the key", "Shows the face while the button is held"),
            (self.clear_button, "Clear the key", "The key shows nothing any more"),
        ):  # fmt: skip
            widget.setAccessibleName(name)
            widget.setToolTip(tip)

    def _build(self) -> None:
        form = QFormLayout()
        form.addRow("Name", self.name)
        form.addRow("Face", self.face)
        form.addRow("Shown", self.hold)
        form.addRow("How", self.way)
        fades = QGridLayout()
        fades.setColumnStretch(1, 1)
        for line, row in enumerate((self.fade_in, self.fade_out)):
            row.setParent(self)
            row.hide()
            for column, piece in enumerate((row.name_label, row.slider, row.value_label)):
                piece.setToolTip(row.toolTip())
                fades.addWidget(piece, line, column)
        buttons = QGridLayout()
        buttons.addWidget(self.mine_button, 0, 0, 1, 2)
        buttons.addWidget(self.try_button, 1, 0)
        buttons.addWidget(self.clear_button, 1, 1)
        inner = QVBoxLayout(self.box)
        inner.addLayout(form)
        inner.addLayout(fades)
        inner.addWidget(self.content)
        inner.addLayout(buttons)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addWidget(self.list, stretch=100)
        layout.addWidget(self.box)
        layout.addStretch(1)

    def _connect(self) -> None:
        self.list.currentRowChanged.connect(self._show_key)
        self.name.editingFinished.connect(lambda: self._change(name=self.name.text().strip()))
        self.face.activated.connect(self._on_face_chosen)
        self.hold.activated.connect(lambda row: self._change(hold=self.hold.itemData(row)))
        self.way.activated.connect(lambda row: self._change(way=self.way.itemData(row)))
        self.fade_in.changed.connect(lambda value: self._change(fade_in_s=value))
        self.fade_out.changed.connect(lambda value: self._change(fade_out_s=value))
        self.mine_button.clicked.connect(lambda: self.face_wanted.emit(self.key))
        self.try_button.pressed.connect(self._on_try_pressed)
        self.try_button.released.connect(self._on_try_released)
        self.clear_button.clicked.connect(lambda: self._replace(self.key, unused_key()))

    # -- showing and changing -------------------------------------------------------------

    def _key_at(self, key: int) -> ExpressionKey:
        keys = self._settings.keys
        return keys[key - 1] if key <= len(keys) else unused_key()

    def _show_list(self) -> None:
        for row in range(N_KEYS):
            key = self._key_at(row + 1)
            on = "  ● on" if row < len(self._shown) and self._shown[row] else ""
            name = key.name if is_used(key) else UNUSED
            self.list.item(row).setText(f"Ctrl+{row + 1}   {name}{on}")

    def _show_key(self) -> None:
        key = self._key_at(self.key)
        used = is_used(key)
        self.box.setTitle(f"Ctrl+{self.key}")
        self.name.setText(key.name)
        self.face.setCurrentIndex(max(self.face.findData(self._face_of(key)), 0))
        self.hold.setCurrentIndex(self.hold.findData(key.hold))
        self.way.setCurrentIndex(self.way.findData(key.way))
        self.fade_in.show_value(key.fade_in_s)
        self.fade_out.show_value(key.fade_out_s)
        self.content.setText(f"Shows {told_weights(key.weights)}.")
        for widget in (self.name, self.hold, self.way, self.fade_in.slider, self.fade_out.slider,
                       self.try_button, self.clear_button):  # fmt: skip
            widget.setEnabled(used)

    def _face_of(self, key: ExpressionKey) -> str:
        """Return the name of the face to choose from that a key shows, or an empty text."""
        return next((name for name, face in self._faces.items() if face == key.weights), "")

    def _on_face_chosen(self, row: int) -> None:
        name = self.face.itemData(row)
        if name:
            self._change(name=name, weights=self._faces[name])

    def _change(self, **values: object) -> None:
        old = self._key_at(self.key)
        new = replace(old, **values)  # type: ignore[arg-type]
        if new != old:
            self._replace(self.key, new)

    def _replace(self, key: int, new: ExpressionKey) -> None:
        keys = [*self._settings.keys]
        keys += [unused_key() for _ in range(key - len(keys))]
        keys[key - 1] = new
        while keys and not is_used(keys[-1]):
            keys.pop()
        settings = replace(self._settings, keys=tuple(keys))
        if settings != self._settings:
            self.show_settings(settings)
            self.changed.emit(settings, f"key {key}")

    def _on_try_pressed(self) -> None:
        self.pressed.emit(self.key)

    def _on_try_released(self) -> None:
        # A face that goes on and off would stay on after a try.
        if self._key_at(self.key).hold:
            self.released.emit(self.key)
        else:
            self.pressed.emit(self.key)
