"""What may lie over a picture. Each layer is a value that was read from a state and paints itself.

Layers over the picture count in its pixels and are mirrored with it; the others lie on the screen
in front of it, upright and of one size whatever the picture's.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

#: Bright on skin and on dark hair, and told apart by colour-blind people.
POINT_COLOR = QColor(0, 220, 255)
POINT_EDGE = QColor(0, 40, 60, 200)
LOST_COLOR = QColor(255, 170, 0)
APPEARANCE_COLOR = QColor(255, 214, 90)
MESH_COLOR = QColor(180, 255, 220, 150)
#: The subject's left, up, and where the face looks.
AXIS_COLORS = (QColor(255, 90, 90), QColor(110, 230, 110), QColor(100, 160, 255))
BAR_GROUND, BAR_COLOR = QColor(20, 22, 24, 120), QColor(0, 190, 230, 220)
BAR_TEXT, BAR_PALE_TEXT = QColor(245, 247, 250), QColor(160, 165, 170)
TRACE_GROUND, TRACE_LIMIT = QColor(20, 22, 24, 190), QColor(160, 165, 170, 120)
TRACE_PARTS = QColor(255, 220, 120)
TRACE_SIZE = (220.0, 64.0)


class Layer(Protocol):
    """Something to paint over a picture."""

    @property
    def over_picture(self) -> bool:
        """Whether it counts in the picture's pixels, rather than lying in front of it."""
        ...

    def paint(self, painter: QPainter, area: QRectF) -> None:
        """Paint.

        Args:
            painter: In pixels of the picture, or of the screen.
            area: Where the picture lies in them.
        """
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Points to draw over a picture.

    Attributes:
        points_px: (L, 2) in the picture's pixels.
        curves: Sequences of indices to join by lines.
        certain: False draws in the warning colour.
        radius: Of a dot, in pixels of the screen.
        color: Of what is certain.
    """

    over_picture: ClassVar[bool] = True
    points_px: NDArray[np.float64]
    curves: tuple[tuple[int, ...], ...] = ()
    certain: bool = True
    radius: float = 1.8
    color: QColor = field(default_factory=lambda: POINT_COLOR)

    def paint(self, painter: QPainter, area: QRectF) -> None:
        """Paint curves, then dots."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        # Pixel centres are whole numbers in our coordinates and halves in Qt's.
        points = [QPointF(x + 0.5, y + 0.5) for x, y in self.points_px.tolist()]
        color = self.color if self.certain else LOST_COLOR
        painter.setPen(thin_pen(color, 1.0))
        for curve in self.curves:
            painter.drawPolyline([points[index] for index in curve])
        radius = self.radius / painter.transform().m22()
        painter.setPen(thin_pen(POINT_EDGE, 0.8))
        painter.setBrush(color)
        for point in points:
            painter.drawEllipse(point, radius, radius)


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Straight lines over a picture.

    Attributes:
        ends_px: (N, 4) x, y of both ends, in the picture's pixels.
        color: Of the lines.
        width: In pixels of the screen.
    """

    over_picture: ClassVar[bool] = True
    ends_px: NDArray[np.float64]
    color: QColor = field(default_factory=lambda: MESH_COLOR)
    width: float = 1.0

    def paint(self, painter: QPainter, area: QRectF) -> None:
        """Paint all lines in one go."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, len(self.ends_px) < 100)
        painter.setPen(thin_pen(self.color, self.width))
        painter.drawLines([QLineF(*ends) for ends in (self.ends_px + 0.5).tolist()])


@dataclass(frozen=True, slots=True, eq=False)
class Bars:
    """Coefficients as bars with their names, at both sides of the picture.

    Attributes:
        values: (B,) in [0, 1].
        names: B of them.
    """

    over_picture: ClassVar[bool] = False
    values: NDArray[np.float64]
    names: Sequence[str]

    def paint(self, painter: QPainter, area: QRectF) -> None:
        """Paint two columns of bars with their names, at the left and the right."""
        rows = -(-len(self.values) // 2)
        height = (area.height() - 16) / rows
        font = painter.font()
        font.setPixelSize(max(7, min(11, round(height - 2))))
        painter.setFont(font)
        metrics = painter.fontMetrics()
        name_width = max(metrics.horizontalAdvance(name) for name in self.names) + 6
        width = min(name_width + 48.0, area.width() / 2 - 8)
        for place, (name, value) in enumerate(zip(self.names, self.values.tolist(), strict=True)):
            right = place >= rows
            left = area.right() - width - 8 if right else area.left() + 8
            box = QRectF(left, area.top() + 8 + (place % rows) * height, width, height - 1)
            self._paint_bar(painter, box, name, value, name_width)

    def _paint_bar(
        self, painter: QPainter, box: QRectF, name: str, value: float, name_width: float
    ) -> None:
        painter.fillRect(box, BAR_GROUND)
        full = QRectF(box.left() + name_width, box.top(), box.width() - name_width, box.height())
        full.setWidth(full.width() * min(max(value, 0.0), 1.0))
        painter.fillRect(full, BAR_COLOR)
        painter.setPen(BAR_TEXT if value > 0.05 else BAR_PALE_TEXT)
        painter.drawText(box.adjusted(3, 0, 0, 0), Qt.AlignmentFlag.AlignVCenter, name)


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """How sure the tracker was of late: a small graph in the upper left corner.

    Attributes:
        ages_s: (n,) how long ago, rising; the newest is 0.
        sure: (n,) confidence in [0, 1]; 0 where the face was lost.
        least: (n,) confidence of the part of the face that is seen worst.
        span_s: Time across the graph.
    """

    over_picture: ClassVar[bool] = False
    ages_s: NDArray[np.float64]
    sure: NDArray[np.float64]
    least: NDArray[np.float64]
    span_s: float

    def paint(self, painter: QPainter, area: QRectF) -> None:
        """Paint both lines over a dark ground."""
        box = QRectF(area.left() + 10, area.top() + 10, *TRACE_SIZE)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(TRACE_GROUND)
        painter.drawRoundedRect(box, 4, 4)
        inner = box.adjusted(6, 16, -6, -5)
        painter.setPen(QPen(TRACE_LIMIT, 1.0, Qt.PenStyle.DashLine))
        painter.drawLine(QPointF(inner.left(), inner.center().y()), inner.center())
        painter.drawLine(inner.center(), QPointF(inner.right(), inner.center().y()))
        for values, color in ((self.least, TRACE_PARTS), (self.sure, POINT_COLOR)):
            painter.setPen(QPen(color, 1.4))
            painter.drawPolyline(self._points(inner, values))
        self._paint_text(painter, box)

    def _points(self, inner: QRectF, values: NDArray[np.float64]) -> list[QPointF]:
        x = inner.right() - self.ages_s / self.span_s * inner.width()
        y = inner.bottom() - np.clip(values, 0, 1) * inner.height()
        return [QPointF(*place) for place in zip(x.tolist(), y.tolist(), strict=True)]

    def _paint_text(self, painter: QPainter, box: QRectF) -> None:
        font = painter.font()
        font.setPixelSize(10)
        painter.setFont(font)
        for text, color, x in (("sure", POINT_COLOR, 6.0), ("worst part", TRACE_PARTS, 40.0)):
            painter.setPen(color)
            painter.drawText(QPointF(box.left() + x, box.top() + 12), text)


def thin_pen(color: QColor, width: float) -> QPen:
    """Return a pen whose width is in pixels of the screen."""
    pen = QPen(color, width)
    pen.setCosmetic(True)
    return pen
