"""The menu Help."""

from importlib.metadata import PackageNotFoundError, version

from app.views.help_dialogs import about_dialog, keys_dialog
from app.views.live_window import MENUS, LiveWindow


def attach_help(window: LiveWindow) -> None:
    """Let the entries of the menu Help open their dialogs."""

    def show_keys() -> None:
        keys_dialog([window.menu(name) for name in MENUS], window).open()

    window.deeds["keys"].triggered.connect(show_keys)
    window.deeds["about"].triggered.connect(lambda: about_dialog(own_version(), window).open())


def own_version() -> str:
    """Return the version of this program, empty where it runs without being installed."""
    try:
        return version("facepuppet")
    except PackageNotFoundError:
        return ""
