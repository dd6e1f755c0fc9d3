"""The page that checks the camera: which one, how good its picture is, what it is told to hold."""

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtGui import QFont
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QLabel, QVBoxLayout, QWidget

from app.views.setup.camera_list import CameraCard, CameraList
from app.views.setup.guide_view import GuideView

TITLE = "Choose your camera"
INSTRUCTION = (
    "Sit as you usually do, with light from the front. When all is well the camera is asked to "
    "keep exposure, focus and white balance as they are until the setup ends."
)


class CameraPage(QWidget):
    """Shows the cameras, and the chosen one large with one piece of advice."""

    camera_chosen = Signal(str)
    hold_wanted = Signal(bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.cameras, self.live = CameraList(), GuideView("Picture of the chosen camera")
        self.live.setMinimumSize(200, 150)
        self.verdict, self.held = QLabel(), QLabel()
        self.verdict.setAccessibleName("How good the picture is")
        self.held.setAccessibleName("What the camera holds")
        self.hold_box = QCheckBox("&Hold exposure, focus and white balance")
        self._build()
        self.cameras.chosen.connect(self.camera_chosen)
        self.hold_box.toggled.connect(self.hold_wanted)

    def show_cards(self, cards: Sequence[CameraCard], chosen: str) -> None:
        """List the cameras."""
        self.cameras.show_cards(cards, chosen)

    def show_verdict(self, text: str) -> None:
        """Say how good the picture is."""
        self.verdict.setText(text)

    def show_held(self, text: str) -> None:
        """Say what the camera holds."""
        self.held.setText(text)

    def show_hold(self, wanted: bool) -> None:
        """Show whether the camera is to be asked."""
        self.hold_box.blockSignals(True)
        self.hold_box.setChecked(wanted)
        self.hold_box.blockSignals(False)

    def _build(self) -> None:
        title, instruction = QLabel(TITLE), QLabel(INSTRUCTION)
        large = QFont(self.font())
        large.setPointSizeF(1.35 * large.pointSizeF())
        large.setBold(True)
        title.setFont(large)
        for label in (instruction, self.verdict, self.held):
            label.setWordWrap(True)
        bold = QFont(self.font())
        bold.setBold(True)
        self.verdict.setFont(bold)
        line = self.fontMetrics().lineSpacing()
        self.held.setMinimumHeight(2 * line)
        body = QHBoxLayout()
        body.addWidget(self.live, stretch=3)
        body.addWidget(self.cameras, stretch=2)
        foot = QHBoxLayout()
        foot.addWidget(self.hold_box)
        foot.addSpacing(line)
        foot.addWidget(self.held, stretch=1)
        layout = QVBoxLayout(self)
        layout.addWidget(title)
        layout.addWidget(instruction)
        layout.addLayout(body, stretch=1)
        layout.addWidget(self.verdict)
        layout.addLayout(foot)
