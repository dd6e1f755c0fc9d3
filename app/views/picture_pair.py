"""The two pictures side by side."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QSplitter, QWidget

from app.views.pane import Pane


class PicturePair(QSplitter):
    """Webcam and avatar; they may change sides, and one of them may be hidden."""

    shown = Signal(str, bool)  # "source" or "avatar", whether it is shown now

    def __init__(self, source: Pane, avatar: Pane, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self._panes = {"source": source, "avatar": avatar}
        self.setChildrenCollapsible(False)
        self.addWidget(source)
        self.addWidget(avatar)
        self.setSizes([600, 600])

    @property
    def swapped(self) -> bool:
        """Whether the avatar is on the left."""
        return self.widget(0) is self._panes["avatar"]

    def swap(self) -> None:
        """Let both change sides; each side keeps its width."""
        sizes = self.sizes()
        first = "source" if self.swapped else "avatar"
        self.insertWidget(0, self._panes[first])
        self.setSizes(sizes)

    def shows(self, name: str) -> bool:
        """Return whether "source" or "avatar" is shown."""
        return not self._panes[name].isHidden()

    def show_pane(self, name: str, wanted: bool) -> None:
        """Show or hide "source" or "avatar"; instead of the last one hidden the other comes."""
        other = "avatar" if name == "source" else "source"
        self._set_shown(name, wanted)
        if not wanted and not self.shows(other):
            self._set_shown(other, True)

    def _set_shown(self, name: str, wanted: bool) -> None:
        if self.shows(name) != wanted:
            self._panes[name].setVisible(wanted)
            self.shown.emit(name, wanted)
