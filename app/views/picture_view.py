"""A picture, fitted into its widget, with points and a short remark over it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QBrush, QColor, QImage, QPainter, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.views.layers import LOST_COLOR, Layer

#: Pictures are judged best against a dark, neutral surround, in light and dark themes alike.
SURROUND_COLOR = QColor(32, 34, 37)
BLANK_COLOR = QColor(44, 47, 51)
BADGE_COLOR = QColor(20, 22, 24, 215)
#: The ground under what is transparent.
CHECK_PX, CHECK_COLORS = 10, (QColor(102, 106, 110), QColor(134, 138, 142))
EMPTY_TEXT_COLOR = QColor(214, 218, 222)


#: Channels -> as arrays have them, as Qt paints them best.
FORMATS = {
    3: (QImage.Format.Format_RGB888, QImage.Format.Format_RGB32),
    4: (
        QImage.Format.Format_RGBA8888_Premultiplied,
        QImage.Format.Format_ARGB32_Premultiplied,
    ),
}


def image_from_array(pixels: NDArray[np.uint8]) -> QImage:
    """Return a QImage that owns its pixels.

    Args:
        pixels: (H, W, 3) RGB or (H, W, 4) RGBA premultiplied by alpha, uint8.
    """
    pixels = np.ascontiguousarray(pixels)
    height, width, channels = pixels.shape
    given, painted = FORMATS[channels]
    image = QImage(pixels.data, width, height, channels * width, given)
    # Qt paints its own formats three times as fast; the conversion copies.
    return image.convertToFormat(painted)


def _chequered() -> QBrush:
    """Return the usual sign for nothing, neither light nor dark."""
    tile = QPixmap(2 * CHECK_PX, 2 * CHECK_PX)
    tile.fill(CHECK_COLORS[0])
    painter = QPainter(tile)
    for corner in (0, CHECK_PX):
        painter.fillRect(corner, corner, CHECK_PX, CHECK_PX, CHECK_COLORS[1])
    painter.end()
    return QBrush(tile)


def blank_image(width: int, height: int) -> QImage:
    """Return a picture that shows nothing."""
    image = QImage(width, height, QImage.Format.Format_RGB32)
    image.fill(BLANK_COLOR)
    return image


class PictureView(QWidget):
    """Draws what it was last shown."""

    def __init__(self, name: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(name)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(160, 120)
        self._image: QImage | None = None
        self._layers: tuple[Layer, ...] = ()
        self._badge = ""
        self._mirrored = False
        self._surround: QColor | None = SURROUND_COLOR
        self._checkered = False

    @property
    def layers(self) -> tuple[Layer, ...]:
        """What lies over the picture."""
        return self._layers

    @property
    def badge(self) -> str:
        """The remark over the picture, or an empty text."""
        return self._badge

    def sizeHint(self) -> QSize:
        """Return the size of a usual webcam picture."""
        return QSize(640, 480)

    def show_image(
        self, image: QImage | None, layers: Sequence[Layer] = (), badge: str = ""
    ) -> None:
        """Show a picture, or with None only the surround.

        Args:
            image: The picture.
            layers: What lies over it.
            badge: A short remark over its lower edge.
        """
        self._image, self._layers, self._badge = image, tuple(layers), badge
        self.update()

    def set_surround(self, color: QColor | None) -> None:
        """Fill what the picture leaves free with a colour, or with None leave it transparent."""
        self._surround = color
        self.update()

    def set_checkered(self, checkered: bool) -> None:
        """Show a chequered ground where the picture is transparent."""
        self._checkered = checkered
        self.update()

    def set_mirrored(self, mirrored: bool) -> None:
        """Show the picture like a mirror does."""
        self._mirrored = mirrored
        self.update()

    def picture_rect(self) -> QRectF:
        """Return where in the widget the picture lies."""
        if self._image is None:
            return QRectF(self.rect())
        scale = min(self.width() / self._image.width(), self.height() / self._image.height())
        width, height = self._image.width() * scale, self._image.height() * scale
        return QRectF((self.width() - width) / 2, (self.height() - height) / 2, width, height)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the picture, then what lies over it."""
        painter = QPainter(self)
        if self._surround is not None:
            painter.fillRect(self.rect(), self._surround)
        if self._image is not None:
            target = self.picture_rect()
            if self._checkered:
                painter.fillRect(target, _chequered())
            painter.save()
            self._paint_picture(painter, self._image, target)
            painter.restore()
            self._paint_in_front(painter, target)
            if self._badge:
                self._paint_badge(painter, target)
        painter.end()

    def _paint_picture(self, painter: QPainter, image: QImage, target: QRectF) -> None:
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.translate(target.topLeft())
        painter.scale(target.width() / image.width(), target.height() / image.height())
        if self._mirrored:
            painter.translate(image.width(), 0)
            painter.scale(-1, 1)
        painter.drawImage(QPointF(0, 0), image)
        area = QRectF(0, 0, image.width(), image.height())
        for layer in self._layers:
            if layer.over_picture:
                layer.paint(painter, area)

    def _paint_in_front(self, painter: QPainter, target: QRectF) -> None:
        for layer in self._layers:
            if not layer.over_picture:
                painter.save()
                layer.paint(painter, target)
                painter.restore()

    def _paint_badge(self, painter: QPainter, target: QRectF) -> None:
        metrics = painter.fontMetrics()
        width, height = metrics.horizontalAdvance(self._badge) + 28, metrics.height() + 12
        x = target.center().x() - width / 2
        box = QRectF(x, target.bottom() - height - 14, width, height)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(LOST_COLOR, 1.5))
        painter.setBrush(BADGE_COLOR)
        painter.drawRoundedRect(box, height / 2, height / 2)
        painter.setPen(EMPTY_TEXT_COLOR)
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self._badge)
