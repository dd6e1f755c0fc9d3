"""How far some work on takes is; narrow enough for a panel."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QPushButton, QVBoxLayout, QWidget


class WorkBox(QWidget):
    """What is done, how far it is, and a button to stop it; hidden without work."""

    cancel_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._text, self._bar = QLabel(), QProgressBar()
        self._text.setWordWrap(True)
        self._text.setAccessibleName("Work in the background")
        self._bar.setRange(0, 100)
        self._bar.setAccessibleName("Progress")
        self.cancel_button = QPushButton("&Cancel")
        self.cancel_button.clicked.connect(self._on_cancel)
        row = QHBoxLayout()
        row.addWidget(self._bar, stretch=1)
        row.addWidget(self.cancel_button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 4, 0, 0)
        layout.addWidget(self._text)
        layout.addLayout(row)
        self.hide()

    @property
    def text(self) -> str:
        """What is done, empty without work."""
        return "" if self.isHidden() else self._text.text()

    def show_progress(self, text: str, percent: int) -> None:
        """Show that work goes on, and how far it is."""
        if self.isHidden():
            self.cancel_button.setEnabled(True)
        self._text.setText(text)
        self._bar.setValue(percent)
        self.show()

    def end(self) -> None:
        """Show nothing more."""
        self.hide()

    def _on_cancel(self) -> None:
        self.cancel_button.setEnabled(False)
        self._text.setText("Stopping after this step…")
        self.cancel_wanted.emit()
