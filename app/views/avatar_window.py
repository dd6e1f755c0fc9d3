"""The avatar alone, in a window without a frame: for streaming, or to keep beside other work."""

from PySide6.QtCore import QEvent, QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import (
    QAction,
    QCloseEvent,
    QContextMenuEvent,
    QEnterEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
)
from PySide6.QtWidgets import QMenu, QSizeGrip, QVBoxLayout, QWidget

from app.views.picture_view import PictureView

#: Width of the rim that is dragged to resize.
RIM_PX = 8
#: How much larger a key press makes the window.
GROWTH = 1.1
SMALLEST_PX = 120


class AvatarWindow(QWidget):
    """Shows the avatar; moved by dragging it, resized at its rim, closed by Esc.

    Where the avatar's background is transparent and the system can, one sees through it.
    """

    closed = Signal()

    def __init__(self) -> None:
        super().__init__(None, Qt.WindowType.Window | Qt.WindowType.FramelessWindowHint)
        self.setWindowTitle("facepuppet avatar")
        self.setAccessibleName("Avatar")
        self.setAttribute(Qt.WidgetAttribute.WA_TranslucentBackground)
        self.setMinimumSize(SMALLEST_PX, SMALLEST_PX)
        self.setMouseTracking(True)
        self.picture = PictureView("Avatar picture")
        self.picture.set_surround(None)
        self.picture.setMinimumSize(0, 0)
        # The window itself is dragged.
        self.picture.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.picture)
        self._grip = QSizeGrip(self)
        self._grip.hide()
        self._grabbed: QPoint | None = None
        self.resize(480, 360)

    def show_picture(self, image: QImage) -> None:
        """Show a picture, which may be transparent."""
        self.picture.show_image(image)

    def show_on_top(self, on_top: bool) -> None:
        """Keep the window above all others, or let others cover it."""
        if on_top == bool(self.windowFlags() & Qt.WindowType.WindowStaysOnTopHint):
            return
        visible, place = self.isVisible(), self.geometry()
        self.setWindowFlag(Qt.WindowType.WindowStaysOnTopHint, on_top)
        if visible:
            self.setGeometry(place)
            self.show()

    def grow(self, factor: float) -> None:
        """Make the window larger or smaller about its centre."""
        before = self.geometry()
        size = QSize(round(before.width() * factor), round(before.height() * factor))
        after = QRect(QPoint(0, 0), size.expandedTo(self.minimumSize()))
        after.moveCenter(before.center())
        self.setGeometry(after)

    # -- events --------------------------------------------------------------------------

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Close with Esc; larger and smaller with + and -."""
        factors = {Qt.Key.Key_Plus: GROWTH, Qt.Key.Key_Minus: 1 / GROWTH}
        if event.key() == Qt.Key.Key_Escape:
            self.close()
        elif event.key() in factors:
            self.grow(factors[Qt.Key(event.key())])
        else:
            super().keyPressEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin to move or resize, by the system where it can."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        edges, handle = self._edges(event.position().toPoint()), self.windowHandle()
        done = handle.startSystemResize(edges) if edges else handle.startSystemMove()
        if not done:
            self._grabbed = event.globalPosition().toPoint() - self.pos()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move with the mouse; show what a press would do."""
        if self._grabbed is not None:
            self.move(event.globalPosition().toPoint() - self._grabbed)
            return
        edges = self._edges(event.position().toPoint())
        self.setCursor(_CURSORS.get(edges, Qt.CursorShape.OpenHandCursor))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go."""
        self._grabbed = None

    def enterEvent(self, event: QEnterEvent) -> None:
        """Show where to resize."""
        size = self._grip.sizeHint()
        self._grip.setGeometry(
            self.width() - size.width(), self.height() - size.height(), size.width(), size.height()
        )
        self._grip.show()

    def leaveEvent(self, event: QEvent) -> None:
        """Show nothing but the avatar."""
        self._grip.hide()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Show what can be done here."""
        menu = QMenu(self)
        menu.addActions(self.actions())
        menu.addSeparator()
        close = QAction("&Close", menu)
        close.setShortcut("Esc")
        close.triggered.connect(self.close)
        menu.addAction(close)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.popup(event.globalPos())

    def closeEvent(self, event: QCloseEvent) -> None:
        """Tell that the window is closed."""
        super().closeEvent(event)
        self.closed.emit()

    def _edges(self, at: QPoint) -> Qt.Edge:
        """Return the sides of the window whose rim a point lies on."""
        edges = Qt.Edge(0)
        for near, edge in (
            (at.x() < RIM_PX, Qt.Edge.LeftEdge),
            (at.x() >= self.width() - RIM_PX, Qt.Edge.RightEdge),
            (at.y() < RIM_PX, Qt.Edge.TopEdge),
            (at.y() >= self.height() - RIM_PX, Qt.Edge.BottomEdge),
        ):
            if near:
                edges |= edge
        return edges


_CURSORS = {
    Qt.Edge.LeftEdge: Qt.CursorShape.SizeHorCursor,
    Qt.Edge.RightEdge: Qt.CursorShape.SizeHorCursor,
    Qt.Edge.TopEdge: Qt.CursorShape.SizeVerCursor,
    Qt.Edge.BottomEdge: Qt.CursorShape.SizeVerCursor,
    Qt.Edge.LeftEdge | Qt.Edge.TopEdge: Qt.CursorShape.SizeFDiagCursor,
    Qt.Edge.RightEdge | Qt.Edge.BottomEdge: Qt.CursorShape.SizeFDiagCursor,
    Qt.Edge.RightEdge | Qt.Edge.TopEdge: Qt.CursorShape.SizeBDiagCursor,
    Qt.Edge.LeftEdge | Qt.Edge.BottomEdge: Qt.CursorShape.SizeBDiagCursor,
}
