"""The row of presets: choose, save as, delete, undo."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QInputDialog, QLabel, QPushButton, QWidget

from app.views.choice import Choice

#: What the box shows after a change.
OWN = "Your own"


class PresetRow(QWidget):
    """Shows the presets and says what the user wishes."""

    chosen = Signal(str)
    save_wanted = Signal(str)  # name
    delete_wanted = Signal(str)
    undo_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.presets = QComboBox()
        self.save_button, self.delete_button = QPushButton("Save…"), QPushButton("&Delete")
        self.undo_button = QPushButton("Undo")
        self._own: frozenset[str] = frozenset()
        self._name_widgets()
        self._build()
        self.presets.activated.connect(self._on_activated)
        self.save_button.clicked.connect(self._ask_name)
        self.delete_button.clicked.connect(
            lambda: self.delete_wanted.emit(self.presets.currentData())
        )
        self.undo_button.clicked.connect(self.undo_wanted)

    def _name_widgets(self) -> None:
        for widget, name, tip in (
            (self.presets, "Preset", "Settings to begin with; all of them are replaced (Undo "
             "brings yours back)"),
            (self.save_button, "Save as a preset", "Keep these settings under a name, to use them "
             "with other profiles and avatars"),
            (self.delete_button, "Delete the preset", "Only presets of your own can be deleted"),
            (self.undo_button, "Undo", "Take the last change back, a reset or a preset too"),
        ):  # fmt: skip
            widget.setAccessibleName(name)
            widget.setToolTip(tip)

    def _build(self) -> None:
        self.presets.setSizeAdjustPolicy(
            QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon
        )
        self.presets.setMinimumContentsLength(9)
        label = QLabel("Preset")
        label.setBuddy(self.presets)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(label)
        layout.addWidget(self.presets, stretch=1)
        for button in (self.save_button, self.delete_button, self.undo_button):
            # As narrow as its text: the panel is narrow.
            width = button.fontMetrics().horizontalAdvance(button.text().replace("&", ""))
            button.setMaximumWidth(width + 24)
            layout.addWidget(button)

    def show_presets(self, choices: Sequence[Choice], own: Sequence[str], current: str) -> None:
        """List presets.

        Args:
            choices: All of them.
            own: Keys of those that can be deleted.
            current: Key of the one in use, empty if the settings are no preset's.
        """
        self._own = frozenset(own)
        self.presets.clear()
        for row, choice in enumerate(choices):
            self.presets.addItem(choice.text, choice.key)
            self.presets.setItemData(row, choice.details, Qt.ItemDataRole.ToolTipRole)
        if not current:
            self.presets.addItem(OWN, "")
        self.presets.setCurrentIndex(self.presets.findData(current))
        self.delete_button.setEnabled(current in self._own)

    def show_undo(self, what: str) -> None:
        """Offer to take a change back, or with an empty text nothing."""
        self.undo_button.setEnabled(bool(what))
        self.undo_button.setAccessibleDescription(f"Takes back: {what}" if what else "")

    def _on_activated(self, row: int) -> None:
        key = self.presets.itemData(row)
        if key:
            self.chosen.emit(key)

    def _ask_name(self) -> None:
        dialog = QInputDialog(self)
        dialog.setWindowTitle("Save as a preset")
        dialog.setLabelText("Name of the preset:")
        current = self.presets.currentData()
        dialog.setTextValue(current if current in self._own else "")
        dialog.textValueSelected.connect(self.save_wanted)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
