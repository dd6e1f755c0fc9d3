"""Asks for the name of a take."""

from collections.abc import Callable

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QLineEdit, QVBoxLayout, QWidget


class NameDialog(QDialog):
    """Says what is wrong while it is typed."""

    wanted = Signal(str)

    def __init__(
        self, name: str, trouble: Callable[[str], str], parent: QWidget | None = None
    ) -> None:
        """Ask.

        Args:
            name: The present one.
            trouble: Returns what is wrong with a name, or an empty text.
            parent: The window.
        """
        super().__init__(parent)
        self.setWindowTitle("Rename the take")
        self._trouble = trouble
        self.name, self._remark = QLineEdit(name), QLabel()
        self.name.setAccessibleName("Name of the take")
        self.name.selectAll()
        self._remark.setWordWrap(True)
        self._remark.setMinimumHeight(2 * self.fontMetrics().lineSpacing())
        boxes = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(boxes.Ok | boxes.Cancel)
        self.buttons.button(boxes.Ok).setText("&Rename")
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        for widget in (self.name, self._remark, self.buttons):
            layout.addWidget(widget)
        self.setMinimumWidth(56 * self.fontMetrics().averageCharWidth())
        self.name.textChanged.connect(self._judge)
        self.accepted.connect(lambda: self.wanted.emit(self.name.text().strip()))
        self._judge()

    @property
    def remark(self) -> str:
        """What is wrong, or an empty text."""
        return self._remark.text()

    def _judge(self) -> None:
        trouble = self._trouble(self.name.text().strip())
        self._remark.setText(trouble[:1].upper() + trouble[1:])
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(not trouble)
