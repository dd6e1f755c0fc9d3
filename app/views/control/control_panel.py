"""The control panel: presets above, pages for feel, coefficients and expression keys below."""

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QHideEvent, QKeySequence, QShortcut, QShowEvent
from PySide6.QtWidgets import QTabWidget, QVBoxLayout, QWidget

from app.views.control.feel_page import FeelPage
from app.views.control.keys_page import KeysPage
from app.views.control.preset_row import PresetRow
from app.views.control.response_page import ResponsePage
from core.drive_settings import DriveSettings


class ControlPanel(QWidget):
    """Shows settings of the drive; emits changed ones."""

    changed = Signal(object, str)  # DriveSettings, what was changed
    opened = Signal(bool)  # whether the panel is to be seen

    def __init__(self, faces: Mapping[str, Sequence[float]]) -> None:
        """Make the panel.

        Args:
            faces: For expression keys, (B,) each, by name.
        """
        super().__init__()
        self.presets, self.feel = PresetRow(), FeelPage()
        self.responses, self.keys = ResponsePage(), KeysPage(faces)
        self.tabs = QTabWidget()
        self.tabs.addTab(self.feel, "Feel")
        self.tabs.addTab(self.responses, "Coefficients")
        self.tabs.addTab(self.keys, "Expression keys")
        self.tabs.setDocumentMode(True)
        self.tabs.setAccessibleName("Pages of the control panel")
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addWidget(self.presets)
        layout.addWidget(self.tabs, stretch=1)
        self.setMinimumWidth(356)
        for page in (self.feel, self.responses, self.keys):
            page.changed.connect(self.changed)
        undo = QShortcut(QKeySequence.StandardKey.Undo, self, self.presets.undo_wanted.emit)
        undo.setContext(_WITHIN)

    def show_settings(self, settings: DriveSettings) -> None:
        """Show settings on all pages; nothing is emitted."""
        for page in (self.feel, self.responses, self.keys):
            page.show_settings(settings)

    def showEvent(self, event: QShowEvent) -> None:
        """Tell that the panel is seen."""
        super().showEvent(event)
        self.opened.emit(True)

    def hideEvent(self, event: QHideEvent) -> None:
        """Tell that it is not."""
        super().hideEvent(event)
        self.opened.emit(False)


_WITHIN = Qt.ShortcutContext.WidgetWithChildrenShortcut
