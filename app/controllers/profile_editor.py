"""The landmark editor as a window of its own beside the live one."""

from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.controllers.editing import EditorController
from app.errors import PicturesDeletedError
from app.models import load_aligner
from app.priority import taking_turns
from app.resources import asset
from app.views.editor.editor_window import EditorWindow
from app.workbook import Workbook
from app.workers.job import Job
from core.face_model import FaceModel, load_face_model
from core.generations import HEADER_NAME, ProfileMissingError
from core.landmark_refit import Refitter
from core.records import U8, Landmarks2D, Progress


@dataclass(frozen=True, slots=True, eq=False)
class OpenedBook:
    """What the editor shows, read from the disk.

    Attributes:
        folder: Of the profile.
        book: Its pictures and landmarks.
        model: The face model.
    """

    folder: Path
    book: Workbook
    model: FaceModel


def open_book(folder: Path) -> OpenedBook:
    """Read what the editor of a profile needs, which takes a while.

    Raises:
        CoreError: The profile cannot be read.
        PicturesDeletedError: It has nothing to look at.
    """

    def find(rgb: U8) -> Landmarks2D | None:
        found = load_aligner().first(rgb)
        return None if found is None else found.landmarks

    model = load_face_model(asset("face_model.npz"))
    book = Workbook(folder, find)
    if book.pictures_deleted and not book.names:
        raise PicturesDeletedError(folder.name)
    return OpenedBook(folder, book, model)


def make_editor(opened: OpenedBook) -> tuple[EditorWindow, EditorController]:
    """Return the window and the controller of a profile's editor."""
    folder, book, model = opened.folder, opened.book, opened.model

    def train(book: Workbook) -> Generator[Progress, None, object]:
        profile = yield from taking_turns(book.train(model, np.random.default_rng(0)))
        return f"Trained again; {len(profile.names)} pictures are in use."

    def refitter() -> Refitter:
        if book.profile is None:
            raise ProfileMissingError(folder)
        return Refitter(model, book.profile.user, book.profile.camera)

    window = EditorWindow(folder.name)
    return window, EditorController(window, book, refitter, train)


class ProfileEditor(QObject):
    """Reads the profile in the background, then shows the editor; tells when that is closed."""

    finished = Signal(bool)  # whether the profile was trained anew meanwhile
    failed = Signal(object)  # CoreError or AppError: it cannot be shown

    def __init__(self, folder: Path, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._folder = folder
        self.window: EditorWindow | None = None
        self._controller: EditorController | None = None
        self._before = self._stamp()
        self._job = Job(_steps(folder), self)
        self._job.returned.connect(self._on_opened)
        self._job.failed.connect(self.failed)
        self._job.start()

    def show(self) -> None:
        """Show the window, in front of all others, if it is there yet."""
        if self.window is not None:
            self.window.show()
            self.window.raise_()
            self.window.activateWindow()

    def close(self) -> None:
        """Close it; every change is kept already."""
        self._job.cancel()
        if self.window is not None:
            self.window.close()

    def _on_opened(self, opened: OpenedBook) -> None:
        self.window, self._controller = make_editor(opened)
        self.window.closing.connect(self._on_closing)
        self._controller.start()
        self.show()

    def _on_closing(self) -> None:
        self.finished.emit(self._stamp() != self._before)

    def _stamp(self) -> int:
        """Return what changes when the profile is trained anew."""
        header = self._folder / HEADER_NAME
        return header.stat().st_mtime_ns if header.exists() else 0


def _steps(folder: Path) -> Generator[Progress, None, OpenedBook]:
    yield Progress(0, 1, "Opening the pictures")
    return open_book(folder)
