"""All keys of the editor on one card over the canvas."""

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QWidget

KEYS = (
    ("Drag a point", "move it; with Ctrl its neighbours on the curve follow"),
    ("Click, Shift+click", "take a point, add one"),
    ("Drag beside points", "take all in the box; with Shift add them"),
    ("Arrows", "move by 1 pixel, Shift 10, Alt 0.2"),
    ("Wheel", "zoom at the pointer"),
    ("Right drag, Space+drag", "move the picture"),
    ("F, Shift+F", "show the whole picture, the face"),
    ("J, K", "previous, next point"),
    ("G, Ctrl+A, Esc", "take the whole feature, all points, none"),
    ("A, D", "previous, next picture"),
    ("R", "the face model places all points that you did not place"),
    ("V", "compare with the fitted model"),
    ("X", "call points hidden, or seen again"),
    ("O", "leave the picture out of the training, or use it after all"),
    ("Backspace", "points as they were found"),
    ("Ctrl+C", "copy from the previous picture"),
    ("Ctrl+Shift+C", "copy from the most similar picture"),
    ("Ctrl+M", "mirror from the opposite head turn"),
    ("N", "names of all points"),
    ("Ctrl+Z, Ctrl+Shift+Z", "undo, redo"),
    ("?", "this card"),
)


class HelpCard(QFrame):
    """Lies over a widget until a key or a click."""

    def __init__(self, over: QWidget) -> None:
        super().__init__(over)
        self._over = over
        self.setAccessibleName("Keys of the editor")
        self.setAutoFillBackground(True)
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        grid = QGridLayout(self)
        grid.setContentsMargins(18, 14, 18, 14)
        grid.setHorizontalSpacing(18)
        grid.setVerticalSpacing(3)
        half = (len(KEYS) + 1) // 2
        for place, (keys, meaning) in enumerate(KEYS):
            row, column = place % half, 2 * (place // half)
            name = QLabel(f"<b>{keys}</b>")
            text = QLabel(meaning)
            text.setWordWrap(True)
            text.setMinimumWidth(170)
            grid.addWidget(name, row, column, Qt.AlignmentFlag.AlignTop)
            grid.addWidget(text, row, column + 1, Qt.AlignmentFlag.AlignTop)
        over.installEventFilter(self)
        self.hide()

    def toggle(self) -> None:
        """Show the card, or hide it."""
        if self.isHidden():
            self._center()
            self.show()
            self.raise_()
            self.setFocus()
        else:
            self._close()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Hide."""
        self._close()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Hide."""
        self._close()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Stay in the middle of what it lies over."""
        if event.type() == QEvent.Type.Resize and not self.isHidden():
            self._center()
        return False

    def _close(self) -> None:
        self.hide()
        self._over.setFocus()

    def _center(self) -> None:
        over = self._over.rect()
        width = min(self.sizeHint().width(), over.width() - 16)
        height = min(max(self.heightForWidth(width), self.sizeHint().height()), over.height() - 16)
        self.setGeometry(0, 0, width, height)
        self.move((over.width() - width) // 2, (over.height() - height) // 2)
