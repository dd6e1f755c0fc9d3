"""The guided setup as a window of its own beside the live one."""

from PySide6.QtCore import QObject, Signal

from app.controllers.setup_tools import SetupTools
from app.controllers.setup_wizard import SetupController
from app.views.setup.setup_window import SetupWindow


class GuidedSetup(QObject):
    """Shows the setup window; tells when it is closed, and for which profile to go live."""

    finished = Signal(str)  # name of a profile, or an empty text

    def __init__(self, source: str = "", parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.window = SetupWindow()
        self._controller = SetupController(self.window, SetupTools(), source)
        self._chosen, self._started = "", False
        self._controller.live_wanted.connect(self._on_live)
        self.window.closing.connect(lambda: self.finished.emit(self._chosen))

    def show(self) -> None:
        """Show the window, in front of all others."""
        self.window.show()
        self.window.raise_()
        self.window.activateWindow()
        if not self._started:
            self._started = True
            self._controller.start()

    def add_pictures(self, profile: str, key: str) -> None:
        """Show the window and ask for more pictures for a profile.

        Args:
            profile: Its name.
            key: A set of core.extra_shots: "light", "glasses" or "hand".
        """
        self.show()
        self._controller.start(profile)
        self._controller.add_pictures(key)

    def close(self) -> None:
        """Close it; everything taken is kept."""
        self.window.close()

    def _on_live(self, name: str) -> None:
        self._chosen = name
        self.window.close()
