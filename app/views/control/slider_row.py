"""A slider with its name and its value."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSlider, QWidget

#: Greatest span of values that is moved through in hundredths, and in tenths; else in ones.
_IN_HUNDREDTHS, _IN_TENTHS = 5.0, 60.0
_BACK = " Double-click or Delete: back to the usual value."


class _Slider(QSlider):
    """Goes back to the usual value with a double click or the Delete key."""

    reset_wanted = Signal()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Go back."""
        self.reset_wanted.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Go back with Delete, else move."""
        if event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self.reset_wanted.emit()
        else:
            super().keyPressEvent(event)


class SliderRow(QWidget):
    """Shows a number within limits and says which one the user chose."""

    changed = Signal(float)

    def __init__(
        self, text: str, low: float, high: float, usual: float, form: str = "{:.2f}",
        scale: float = 1.0,
    ) -> None:  # fmt: skip
        """Make a row.

        Args:
            text: Name, with & before its key.
            low: Least value.
            high: Greatest value.
            usual: Value to go back to.
            form: How the value is written.
            scale: By what it is multiplied for that.
        """
        super().__init__()
        self._low, self._high, self._usual, self._form = low, high, usual, form
        self._scale = scale
        self._step = _step(high - low)
        self._shown = -1
        name = text.replace("&", "")
        self.slider, self.value_label = _Slider(Qt.Orientation.Horizontal), QLabel()
        steps = self._position(high)
        self.slider.setRange(0, steps)
        self.slider.setPageStep(steps // 10)
        self.slider.setSingleStep(max(steps // 60, 1))
        self.slider.setAccessibleName(name)
        self.name_label = QLabel(text)
        self.name_label.setBuddy(self.slider)
        self.value_label.setMinimumWidth(self.fontMetrics().horizontalAdvance("8888 %"))
        self.value_label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.name_label)
        layout.addWidget(self.slider, stretch=1)
        layout.addWidget(self.value_label)
        self.slider.valueChanged.connect(self._on_moved)
        self.slider.reset_wanted.connect(lambda: self.slider.setValue(self._position(self._usual)))
        self.show_value(usual)

    def set_tip(self, tip: str) -> None:
        """Tell people what the number does."""
        self.setToolTip(tip + _BACK)
        self.slider.setAccessibleDescription(tip)

    def show_value(self, value: float) -> None:
        """Show a value; nothing is emitted."""
        self._shown = self._position(value)
        self.value_label.setText(self._told(value))
        self.slider.setValue(self._shown)

    def _told(self, value: float) -> str:
        return self._form.format(self._scale * value).replace("%", "\N{NO-BREAK SPACE}%")

    def _position(self, value: float) -> int:
        return round((value - self._low) / self._step)

    def _on_moved(self, position: int) -> None:
        # Only what the user moved: what is shown is known already.
        if position == self._shown:
            return
        self._shown = position
        value = min(round(self._low + position * self._step, 4), self._high)
        self.value_label.setText(self._told(value))
        self.changed.emit(value)


def _step(span: float) -> float:
    """Return by how much a slider of this span moves at least."""
    if span <= _IN_HUNDREDTHS:
        return 0.01
    return 0.1 if span <= _IN_TENTHS else 1.0
