"""A slider that goes at once to where it is clicked."""

from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QSlider, QStyle, QStyleOptionSlider, QWidget

_SLIDER = QStyle.ComplexControl.CC_Slider


class SeekSlider(QSlider):
    """A horizontal slider; a click beside the handle takes the handle there, to be dragged on."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Bring the handle below the mouse before it is taken hold of."""
        option = QStyleOptionSlider()
        self.initStyleOption(option)
        handle = self._part(option, QStyle.SubControl.SC_SliderHandle)
        left = event.button() == Qt.MouseButton.LeftButton
        if left and not handle.contains(event.position().toPoint()):
            groove = self._part(option, QStyle.SubControl.SC_SliderGroove)
            way = round(event.position().x() - groove.x() - handle.width() / 2)
            span = groove.width() - handle.width()
            self.setValue(
                QStyle.sliderValueFromPosition(
                    self.minimum(), self.maximum(), way, span, option.upsideDown
                )
            )
        super().mousePressEvent(event)

    def _part(self, option: QStyleOptionSlider, part: QStyle.SubControl) -> QRect:
        return self.style().subControlRect(_SLIDER, option, part, self)
