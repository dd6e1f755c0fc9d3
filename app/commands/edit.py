"""`facepuppet edit PROFILE`: look at the setup pictures and put landmarks right."""

import argparse
import signal
import sys
from pathlib import Path
from typing import Any

from app.commands.display import has_display
from app.errors import NoDisplayError
from app.profiles import profile_folder

DESCRIPTION = "Look at the pictures of a profile, put wrong landmarks right, and train again."


def add_parser(commands: Any) -> None:
    """Add the command and its options."""
    parser = commands.add_parser("edit", help=DESCRIPTION, description=DESCRIPTION)
    parser.add_argument("profile", metavar="PROFILE", help="name or path of a profile")
    parser.add_argument("--picture", metavar="NAME", default="", help="show this picture first")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Show the editor until it is closed; return the exit code."""
    folder = profile_folder(args.profile)
    if not has_display():
        raise NoDisplayError("the landmark editor")
    from PySide6.QtWidgets import QApplication

    application = QApplication(sys.argv[:1])
    application.setApplicationName("facepuppet")
    window, controller = open_editor(folder)
    window.show()
    controller.start(args.picture)
    before = signal.signal(signal.SIGINT, lambda *_: window.close())
    try:
        return int(application.exec())
    finally:
        signal.signal(signal.SIGINT, before)


def open_editor(folder: Path) -> tuple[Any, Any]:
    """Return the window and the controller of a profile's editor.

    Raises:
        CoreError: The profile cannot be read.
        PicturesDeletedError: It has nothing to look at.
    """
    # Qt is not loaded for the other commands.
    from app.controllers.profile_editor import make_editor, open_book

    return make_editor(open_book(folder))
