"""How the editor's canvas looks. Shapes tell what colours tell, for those who see few colours."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QImage, QPainter, QPainterPath, QPen

from app.views.editor.scene import Scene
from app.views.editor.zoom import Zoom
from core.landmark_refit import FittedModel

#: From the palette of Okabe and Ito, told apart with every kind of colour vision.
FOUND, PLACED, HIDDEN = QColor(86, 180, 233), QColor(240, 228, 66), QColor(213, 94, 0)
SELECTED, MODEL, MESH = QColor(255, 255, 255), QColor(204, 121, 167), QColor(0, 158, 115, 110)
EDGE, CURVE = QColor(10, 20, 30, 220), QColor(86, 180, 233, 120)
LABEL_BACK = QColor(15, 17, 20, 215)
RADIUS = 4.0
#: Below this a found point is drawn hollow: look at it.
UNSURE = 0.3
LOUPE_SIZE, LOUPE_ZOOM = 150.0, 3.0


def paint_scene(painter: QPainter, scene: Scene, zoom: Zoom) -> None:
    """Paint all that lies over the picture."""
    if scene.fitted is not None:
        _paint_mesh(painter, scene.fitted, zoom)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    places = places_of(scene.points_px, zoom)
    painter.setPen(QPen(CURVE, 1.2))
    for curve in scene.curves:
        painter.drawPolyline([places[index] for index in curve])
    if scene.fitted is not None:
        _paint_model(painter, scene.fitted.points_px, zoom)
    for index in sorted(range(len(places)), key=lambda one: one in scene.selected):
        _paint_point(painter, scene, index, places[index])


def places_of(points_px: NDArray[np.float64], zoom: Zoom) -> list[QPointF]:
    """Return where points are in the widget."""
    return [zoom.to_widget(float(x), float(y)) for x, y in points_px]


def _paint_mesh(painter: QPainter, fitted: FittedModel, zoom: Zoom) -> None:
    corners = places_of(fitted.mesh_px, zoom)
    painter.setPen(QPen(MESH, 1.0))
    painter.drawLines([QLineF(corners[a], corners[b]) for a, b in fitted.edges])


def _paint_model(painter: QPainter, model_px: NDArray[np.float64], zoom: Zoom) -> None:
    painter.setPen(QPen(MODEL, 1.6))
    for place in places_of(model_px, zoom):
        painter.drawLine(place + QPointF(-4, -4), place + QPointF(4, 4))
        painter.drawLine(place + QPointF(-4, 4), place + QPointF(4, -4))


def _paint_point(painter: QPainter, scene: Scene, index: int, place: QPointF) -> None:
    """Found: disc. Placed: square. Hidden: cross. In the hand: a white ring around it."""
    if index in scene.selected:
        painter.setPen(QPen(EDGE, 4.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(place, RADIUS + 4, RADIUS + 4)
        painter.setPen(QPen(SELECTED, 2.0))
        painter.drawEllipse(place, RADIUS + 4, RADIUS + 4)
    painter.setPen(QPen(EDGE, 1.0))
    if scene.hidden[index]:
        for color, width in ((EDGE, 4.0), (HIDDEN, 2.0)):
            painter.setPen(QPen(color, width))
            painter.drawLine(place + QPointF(-4, -4), place + QPointF(4, 4))
            painter.drawLine(place + QPointF(-4, 4), place + QPointF(4, -4))
    elif scene.placed[index]:
        painter.setBrush(PLACED)
        painter.drawRect(QRectF(place.x() - 3.5, place.y() - 3.5, 7, 7))
    elif scene.confidence[index] < UNSURE:
        painter.setPen(QPen(EDGE, 3.5))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(place, RADIUS, RADIUS)
        painter.setPen(QPen(FOUND, 1.6))
        painter.drawEllipse(place, RADIUS, RADIUS)
    else:
        painter.setBrush(FOUND)
        painter.drawEllipse(place, RADIUS, RADIUS)


def label_box(painter: QPainter, text: str, place: QPointF, inside: QRectF) -> QRectF:
    """Return where a short text has room beside a place, within the widget."""
    metrics = painter.fontMetrics()
    box = QRectF(0, 0, metrics.horizontalAdvance(text) + 14, metrics.height() + 6)
    box.moveTopLeft(place + QPointF(14, -box.height() - 8))
    box.moveLeft(min(max(box.left(), inside.left()), inside.right() - box.width()))
    box.moveTop(min(max(box.top(), inside.top()), inside.bottom() - box.height()))
    return box


def paint_label(painter: QPainter, text: str, box: QRectF) -> None:
    """Paint a short text on a dark ground."""
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(LABEL_BACK)
    painter.drawRoundedRect(box, 5, 5)
    painter.setPen(QColor(240, 242, 245))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def paint_loupe(painter: QPainter, image: QImage, point: QPointF, zoom: Zoom, at: QPointF) -> None:
    """Paint the picture around a point enlarged, in a corner away from the hand.

    Args:
        painter: Of the widget.
        image: The picture.
        point: In picture coordinates, whole numbers at pixel centres.
        zoom: Of the canvas.
        at: Upper left corner of the loupe.
    """
    box = QRectF(at.x(), at.y(), LOUPE_SIZE, LOUPE_SIZE)
    scale = max(LOUPE_ZOOM * zoom.scale, 4.0)
    side = LOUPE_SIZE / scale
    source = QRectF(point.x() + 0.5 - side / 2, point.y() + 0.5 - side / 2, side, side)
    outline = QPainterPath()
    outline.addEllipse(box)
    painter.save()
    painter.setClipPath(outline)
    painter.fillRect(box, QBrush(QColor(32, 34, 37)))
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, scale < 12)
    painter.drawImage(box, image, source)
    center = box.center()
    for color, width in ((EDGE, 3.0), (SELECTED, 1.0)):
        painter.setPen(QPen(color, width))
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            step = QPointF(dx, dy)
            painter.drawLine(center + step * 5.0, center + step * 22.0)
    painter.restore()
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(SELECTED, 2.0))
    painter.drawEllipse(box)


def small(font: QFont) -> QFont:
    """Return a font a little smaller than the one of the widgets around."""
    smaller = QFont(font)
    smaller.setPointSizeF(max(0.9 * font.pointSizeF(), 7.0))
    return smaller
