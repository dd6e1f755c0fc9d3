"""What can be done to the points, as buttons; the keys stand in the tooltips."""

from collections.abc import Iterable

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QCheckBox,
    QFormLayout,
    QFrame,
    QGroupBox,
    QLabel,
    QScrollArea,
    QSlider,
    QStyle,
    QToolButton,
    QVBoxLayout,
    QWidget,
)


class SidePanel(QScrollArea):
    """The point in the hand, the actions, how the picture is shown."""

    look_changed = Signal(int, int)  # brightness and contrast, -100 to 100

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        # Where the window is low it is moved; the bar takes nothing from the buttons.
        bar = self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        self.setFixedWidth(236 + bar)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.point_label, self.picture_label = QLabel(), QLabel()
        for label in (self.picture_label, self.point_label):
            label.setWordWrap(True)
            label.setMinimumHeight(3 * self.fontMetrics().lineSpacing())
            label.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.picture_label.setAccessibleName("About the picture")
        self.point_label.setAccessibleName("About the points in the hand")
        self.model_box = QCheckBox("Fitted &model (V)")
        self.names_box = QCheckBox("&Names (N)")
        self.brightness, self.contrast = _slider("Brightness"), _slider("Contrast")
        inner = QWidget()
        self._layout = QVBoxLayout(inner)
        self._layout.setContentsMargins(8, 0, 0, 0)
        self._layout.addWidget(_grouped("Picture", [self.picture_label]))
        self._layout.addWidget(_grouped("In the hand", [self.point_label]))
        self._actions = _grouped("Points", [])
        self._layout.addWidget(self._actions)
        self._layout.addWidget(self._shown())
        self._layout.addStretch(1)
        self.setWidget(inner)

    def add_actions(self, actions: Iterable[QAction]) -> None:
        """Give every action a button."""
        for action in actions:
            button = QToolButton()
            button.setDefaultAction(action)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
            button.setSizePolicy(
                button.sizePolicy().Policy.Expanding, button.sizePolicy().verticalPolicy()
            )
            layout = self._actions.layout()
            if layout is not None:
                layout.addWidget(button)

    def _shown(self) -> QGroupBox:
        box = QGroupBox("Shown")
        form = QFormLayout(box)
        form.addRow(self.model_box)
        form.addRow(self.names_box)
        form.addRow("Brightness", self.brightness)
        form.addRow("Contrast", self.contrast)
        for slider in (self.brightness, self.contrast):
            slider.valueChanged.connect(self._on_look)
        return box

    def _on_look(self) -> None:
        self.look_changed.emit(self.brightness.value(), self.contrast.value())


def _slider(name: str) -> QSlider:
    slider = QSlider(Qt.Orientation.Horizontal)
    slider.setRange(-100, 100)
    slider.setPageStep(20)
    slider.setAccessibleName(name)
    slider.setToolTip(f"{name}; only how the picture is shown, not the picture")
    return slider


def _grouped(title: str, widgets: Iterable[QWidget]) -> QGroupBox:
    box = QGroupBox(title)
    layout = QVBoxLayout(box)
    layout.setSpacing(3)
    for widget in widgets:
        layout.addWidget(widget)
    return box
