"""The canvas of the landmark editor: shows a scene, turns hand and keys into wishes."""

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, QSizeF, Qt, Signal
from PySide6.QtGui import (
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.views.editor.painting import (
    LOUPE_SIZE,
    SELECTED,
    label_box,
    paint_label,
    paint_loupe,
    paint_scene,
)
from app.views.editor.scene import Scene
from app.views.editor.zoom import Zoom, fitted
from app.views.picture_view import SURROUND_COLOR

#: How near the hand must come to a point, in widget pixels.
REACH = 11.0
#: So far the hand must go before a press becomes a drag.
SLACK = 3.0
ARROWS = {
    Qt.Key.Key_Left: (-1.0, 0.0), Qt.Key.Key_Right: (1.0, 0.0),
    Qt.Key.Key_Up: (0.0, -1.0), Qt.Key.Key_Down: (0.0, 1.0),
}  # fmt: skip
PAN, BOX, POINT = "pan", "box", "point"
#: What the zoom keeps in sight when another picture comes.
WHOLE, FACE, FREE = "whole", "face", "free"


class LandmarkCanvas(QWidget):
    """Shows a picture with its points; the hand zooms, pans, picks and drags."""

    picked = Signal(int, bool)  # a point; True adds it to those in the hand
    boxed = Signal(list, bool)  # points in a box; True adds them
    dragged = Signal(float, float, bool)  # since the press, picture pixels; True = soft
    dropped = Signal()
    nudged = Signal(float, float)  # picture pixels

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Picture with landmarks")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(240, 180)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self._scene: Scene | None = None
        self._zoom, self._fit = Zoom(), FACE
        self._action, self._pressed, self._last = "", QPointF(), QPointF()
        self._moved, self._space, self._all_names = False, False, False
        self._hovered = -1

    def sizeHint(self) -> QSize:
        """Return a size that shows a webcam's picture well."""
        return QSize(800, 600)

    @property
    def zoom(self) -> Zoom:
        """Where the picture lies."""
        return self._zoom

    @property
    def hovered(self) -> int:
        """The point under the hand, -1 if there is none."""
        return self._hovered

    @property
    def scene(self) -> Scene | None:
        """What is shown."""
        return self._scene

    def show_scene(self, scene: Scene | None) -> None:
        """Show a scene; another picture is shown as large as the last one was asked for."""
        before, self._scene = self._scene, scene
        if scene is not None and (before is None or before.name != scene.name):
            self._refit()
        self.update()

    def show_all_names(self, shown: bool) -> None:
        """Show the names of all points, or only of the one under the hand."""
        self._all_names = shown
        self.update()

    def fit(self) -> None:
        """Show the whole picture."""
        if self._scene is not None:
            image = self._scene.image
            self._zoom = fitted(QRectF(0, 0, image.width(), image.height()), self._size())
            self._fit = WHOLE
            self.update()

    def fit_face(self) -> None:
        """Show the face as large as the canvas allows."""
        if self._scene is None:
            return
        points = self._scene.points_px
        (left, top), (right, bottom) = points.min(axis=0), points.max(axis=0)
        margin = 0.22 * max(right - left, bottom - top, 10.0)
        area = QRectF(left - margin, top - margin, right - left, bottom - top)
        self._zoom = fitted(area.adjusted(0, 0, 2 * margin, 2 * margin), self._size())
        self._fit = FACE
        self.update()

    def show_point(self, index: int) -> None:
        """Bring a point into sight if it is not."""
        if self._scene is None:
            return
        place = self._zoom.to_widget(*map(float, self._scene.points_px[index]))
        if not QRectF(self.rect()).adjusted(40, 40, -40, -40).contains(place):
            self._pan(QRectF(self.rect()).center() - place)

    # -- the hand ------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin to pan, to draw a box or to drag a point."""
        self.setFocus()
        self._pressed = self._last = event.position()
        self._moved = False
        self._action = self._action_of(event)
        if self._action == POINT:
            index, adds = self._near(event.position()), self._adds(event)
            if self._scene is not None and (adds or index not in self._scene.selected):
                self.picked.emit(index, adds)
        self._show_cursor()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Go on with what was begun, or tell which point the hand is over."""
        place = event.position()
        if not self._action:
            self._hover(place)
            return
        if (place - self._pressed).manhattanLength() > SLACK:
            self._moved = True
        if self._action == PAN:
            self._pan(place - self._last)
        elif self._action == POINT and self._moved:
            shift = (place - self._pressed) / self._zoom.scale
            soft = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
            self.dragged.emit(shift.x(), shift.y(), soft)
        self._last = place
        self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End what was begun."""
        action, self._action = self._action, ""
        if action == POINT and self._moved:
            self.dropped.emit()
        elif action == BOX:
            self.boxed.emit(self._in_box(), self._adds(event))
        self._hover(event.position())
        self._show_cursor()
        self.update()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Show the face large, or the whole picture again."""
        if self._near(event.position()) < 0:
            self.fit() if self._fit == FACE else self.fit_face()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom at the hand."""
        self._zoom = self._zoom.scaled(1.0015 ** event.angleDelta().y(), event.position())
        self._fit = FREE
        self._pan(QPointF(0, 0))
        self._hover(event.position())

    def leaveEvent(self, event: QEvent) -> None:
        """Name no point any more."""
        self._hovered = -1
        self.update()

    # -- keys ----------------------------------------------------------------------------

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Nudge with the arrows; Space makes the hand pan."""
        arrow = ARROWS.get(Qt.Key(event.key()))
        if arrow is not None:
            step = 1.0
            if event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
                step = 10.0
            elif event.modifiers() & Qt.KeyboardModifier.AltModifier:
                step = 0.2
            self.nudged.emit(step * arrow[0], step * arrow[1])
        elif event.key() == Qt.Key.Key_Space:
            self._space = True
            self._show_cursor()
        else:
            super().keyPressEvent(event)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """The hand picks again when Space is let go."""
        if event.key() == Qt.Key.Key_Space and not event.isAutoRepeat():
            self._space = False
            self._show_cursor()
        super().keyReleaseEvent(event)

    def focusOutEvent(self, event: QEvent) -> None:
        """Forget a Space whose release another window will see."""
        self._space = False
        self._show_cursor()

    # -- painting ------------------------------------------------------------------------

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep in sight what was."""
        self._refit()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the picture, the points, and what helps the hand."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), SURROUND_COLOR)
        if self._scene is not None:
            self._paint(painter, self._scene)
        painter.end()

    def _paint(self, painter: QPainter, scene: Scene) -> None:
        painter.save()
        painter.setTransform(self._zoom.transform(), combine=True)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, self._zoom.scale < 6)
        painter.drawImage(QPointF(0, 0), scene.image)
        painter.restore()
        paint_scene(painter, scene, self._zoom)
        self._paint_names(painter, scene)
        if self._action == BOX and self._moved:
            painter.setPen(QPen(SELECTED, 1.5, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(self._box())
        if self._action == POINT and self._moved and scene.selected:
            self._paint_loupe(painter, scene)

    def _paint_names(self, painter: QPainter, scene: Scene) -> None:
        every = range(len(scene.names)) if self._all_names else ()
        inside = QRectF(self.rect()).adjusted(4, 4, -4, -4)
        taken: list[QRectF] = []
        for index in dict.fromkeys([self._hovered, *every]):
            if not 0 <= index < len(scene.names):
                continue
            text = scene.names[index]
            place = self._zoom.to_widget(*map(float, scene.points_px[index]))
            box = label_box(painter, text, place, inside)
            # Names that have no room come when one looks closer.
            if not any(box.intersects(other) for other in taken):
                paint_label(painter, text, box)
                taken.append(box)

    def _paint_loupe(self, painter: QPainter, scene: Scene) -> None:
        index = self._held(scene)
        point = scene.points_px[index]
        left = self._last.x() > self.width() / 2
        corner = QPointF(12 if left else self.width() - LOUPE_SIZE - 12, 12)
        paint_loupe(painter, scene.image, QPointF(*map(float, point)), self._zoom, corner)

    # -- help ----------------------------------------------------------------------------

    def _action_of(self, event: QMouseEvent) -> str:
        if self._scene is None:
            return ""
        if event.button() != Qt.MouseButton.LeftButton or self._space:
            return PAN
        if self._near(event.position()) >= 0:
            return POINT
        return BOX

    @staticmethod
    def _adds(event: QMouseEvent) -> bool:
        return bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)

    def _near(self, place: QPointF) -> int:
        """Return the point nearest to a place, -1 if none is within reach."""
        if self._scene is None:
            return -1
        at = self._zoom.to_picture(place)
        distance = np.linalg.norm(self._scene.points_px - [at.x(), at.y()], axis=1)
        nearest = int(distance.argmin())
        return nearest if distance[nearest] * self._zoom.scale <= REACH else -1

    def _held(self, scene: Scene) -> int:
        """Return which of the selected points is nearest to the hand."""
        at = self._zoom.to_picture(self._last)
        chosen = sorted(scene.selected)
        distance = np.linalg.norm(scene.points_px[chosen] - [at.x(), at.y()], axis=1)
        return chosen[int(distance.argmin())]

    def _box(self) -> QRectF:
        return QRectF(self._pressed, self._last).normalized()

    def _in_box(self) -> list[int]:
        if self._scene is None or not self._moved:
            return []
        places = (self._zoom.to_widget(float(x), float(y)) for x, y in self._scene.points_px)
        return [index for index, place in enumerate(places) if self._box().contains(place)]

    def _hover(self, place: QPointF) -> None:
        hovered = self._near(place)
        if hovered != self._hovered:
            self._hovered = hovered
            self._show_cursor()
            self.update()

    def _pan(self, shift: QPointF) -> None:
        if self._scene is not None:
            image = self._scene.image
            self._zoom = self._zoom.panned(shift, QSizeF(image.size()), self._size())
            if not shift.isNull():
                self._fit = FREE
            self.update()

    def _refit(self) -> None:
        if self._fit == WHOLE:
            self.fit()
        elif self._fit == FACE:
            self.fit_face()

    def _size(self) -> QSizeF:
        return QSizeF(self.size())

    def _show_cursor(self) -> None:
        shape = Qt.CursorShape.ArrowCursor
        if self._action == PAN:
            shape = Qt.CursorShape.ClosedHandCursor
        elif self._space:
            shape = Qt.CursorShape.OpenHandCursor
        elif self._hovered >= 0 or self._action == POINT:
            shape = Qt.CursorShape.CrossCursor
        self.setCursor(shape)
