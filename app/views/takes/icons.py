"""The few signs of a recorder, drawn in the colours of the theme."""

from collections.abc import Sequence

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPalette, QPixmap, QPolygonF
from PySide6.QtWidgets import QWidget

RECORD_COLOR = QColor(224, 36, 36)
#: Sign -> polygons in a square of 0 to 1.
SHAPES: dict[str, tuple[tuple[tuple[float, float], ...], ...]] = {
    "play": (((0.2, 0.1), (0.9, 0.5), (0.2, 0.9)),),
    "pause": (
        ((0.18, 0.12), (0.4, 0.12), (0.4, 0.88), (0.18, 0.88)),
        ((0.6, 0.12), (0.82, 0.12), (0.82, 0.88), (0.6, 0.88)),
    ),
    "stop": (((0.15, 0.15), (0.85, 0.15), (0.85, 0.85), (0.15, 0.85)),),
    "back": (
        ((0.8, 0.12), (0.8, 0.88), (0.3, 0.5)),
        ((0.12, 0.12), (0.28, 0.12), (0.28, 0.88), (0.12, 0.88)),
    ),
    "forth": (
        ((0.2, 0.12), (0.2, 0.88), (0.7, 0.5)),
        ((0.72, 0.12), (0.88, 0.12), (0.88, 0.88), (0.72, 0.88)),
    ),
    "in": (((0.3, 0.05), (0.65, 0.05), (0.65, 0.2), (0.48, 0.2), (0.48, 0.8), (0.65, 0.8),
            (0.65, 0.95), (0.3, 0.95)),),
    "out": (((0.7, 0.05), (0.35, 0.05), (0.35, 0.2), (0.52, 0.2), (0.52, 0.8), (0.35, 0.8),
             (0.35, 0.95), (0.7, 0.95)),),
}  # fmt: skip
SIZES = (16, 24, 32, 48)


def sign(name: str, widget: QWidget) -> QIcon:
    """Return one of SHAPES, or "record", in the colours of a widget."""
    icon = QIcon()
    groups = QPalette.ColorGroup
    for side in SIZES:
        for mode, group in (
            (QIcon.Mode.Normal, groups.Active), (QIcon.Mode.Disabled, groups.Disabled)
        ):  # fmt: skip
            color = widget.palette().color(group, QPalette.ColorRole.ButtonText)
            if name == "record" and mode == QIcon.Mode.Normal:
                color = RECORD_COLOR
            icon.addPixmap(_drawn(name, side, color), mode)
    return icon


def _drawn(name: str, side: int, color: QColor) -> QPixmap:
    pixmap = QPixmap(QSize(side, side))
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(color)
    if name == "record":
        painter.drawEllipse(QRectF(0.12 * side, 0.12 * side, 0.76 * side, 0.76 * side))
    for shape in SHAPES.get(name, ()):
        painter.drawPolygon(_scaled(shape, side))
    painter.end()
    return pixmap


def _scaled(shape: Sequence[tuple[float, float]], side: int) -> QPolygonF:
    return QPolygonF([QPointF(x * side, y * side) for x, y in shape])
