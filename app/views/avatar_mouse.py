"""Mouse and keys over the avatar's picture: turn, zoom and move it."""

from PySide6.QtCore import QEvent, QObject, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QWheelEvent

from app.views.picture_view import PictureView

#: Turn for a drag over the whole height of the picture.
TURN_RAD = 3.0
#: Turn, shift and zoom of one key press.
KEY_TURN_RAD, KEY_SHIFT, KEY_ZOOM = 0.12, 0.04, 1.1
#: A notch of a wheel gives 120.
ZOOM_PER_UNIT = 1.0012
HELP = (
    "Drag to turn the avatar, turn the wheel to zoom, drag with the right button to move it; "
    "double click to see it as at first. Keys: arrows, + and -, Shift with arrows, Home"
)

_ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}


class AvatarMouse(QObject):
    """Listens to a picture's events and says what the user wishes.

    All places and ways are in heights of the picture, from its middle.
    """

    turned = Signal(float, float)  # rad to the right, rad down
    panned = Signal(float, float)  # right, down
    zoomed = Signal(float, float, float)  # factor, place to the right, place down
    reset_wanted = Signal()

    def __init__(self, picture: PictureView) -> None:
        """Listen to a picture, which can have the keyboard from now on."""
        super().__init__(picture)
        self._picture = picture
        self._last: QPointF | None = None
        self._button = Qt.MouseButton.NoButton
        picture.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        picture.setToolTip(HELP)
        picture.setAccessibleDescription(HELP)
        picture.setContextMenuPolicy(Qt.ContextMenuPolicy.PreventContextMenu)
        picture.installEventFilter(self)
        self._answers = {
            QEvent.Type.MouseButtonPress: self._on_press,
            QEvent.Type.MouseMove: self._on_move,
            QEvent.Type.MouseButtonRelease: self._on_release,
            QEvent.Type.MouseButtonDblClick: self._on_double_click,
            QEvent.Type.Wheel: self._on_wheel,
            QEvent.Type.KeyPress: self._on_key,
        }

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Answer the picture's events; returns True for those that are done with."""
        answer = self._answers.get(event.type())
        return answer is not None and answer(event)

    def _place(self, position: QPointF) -> QPointF:
        area = self._picture.picture_rect()
        return (position - area.center()) / max(area.height(), 1.0)

    def _on_press(self, event: QEvent) -> bool:
        mouse = _mouse(event)
        self._button, self._last = mouse.button(), self._place(mouse.position())
        self._picture.setFocus(Qt.FocusReason.MouseFocusReason)
        self._picture.setCursor(Qt.CursorShape.ClosedHandCursor)
        return True

    def _on_move(self, event: QEvent) -> bool:
        if self._last is None:
            return False
        here = self._place(_mouse(event).position())
        way, self._last = here - self._last, here
        if self._button == Qt.MouseButton.LeftButton:
            self.turned.emit(TURN_RAD * way.x(), TURN_RAD * way.y())
        else:
            self.panned.emit(way.x(), way.y())
        return True

    def _on_release(self, _event: QEvent) -> bool:
        self._last = None
        self._picture.unsetCursor()
        return True

    def _on_double_click(self, event: QEvent) -> bool:
        if _mouse(event).button() == Qt.MouseButton.LeftButton:
            self.reset_wanted.emit()
        return True

    def _on_wheel(self, event: QEvent) -> bool:
        if not isinstance(event, QWheelEvent):
            return False
        place = self._place(event.position())
        self.zoomed.emit(ZOOM_PER_UNIT ** event.angleDelta().y(), place.x(), place.y())
        return True

    def _on_key(self, event: QEvent) -> bool:
        if not isinstance(event, QKeyEvent):
            return False
        key = Qt.Key(event.key())
        if key in _ARROWS:
            right, down = _ARROWS[key]
            if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
                self.panned.emit(KEY_SHIFT * right, KEY_SHIFT * down)
            else:
                self.turned.emit(KEY_TURN_RAD * right, KEY_TURN_RAD * down)
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal, Qt.Key.Key_Minus):
            factor = 1 / KEY_ZOOM if key == Qt.Key.Key_Minus else KEY_ZOOM
            self.zoomed.emit(factor, 0.0, 0.0)
        elif key in (Qt.Key.Key_Home, Qt.Key.Key_0):
            self.reset_wanted.emit()
        else:
            return False
        return True


def _mouse(event: QEvent) -> QMouseEvent:
    """Return an event of the mouse as what it is.

    Raises:
        TypeError: It is another one.
    """
    if not isinstance(event, QMouseEvent):
        raise TypeError(f"expected an event of the mouse, got {type(event).__name__}")
    return event
