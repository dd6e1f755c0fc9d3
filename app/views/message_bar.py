"""A message above the pictures that stays until it is put away."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QWidget

#: Ground and text: readable beside light and dark themes.
TROUBLE_COLORS = (QColor(255, 240, 200), QColor(60, 42, 0))
NEWS_COLORS = (QColor(214, 232, 255), QColor(12, 34, 72))


class MessageBar(QFrame):
    """One message, or hidden."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAutoFillBackground(True)
        self._label = QLabel()
        self._label.setWordWrap(True)
        self._label.setAccessibleName("Message")
        self._label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        close = QPushButton("&Dismiss")
        close.clicked.connect(self.hide)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(12, 6, 6, 6)
        layout.addWidget(self._label, stretch=1)
        layout.addWidget(close, 0, Qt.AlignmentFlag.AlignTop)
        self.hide()

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

    def _show(self, text: str, colors: tuple[QColor, QColor]) -> None:
        palette = QPalette(self.palette())
        palette.setColor(QPalette.ColorRole.Window, colors[0])
        palette.setColor(QPalette.ColorRole.WindowText, colors[1])
        self.setPalette(palette)
        # Messages begin in lower case, as on the command line.
        self._label.setText(text[:1].upper() + text[1:])
        self.setVisible(bool(text))
