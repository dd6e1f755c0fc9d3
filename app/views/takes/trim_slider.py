"""A time line: where the take is, and what of it counts."""

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPalette, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

MARGIN, GRIP = 9, 6
#: Keys -> what they wish; a window's own keys of the same name wait while this has the focus.
KEYS = {
    Qt.Key.Key_Space: "toggle",
    Qt.Key.Key_Left: "back",
    Qt.Key.Key_Right: "forth",
    Qt.Key.Key_Comma: "back",
    Qt.Key.Key_Period: "forth",
    Qt.Key.Key_I: "in",
    Qt.Key.Key_O: "out",
    Qt.Key.Key_Home: "start",
    Qt.Key.Key_End: "end",
}


class TrimSlider(QWidget):
    """Shows and sets a position, and both ends of a range, in seconds."""

    moved = Signal(float)
    trimmed = Signal(float, float)
    wished = Signal(str)  # a value of KEYS

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Position in the take")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setToolTip(
            "Click or drag: position; drag the marks: trim.\nSpace plays, left and right go a "
            "frame back and forth, I and O trim here"
        )
        self._length_s, self._position_s = 1.0, 0.0
        self._range_s = (0.0, 1.0)
        self._held = ""

    @property
    def position_s(self) -> float:
        """Where the take is shown to be."""
        return self._position_s

    @property
    def range_s(self) -> tuple[float, float]:
        """What is shown to count."""
        return self._range_s

    def sizeHint(self) -> QSize:
        """Return a size that fits into a panel."""
        return QSize(200, 2 * self.fontMetrics().height())

    def minimumSizeHint(self) -> QSize:
        """Return the least size that can be used."""
        return QSize(120, self.sizeHint().height())

    def show_take(self, length_s: float, range_s: tuple[float, float]) -> None:
        """Show the length of a take and what of it counts."""
        self._length_s, self._range_s = max(length_s, 1e-6), range_s
        self.setAccessibleDescription(f"counts from {range_s[0]:.1f} to {range_s[1]:.1f} s")
        self.update()

    def show_position(self, position_s: float) -> None:
        """Show where the take is."""
        self._position_s = position_s
        self.update()

    # -- asked ---------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        """Take our keys before the window's actions do."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            plain = event.modifiers() in (Qt.KeyboardModifier.NoModifier, KEYPAD)
            if plain and event.key() in KEYS:
                event.accept()
                return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Wish what a key means."""
        wish = KEYS.get(Qt.Key(event.key()))
        if wish is None:
            super().keyPressEvent(event)
        else:
            self.wished.emit(wish)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of a mark, or of the position."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        x, y = event.position().x(), event.position().y()
        first, last = (abs(x - self._x(end)) for end in self._range_s)
        self._held = "position"
        if y > self.height() / 2 and min(first, last) <= GRIP + 2:
            self._held = "first" if first <= last else "last"
        self._drag(x)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move what is held."""
        if self._held:
            self._drag(event.position().x())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go; a trim counts now."""
        if self._held in ("first", "last"):
            self.trimmed.emit(*self._range_s)
        self._held = ""

    def _drag(self, x: float) -> None:
        share = (x - MARGIN) / max(self.width() - 2 * MARGIN, 1)
        time_s = min(max(share, 0.0), 1.0) * self._length_s
        if self._held == "first":
            self._range_s = (min(time_s, self._range_s[1]), self._range_s[1])
        elif self._held == "last":
            self._range_s = (self._range_s[0], max(time_s, self._range_s[0]))
        self._position_s = time_s
        self.update()
        self.moved.emit(time_s)

    # -- painted -------------------------------------------------------------------------

    def _x(self, time_s: float) -> float:
        return MARGIN + time_s / self._length_s * (self.width() - 2 * MARGIN)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the line, the part that counts, the marks, the position."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        colors = self.palette()
        middle = self.height() / 2
        first, last = (self._x(end) for end in self._range_s)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colors.color(QPalette.ColorRole.Mid))
        painter.drawRoundedRect(QRectF(MARGIN, middle - 3, self.width() - 2 * MARGIN, 6), 3, 3)
        painter.setBrush(colors.color(QPalette.ColorRole.Highlight))
        painter.drawRect(QRectF(first, middle - 3, max(last - first, 1), 6))
        text = colors.color(QPalette.ColorRole.WindowText)
        self._paint_marks(painter, (first, last), text)
        x = self._x(self._position_s)
        painter.setPen(QPen(colors.color(QPalette.ColorRole.Base), 1.5))
        painter.setBrush(text)
        painter.drawEllipse(QPointF(x, middle), 7, 7)
        if self.hasFocus():
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(colors.color(QPalette.ColorRole.Highlight), 1))
            painter.drawRoundedRect(QRectF(0.5, 0.5, self.width() - 1, self.height() - 1), 3, 3)
        painter.end()

    def _paint_marks(self, painter: QPainter, ends: tuple[float, float], color: QColor) -> None:
        """Paint both ends of what counts as feet below the line."""
        painter.setBrush(color)
        low = self.height() - 2.0
        for x, side in zip(ends, (1, -1), strict=True):
            painter.drawRect(QRectF(x - 1, self.height() / 2, 2, low - self.height() / 2))
            painter.drawRect(QRectF(min(x, x + side * GRIP), low - 3, GRIP, 3))


KEYPAD = Qt.KeyboardModifier.KeypadModifier
