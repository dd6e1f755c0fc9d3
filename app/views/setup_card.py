"""An invitation to the guided setup for who has no profile yet."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QToolButton, QWidget

#: Ground and text: friendly beside light and dark themes.
GROUND, TEXT = QColor(222, 240, 228), QColor(16, 48, 30)
INVITATION = (
    "<b>You are tracked already, without any setup.</b> With a profile of your own face the avatar "
    "follows you more closely, and nobody else moves it."
)


class SetupCard(QFrame):
    """Says what a profile would bring; one button begins, another puts the card away."""

    wanted = Signal()
    dismissed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAutoFillBackground(True)
        self.setAccessibleName("Invitation to the setup")
        palette = QPalette(self.palette())
        palette.setColor(QPalette.ColorRole.Window, GROUND)
        palette.setColor(QPalette.ColorRole.WindowText, TEXT)
        plain = QPalette(palette)
        plain.setColor(QPalette.ColorRole.ButtonText, TEXT)
        self.setPalette(palette)
        text = QLabel(INVITATION)
        text.setWordWrap(True)
        self.button = QPushButton("Set &up my face (10 minutes)")
        self.close_button = QToolButton()
        self.close_button.setText("✕")
        self.close_button.setAutoRaise(True)
        self.close_button.setPalette(plain)
        self.close_button.setAccessibleName("Not now")
        self.close_button.setToolTip("Not now: it stays in the menu Face")
        self.close_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        row = QHBoxLayout(self)
        row.setContentsMargins(12, 8, 6, 8)
        row.setSpacing(12)
        row.addWidget(text, stretch=1)
        row.addWidget(self.button)
        row.addWidget(self.close_button, 0, Qt.AlignmentFlag.AlignTop)
        self.button.clicked.connect(self.wanted)
        self.close_button.clicked.connect(self._on_dismissed)
        self.hide()

    def _on_dismissed(self) -> None:
        self.hide()
        self.dismissed.emit()
