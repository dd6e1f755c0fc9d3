"""A slider with its value beside it."""

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSlider, QWidget

#: Numbers of all sliders of a panel end in one line.
WIDEST = "-180 %"


class _WheelLeaver(QObject):
    """Lets the wheel scroll what is around a control that is not being used."""

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Keep the wheel from a control without the keyboard."""
        idle = isinstance(watched, QWidget) and not watched.hasFocus()
        if event.type() == QEvent.Type.Wheel and idle:
            event.ignore()
            return True
        return False


def leave_wheel(control: QWidget) -> None:
    """Let the wheel change a control only after a click on it: panels are scrolled."""
    control.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    control.installEventFilter(_WheelLeaver(control))


class LabelledSlider(QWidget):
    """Shows a whole number; says when the user moves it."""

    moved = Signal(int)

    def __init__(self, name: str, least: int, greatest: int, unit: str) -> None:
        """Make the slider.

        Args:
            name: For people who hear the screen.
            least: At its left end.
            greatest: At its right end.
            unit: Written after the number.
        """
        super().__init__()
        self._shown, self._unit = least, unit
        self.slider, self._label = QSlider(Qt.Orientation.Horizontal), QLabel()
        leave_wheel(self.slider)
        self.slider.setRange(least, greatest)
        self.slider.setAccessibleName(name)
        self.slider.setSingleStep(max(1, (greatest - least) // 100))
        self.slider.setPageStep(max(1, (greatest - least) // 10))
        self._label.setMinimumWidth(self.fontMetrics().horizontalAdvance(WIDEST))
        self._label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.slider, stretch=1)
        layout.addWidget(self._label)
        self.setFocusProxy(self.slider)
        self.slider.valueChanged.connect(self._on_changed)
        self._label.setText(f"{least}{unit}")

    @property
    def value(self) -> int:
        """What is shown."""
        return self._shown

    def show_value(self, value: int) -> None:
        """Show a number; emits nothing."""
        self._shown = min(max(value, self.slider.minimum()), self.slider.maximum())
        self._label.setText(f"{self._shown}{self._unit}")
        self.slider.setValue(self._shown)

    def _on_changed(self, value: int) -> None:
        # What was shown is no wish.
        if value != self._shown:
            self._shown = value
            self._label.setText(f"{value}{self._unit}")
            self.moved.emit(value)
