"""The guided setup, in a window: `facepuppet setup` without a source."""

import signal
import sys
from typing import Any

from app.commands.display import has_display
from app.errors import NoDisplayError


def show_setup(profile: str, source: str = "") -> int:
    """Show the guided setup until its window is closed; return the exit code.

    Args:
        profile: Name of a profile to go on with, or an empty text.
        source: Key of the source to shoot with; without it the first camera.

    Raises:
        NoDisplayError: No window can be shown.
    """
    if not has_display():
        raise NoDisplayError("the guided setup")
    from PySide6.QtWidgets import QApplication

    application = QApplication(sys.argv[:1])
    application.setApplicationName("facepuppet")
    window, controller = open_setup(source)
    shown = [window]
    controller.live_wanted.connect(
        lambda name: shown.append(go_live(shown.pop(), name, controller.source))
    )
    window.show()
    controller.start(profile)
    before = signal.signal(signal.SIGINT, lambda *_: application.closeAllWindows())
    try:
        return int(application.exec())
    finally:
        signal.signal(signal.SIGINT, before)


def go_live(setup_window: Any, profile: str, source: str = "") -> Any:
    """Show the live window with a profile and a source in place of the setup's; return it."""
    from app.controllers.desk import open_desk
    from app.controllers.toolbox import Toolbox

    window, controller = open_desk(Toolbox())
    window.show()
    setup_window.close()
    controller.start()
    if source:
        window.source_chosen.emit(source)
    window.profile_chosen.emit(profile)
    return window


def open_setup(source: str = "") -> tuple[Any, Any]:
    """Return the window and the controller of the guided setup."""
    from app.controllers.setup_tools import SetupTools
    from app.controllers.setup_wizard import SetupController
    from app.views.setup.setup_window import SetupWindow

    window = SetupWindow()
    return window, SetupController(window, SetupTools(), source)
