"""One half of the live window: a picture, or a notice in its place."""

from collections.abc import Sequence

from PySide6.QtCore import QSize, Signal
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QStackedLayout, QWidget

from app.views.choice import Choice
from app.views.layers import Layer
from app.views.notice import Notice
from app.views.picture_view import PictureView


class Pane(QWidget):
    """Shows the newest picture, or says why there is none."""

    chosen = Signal(str)  # a key of the notice's choices

    def __init__(self, name: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(name)
        self.picture, self.notice = PictureView(name), Notice()
        self.notice.chosen.connect(self.chosen)
        self._layout = QStackedLayout(self)
        self._layout.addWidget(self.notice)
        self._layout.addWidget(self.picture)

    @property
    def has_picture(self) -> bool:
        """Whether a picture is shown."""
        return self._layout.currentWidget() is self.picture

    def sizeHint(self) -> QSize:
        """Return the size of a usual webcam picture."""
        return self.picture.sizeHint()

    def show_picture(self, image: QImage, layers: Sequence[Layer] = (), badge: str = "") -> None:
        """Show a picture, what lies over it, and a short remark."""
        self.picture.show_image(image, layers, badge)
        self._layout.setCurrentWidget(self.picture)

    def say(self, text: str, choices: Sequence[Choice] = ()) -> None:
        """Drop the picture and say something instead."""
        self.picture.show_image(None)
        self.notice.say(text, choices)
        self._layout.setCurrentWidget(self.notice)
