"""A row that shows how far some work in the background is."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QPushButton, QWidget

#: In widths of the letter x, for the longest stage with its remaining time.
TEXT_WIDTH_X = 52


class JobRow(QWidget):
    """What is done, how far it is, and a button to stop it; hidden without work."""

    cancel_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._text, self._bar = QLabel(), QProgressBar()
        self._text.setMinimumWidth(TEXT_WIDTH_X * self.fontMetrics().averageCharWidth())
        self._text.setAccessibleName("Work in the background")
        self._bar.setRange(0, 100)
        self._bar.setAccessibleName("Progress")
        self._cancel = QPushButton("&Cancel")
        self._cancel.clicked.connect(self._on_cancel)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(4, 0, 0, 0)
        layout.addWidget(self._text)
        layout.addWidget(self._bar, stretch=1)
        layout.addWidget(self._cancel)
        self.hide()

    @property
    def text(self) -> str:
        """What is done, empty without work."""
        return "" if self.isHidden() else self._text.text()

    @property
    def cancel_button(self) -> QPushButton:
        """The button that stops the work."""
        return self._cancel

    def begin(self, text: str) -> None:
        """Show that work begins."""
        self._cancel.setEnabled(True)
        self.show_progress(text, 0)
        self.show()

    def show_progress(self, text: str, percent: int) -> None:
        """Show how far the work is."""
        self._text.setText(text)
        self._bar.setValue(percent)

    def end(self) -> None:
        """Show nothing more."""
        self.hide()

    def _on_cancel(self) -> None:
        self._cancel.setEnabled(False)
        self._text.setText("Stopping after this step…")
        self.cancel_wanted.emit()
