"""What is said in place of a picture, with buttons for what can be done about it."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from app.views.choice import Choice
from app.views.picture_view import EMPTY_TEXT_COLOR, SURROUND_COLOR

#: In widths of the letter x: lines of this length are read easily.
TEXT_WIDTH_X, BUTTON_WIDTH_X = 56, 34


class Notice(QWidget):
    """A text and a column of buttons on the surround of the pictures."""

    chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        palette = self.palette()
        palette.setColor(QPalette.ColorRole.Window, SURROUND_COLOR)
        palette.setColor(QPalette.ColorRole.WindowText, EMPTY_TEXT_COLOR)
        self.setPalette(palette)
        self.setAutoFillBackground(True)
        self._text = QLabel()
        self._text.setWordWrap(True)
        self._text.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._buttons: list[QPushButton] = []
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(24, 24, 24, 24)
        self._layout.setSpacing(8)
        self._layout.addStretch(1)
        self._layout.addWidget(self._text)
        self._layout.setAlignment(self._text, Qt.AlignmentFlag.AlignHCenter)
        self._layout.addSpacing(8)
        self._layout.addStretch(1)

    @property
    def text(self) -> str:
        """What is said."""
        return self._text.text()

    @property
    def buttons(self) -> tuple[QPushButton, ...]:
        """The buttons, from above."""
        return tuple(self._buttons)

    def say(self, text: str, choices: Sequence[Choice] = ()) -> None:
        """Say something and offer choices."""
        self._text.setText(text)
        self._fit_text()
        for button in self._buttons:
            self._layout.removeWidget(button)
            button.hide()
            button.deleteLater()
        self._buttons = [self._add_button(choice) for choice in choices]

    def _fit_text(self) -> None:
        """Give the text its lines; a centred label with wrapped lines is cut off otherwise."""
        metrics = self._text.fontMetrics()
        longest = max(metrics.horizontalAdvance(line) for line in self._text.text().split("\n"))
        width = min(longest + 4, TEXT_WIDTH_X * metrics.averageCharWidth())
        self._text.setFixedSize(width, self._text.heightForWidth(width))

    def _add_button(self, choice: Choice) -> QPushButton:
        button = QPushButton(choice.text, self)
        button.setToolTip(choice.details)
        button.setMinimumWidth(BUTTON_WIDTH_X * self.fontMetrics().averageCharWidth())
        button.clicked.connect(lambda: self.chosen.emit(choice.key))
        last = self._layout.count() - 1
        self._layout.insertWidget(last, button, 0, Qt.AlignmentFlag.AlignHCenter)
        return button
