"""Where a picture lies in a widget that can be zoomed and panned."""

from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, QSizeF
from PySide6.QtGui import QTransform

#: Widget pixels per picture pixel.
SMALLEST, LARGEST = 0.05, 60.0
#: At least so many widget pixels of the picture stay in sight.
IN_SIGHT = 60.0


@dataclass(frozen=True, slots=True)
class Zoom:
    """A scale, and where the picture's corner is.

    Attributes:
        scale: Widget pixels per picture pixel.
        x: Of the picture's left edge in the widget.
        y: Of its upper edge.
    """

    scale: float = 1.0
    x: float = 0.0
    y: float = 0.0

    def transform(self) -> QTransform:
        """Return the map from picture to widget; a pixel's centre has whole coordinates + 0.5."""
        return QTransform(self.scale, 0, 0, self.scale, self.x, self.y)

    def to_widget(self, x_px: float, y_px: float) -> QPointF:
        """Return where a point of the picture is in the widget."""
        return QPointF(self.x + self.scale * (x_px + 0.5), self.y + self.scale * (y_px + 0.5))

    def to_picture(self, place: QPointF) -> QPointF:
        """Return which point of the picture is at a place of the widget."""
        return QPointF(
            (place.x() - self.x) / self.scale - 0.5, (place.y() - self.y) / self.scale - 0.5
        )

    def scaled(self, factor: float, place: QPointF) -> "Zoom":
        """Return a zoom in which what is at a place of the widget stays there."""
        scale = min(max(self.scale * factor, SMALLEST), LARGEST)
        ratio = scale / self.scale
        return Zoom(
            scale,
            place.x() - ratio * (place.x() - self.x),
            place.y() - ratio * (place.y() - self.y),
        )

    def panned(self, shift: QPointF, picture: QSizeF, widget: QSizeF) -> "Zoom":
        """Return the zoom after a shift that leaves some of the picture in sight."""
        width, height = self.scale * picture.width(), self.scale * picture.height()
        x = min(max(self.x + shift.x(), IN_SIGHT - width), widget.width() - IN_SIGHT)
        y = min(max(self.y + shift.y(), IN_SIGHT - height), widget.height() - IN_SIGHT)
        return Zoom(self.scale, x, y)


def fitted(area: QRectF, widget: QSizeF) -> Zoom:
    """Return the zoom that shows an area of the picture as large as the widget allows."""
    scale = min(widget.width() / max(area.width(), 1), widget.height() / max(area.height(), 1))
    scale = min(max(scale, SMALLEST), LARGEST)
    center = area.center()
    return Zoom(
        scale, widget.width() / 2 - scale * center.x(), widget.height() / 2 - scale * center.y()
    )
