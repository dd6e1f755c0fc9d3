"""Asks how a take's video is to be solved again."""

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QVBoxLayout,
    QWidget,
)

NO_PROFILE = "No profile"


class SolveDialog(QDialog):
    """Emits the wish: the name of a profile, "" without one, and a mode."""

    wanted = Signal(str, str)

    def __init__(
        self, name: str, profiles: Sequence[str], current: str, modes: Mapping[str, str],
        parent: QWidget | None = None,
    ) -> None:  # fmt: skip
        """Ask.

        Args:
            name: Of the take.
            profiles: Names of the profiles that there are.
            current: The one to begin with.
            modes: Key -> text; the last needs no profile.
            parent: The window.
        """
        super().__init__(parent)
        self.setWindowTitle("Solve the take again")
        self.profiles, self.modes = QComboBox(), QComboBox()
        self._modes = modes
        self.profiles.addItems([NO_PROFILE, *profiles])
        self.profiles.setCurrentText(current if current in profiles else NO_PROFILE)
        told = QLabel(
            f"The video of “{name}” is solved again in the background, every frame of it. The "
            "result is a new take; this one stays as it is."
        )
        told.setWordWrap(True)
        form = QFormLayout()
        form.addRow("&Profile", self.profiles)
        form.addRow("&Mode", self.modes)
        boxes = QDialogButtonBox.StandardButton
        buttons = QDialogButtonBox(boxes.Ok | boxes.Cancel)
        buttons.button(boxes.Ok).setText("&Solve")
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addWidget(told)
        layout.addLayout(form)
        layout.addWidget(buttons)
        self.setMinimumWidth(62 * self.fontMetrics().averageCharWidth())
        self.profiles.currentIndexChanged.connect(self._show_modes)
        self._show_modes()
        self.accepted.connect(self._wish)

    def _show_modes(self) -> None:
        """Offer what the profile, or its absence, allows."""
        with_profile = self.profiles.currentIndex() > 0
        keys = list(self._modes)
        self.modes.clear()
        for key in keys if with_profile else keys[-1:]:
            self.modes.addItem(self._modes[key], key)

    def _wish(self) -> None:
        chosen = self.profiles.currentIndex() > 0
        profile = self.profiles.currentText() if chosen else ""
        self.wanted.emit(profile, self.modes.currentData())
