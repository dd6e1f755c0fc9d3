"""What the guided setup needs of the rest of the program, in one place."""

from collections.abc import Callable, Generator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtWidgets import QApplication

from app.capture.choose import camera_number
from app.capture.holding import Held
from app.capture.patient import PatientCamera
from app.capture.source import FrameSource
from app.capture.webcam import CameraEntry, WebcamSource
from app.controllers.toolbox import Toolbox
from app.first_fit import first_fit
from app.models import Looking, free_tracker, load_aligner
from app.performer.prompted import PromptedPerformer
from app.priority import taking_turns
from app.profiles import data_folder, profile_folder
from app.setup_memory import SetupChoices, load_choices, save_choices
from app.setup_steps import rivals
from app.shelf import Shelf
from app.sounds import Speaker
from app.views.choice import Choice
from app.workbook import Workbook
from core.free_live import FreeTracker
from core.landmark_refit import Refitter
from core.records import U8, Landmarks2D, Progress

#: Key of the performer who follows the prompts.
PROMPTED = "performer:prompted"


class SetupTools(Toolbox):
    """A toolbox for the guided setup, too."""

    def __init__(self, stride: int = 0) -> None:
        """Prepare.

        Args:
            stride: Of the performer's frames, see PromptedPerformer; 0 is by the clock.
        """
        super().__init__()
        self._stride = stride
        self._performer: PromptedPerformer | None = None
        self._prompt = ""
        self._held: dict[str, tuple[Held, ...]] = {}

    def performances(self) -> list[Choice]:
        """Return the performers that can stand in for a camera."""
        return [Choice(PROMPTED, "Virtual performer", "A synthetic person follows the prompts")]

    def open_source(self, key: str, began_again: Callable[[], None]) -> FrameSource:
        """Open a source; called in a background thread."""
        number = camera_number(key)
        if number is not None:
            return PatientCamera(number, open_camera=partial(self._open_held, key))
        if key != PROMPTED:
            return super().open_source(key, began_again)
        performer = PromptedPerformer(stride=self._stride)
        if self._prompt:
            performer.follow(self._prompt)
        self._performer = performer
        return performer

    def open_preview(self, key: str) -> FrameSource:
        """Open a source; one that is lost later tells so. Called in a background thread."""
        number = camera_number(key)
        if number is not None:
            return WebcamSource(number)
        return self.open_source(key, lambda: None)

    def keep_held(self, key: str, held: Sequence[Held]) -> None:
        """Hold a camera so whenever it is opened again for the setup."""
        self._held[key] = tuple(held)

    def _open_held(self, key: str, entry: CameraEntry) -> FrameSource:
        return WebcamSource(entry.index, cameras=[entry], held=self._held.get(key, ()))

    def choices(self) -> SetupChoices:
        """Return what the user chose the last time."""
        return load_choices(_choices_path())

    def keep_choices(self, choices: SetupChoices) -> None:
        """Remember what the user has chosen."""
        save_choices(_choices_path(), choices)

    def make_speaker(self) -> Speaker:
        """Return what plays sounds."""
        return Speaker(QApplication.beep)

    def prompt(self, name: str) -> None:
        """Let a performer who stands in for a camera know what is asked for."""
        self._prompt = name
        if self._performer is not None:
            self._performer.follow(name)

    def capture_tracker(self) -> tuple[FreeTracker, Callable[[U8], int]]:
        """Return a tracker, and what counts rival faces in a picture."""
        models = self.models()
        tracker = free_tracker(models, looking=Looking("every"))
        return tracker, lambda rgb: rivals(models.aligner.detect(rgb))

    def shelf(self) -> Shelf:
        """Return the user's profiles."""
        return Shelf(data_folder() / "profiles")

    def open_book(self, name: str) -> Workbook:
        """Open the pictures of a profile, which need not be there.

        Raises:
            CoreError, AppError: It cannot be read, or the name cannot be one.
        """

        def find(rgb: U8) -> Landmarks2D | None:
            found = load_aligner().first(rgb)
            return None if found is None else found.landmarks

        return Workbook(profile_folder(name), find)

    def first_fit(self, book: Workbook) -> Generator[Progress, None, Refitter]:
        """Fit the face to a book's pictures."""
        model = self.models().face_model
        camera, user = yield from first_fit(model, book)
        return Refitter(model, user, camera)

    def train(self, book: Workbook) -> Generator[Progress, None, object]:
        """Train a book's profile."""
        steps = book.train(self.models().face_model, np.random.default_rng(1))
        profile = yield from taking_turns(steps)
        return f"Trained with {len(profile.names)} pictures."


def _choices_path() -> Path:
    return data_folder() / "settings" / "setup.json"
