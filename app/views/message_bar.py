"""A message above the pictures that stays until it is put away."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QWidget

from app.views.choice import Choice

#: Ground and text: readable beside light and dark themes.
TROUBLE_COLORS = (QColor(255, 240, 200), QColor(60, 42, 0))
NEWS_COLORS = (QColor(214, 232, 255), QColor(12, 34, 72))


class MessageBar(QFrame):
    """One message, or hidden; `tell` a trouble, `announce` good news, `offer` something to do.

    The key of a choice comes in `chosen`, which everybody hears who makes offers: let keys begin
    with a word of yours, as in "shots.add".
    """

    chosen = Signal(str)  # the key of an offered choice

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAutoFillBackground(True)
        self._label = QLabel()
        self._label.setWordWrap(True)
        self._label.setAccessibleName("Message")
        self._label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        close = QPushButton("&Dismiss")
        close.clicked.connect(self.hide)
        self._buttons: list[QPushButton] = []
        self._layout = QHBoxLayout(self)
        self._layout.setContentsMargins(12, 6, 6, 6)
        self._layout.addWidget(self._label, stretch=1)
        self._layout.addWidget(close, 0, Qt.AlignmentFlag.AlignTop)
        self.hide()

    @property
    def buttons(self) -> tuple[QPushButton, ...]:
        """The buttons of what is offered, from the left."""
        return tuple(self._buttons)

    @property
    def text(self) -> str:
        """The message, empty while hidden."""
        return "" if self.isHidden() else self._label.text()

    def tell(self, text: str) -> None:
        """Show that something went wrong, or with an empty text nothing."""
        self._show(text, TROUBLE_COLORS)

    def announce(self, text: str) -> None:
        """Show good news."""
        self._show(text, NEWS_COLORS)

    def offer(self, text: str, choices: Sequence[Choice]) -> None:
        """Show good news with buttons for what can be done; each puts the message away."""
        self._show(text, NEWS_COLORS)
        self._buttons = [self._add_button(choice) for choice in choices]

    def _add_button(self, choice: Choice) -> QPushButton:
        button = QPushButton(choice.text, self)
        button.setToolTip(choice.details)
        button.clicked.connect(self.hide)
        button.clicked.connect(lambda: self.chosen.emit(choice.key))
        self._layout.insertWidget(self._layout.count() - 1, button, 0, Qt.AlignmentFlag.AlignTop)
        return button

    def _show(self, text: str, colors: tuple[QColor, QColor]) -> None:
        for button in self._buttons:
            self._layout.removeWidget(button)
            button.hide()
            button.deleteLater()
        self._buttons = []
        palette = QPalette(self.palette())
        palette.setColor(QPalette.ColorRole.Window, colors[0])
        palette.setColor(QPalette.ColorRole.WindowText, colors[1])
        self.setPalette(palette)
        # Messages begin in lower case, as on the command line.
        self._label.setText(text[:1].upper() + text[1:])
        self.setVisible(bool(text))
