"""`facepuppet edit PROFILE`: look at the setup pictures and put landmarks right."""

import argparse
import signal
import sys
from collections.abc import Generator
from pathlib import Path
from typing import Any

import numpy as np

from app.commands.display import has_display
from app.errors import NoDisplayError, PicturesDeletedError
from app.profiles import profile_folder
from core.records import U8, Landmarks2D, Progress

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
    from app.controllers.editing import EditorController
    from app.models import load_aligner
    from app.resources import asset
    from app.views.editor.editor_window import EditorWindow
    from app.workbook import Workbook
    from core.face_model import load_face_model
    from core.generations import ProfileMissingError
    from core.landmark_refit import Refitter

    model = load_face_model(asset("face_model.npz"))

    def find(rgb: U8) -> Landmarks2D | None:
        found = load_aligner().first(rgb)
        return None if found is None else found.landmarks

    book = Workbook(folder, find)
    if book.pictures_deleted and not book.names:
        raise PicturesDeletedError(folder.name)

    def train(book: Workbook) -> Generator[Progress, None, object]:
        profile = yield from book.train(model, np.random.default_rng(0))
        return f"Trained again; {len(profile.names)} pictures are in use."

    def refitter() -> Refitter:
        if book.profile is None:
            raise ProfileMissingError(folder)
        return Refitter(model, book.profile.user, book.profile.camera)

    window = EditorWindow(folder.name)
    return window, EditorController(window, book, refitter, train)
