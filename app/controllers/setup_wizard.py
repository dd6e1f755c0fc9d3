"""The guided setup at work: which step may be visited, and what each needs."""

from collections.abc import Generator
from dataclasses import replace
from typing import Any, Protocol

from PySide6.QtCore import QObject, Signal

from app.controllers import camera_check, capture_tools, shelving
from app.controllers.camera_check import CameraController
from app.controllers.capturing import CaptureController
from app.controllers.editing import EditorController
from app.controllers.shelving import ShelfController
from app.controllers.training import TrainingController
from app.errors import AppError
from app.room import check_room
from app.setup_memory import SetupChoices
from app.views.editor.editor_window import EditorWindow
from app.views.notice import Notice
from app.views.setup.setup_window import STEPS, SetupWindow
from app.workbook import Workbook
from app.workers.job import Job
from core.errors import CoreError
from core.landmark_refit import Refitter
from core.pipeline import LEAST_PICTURES
from core.records import Progress

#: What the virtual performer plays in the live window, where nobody prompts.
LIVE_PERFORMER = "performer:mixed"
#: What to say of a profile without pictures.
DELETED = (
    "The pictures of {name} were deleted: there are no landmarks to look at. The trained model is "
    f"kept and follows your face. To improve it take at least {LEAST_PICTURES} new pictures; a "
    "training then uses these alone."
)

COPIED = (
    "{name} begins with all pictures of the profile that was copied. Add some as you look now: "
    "choose them above (with glasses, another light), or click a picture below to take it again; "
    "then train."
)


class Tools(capture_tools.Tools, camera_check.Tools, shelving.Tools, Protocol):
    """What is needed of the toolbox."""

    def choices(self) -> SetupChoices:
        """Return what the user chose the last time."""
        ...

    def keep_choices(self, choices: SetupChoices) -> None:
        """Remember what the user has chosen."""
        ...

    def open_book(self, name: str) -> Workbook:
        """Open the pictures of a profile, which need not be there."""
        ...

    def first_fit(self, book: Workbook) -> Generator[Progress, None, Refitter]:
        """Fit the face to a book's pictures."""
        ...

    def train(self, book: Workbook) -> Generator[Progress, None, object]:
        """Train a book's profile."""
        ...


class SetupController(QObject):
    """Joins the setup window with the controllers of its pages."""

    live_wanted = Signal(str)  # name of a profile

    def __init__(self, window: SetupWindow, tools: Tools, source: str = "") -> None:
        """Prepare a setup.

        Args:
            window: To show it in.
            tools: The rest of the program.
            source: Key of the source to shoot with; without it the first camera.
        """
        super().__init__(window)
        self._window, self._tools, self._source = window, tools, source
        self._book: Workbook | None = None
        self._step, self._camera_seen = "start", False
        self._choices = tools.choices()
        self._editor: EditorController | None = None
        self._job: Job | None = None
        self.shelving = ShelfController(window.start, tools, self._release, self)
        self.camera = CameraController(window.camera, tools, self)
        self.capturing = CaptureController(window.capture, tools, self)
        self.training = TrainingController(window.train, tools.train, self)
        self._connect()

    @property
    def step(self) -> str:
        """The step that is shown."""
        return self._step

    @property
    def editor(self) -> EditorController | None:
        """What is at work on the page of the landmarks."""
        return self._editor

    @property
    def source(self) -> str:
        """Key of the source that is used, as the live window calls it; "" without one."""
        source = self.capturing.source if self._step == "capture" else self._source
        prompted = source in {one.key for one in self._tools.performances()}
        return LIVE_PERFORMER if prompted else source or self._usual_camera()

    def start(self, name: str = "") -> None:
        """Show the first page, or go on with a profile."""
        self.shelving.show()
        self._window.show_step("start")
        self._unlock()
        if name:
            self._open(name)

    def stop(self) -> None:
        """End all work; everything that was shot or corrected is kept."""
        self._leave()
        self.training.stop()
        self._end_job()

    def show(self, step: str, picture: str = "") -> None:
        """Show a step that is unlocked.

        Args:
            step: A key of STEPS.
            picture: The picture to look at first, on the page of the landmarks.
        """
        if not self._unlocked()[step]:
            self._window.show_step(self._step)
            return
        self._leave()
        self._step = step
        self._window.show_step(step)
        if step == "start":
            self.shelving.show()
        elif self._book is not None:
            self._enter(self._book, picture)
        self._unlock()

    def add_pictures(self, key: str) -> None:
        """Ask for more pictures for the profile that is open: a set of core.extra_shots."""
        self.show("capture")
        if self._step == "capture":
            self.capturing.choose(key)

    # -- steps ---------------------------------------------------------------------------

    def _connect(self) -> None:
        window = self._window
        window.step_chosen.connect(self.show)
        window.next_button.clicked.connect(self._next)
        window.closing.connect(self.stop)
        window.start.chosen.connect(self._open)
        self.shelving.copied.connect(self._open_copy)
        self.shelving.failed.connect(window.message_bar.tell)
        self.camera.changed.connect(self._on_camera)
        self.capturing.changed.connect(self._unlock)
        self.capturing.troubled.connect(window.message_bar.tell)
        self.training.trained.connect(self._unlock)
        self.training.picture_wanted.connect(lambda name: self.show("check", name))
        self.training.live_wanted.connect(self._on_live)
        self.training.more_wanted.connect(self.add_pictures)

    def _open(self, name: str) -> None:
        try:
            book = self._tools.open_book(name)
            if not book.names and book.profile is None:
                check_room(book.folder)
            self._book = book
        except (CoreError, AppError, OSError) as error:
            self._window.message_bar.tell(str(error))
            return
        self._window.message_bar.tell(
            DELETED.format(name=name) if self._book.pictures_deleted else ""
        )
        self._window.setWindowTitle(f"{name} – setup – facepuppet")
        # Who goes on has chosen a camera before; new people are to see theirs first.
        self.show("capture" if self._book.names else "camera")

    def _open_copy(self, name: str) -> None:
        """Go on with a copy that was made for another look."""
        self._open(name)
        if not self._window.message_bar.text:
            self._window.message_bar.announce(COPIED.format(name=name))

    def _release(self, name: str) -> None:
        """End all work on a profile of which something is about to be deleted."""
        if self._book is not None and self._book.folder.name == name:
            self.training.stop()
            self._book = None
            self._window.setWindowTitle("Setup – facepuppet")
            self._unlock()

    def _enter(self, book: Workbook, picture: str) -> None:
        if self._step == "camera":
            self.camera.start(self._source or self._usual_camera(), self._choices.hold)
        elif self._step == "capture":
            self.capturing.start(book, self._source or self._usual_camera(), self._choices.sound)
        elif self._step == "check":
            self._fit(book, picture)
        elif self._step == "train":
            self.training.show(book)

    def _leave(self) -> None:
        """End what the step shown is doing, except a training."""
        if self._step == "camera":
            self._keep_camera()
            self.camera.stop()
        elif self._step == "capture":
            self.capturing.stop()
            self._source = self.capturing.source or self._source
            name = self._source_names().get(self._source, self._choices.camera)
            self._keep(sound=self.capturing.announcer.heard, camera=name)
        elif self._step == "check":
            self._end_job()
            if self._editor is not None:
                self._editor.stop()
            self._editor = None
            self._window.set_check_page(None)

    def _next(self) -> None:
        keys = list(STEPS)
        self.show(keys[keys.index(self._step) + 1])

    def _unlocked(self) -> dict[str, bool]:
        enough = self._book is not None and self._book.n_usable >= LEAST_PICTURES
        there = self._book is not None
        seen = self._camera_seen or bool(self._book is not None and self._book.names)
        return {
            "start": True, "camera": there, "capture": there and seen, "check": enough,
            "train": enough or (self._book is not None and self._book.profile is not None),
        }  # fmt: skip

    def _unlock(self) -> None:
        unlocked = self._unlocked()
        self._window.show_unlocked(unlocked)
        keys = list(STEPS)
        place = keys.index(self._step) + 1
        waits = self._step == "camera" and not self.camera.ready
        possible = place < len(keys) and unlocked[keys[place]] and not waits
        self._window.next_button.setEnabled(possible)

    def _on_live(self) -> None:
        if self._book is not None:
            self.live_wanted.emit(self._book.folder.name)

    # -- camera --------------------------------------------------------------------------

    def _usual_camera(self) -> str:
        """Return the key of the camera that was used the last time, if it is there."""
        same = [key for key, name in self._source_names().items() if name == self._choices.camera]
        return same[0] if same else ""

    def _source_names(self) -> dict[str, str]:
        known = [*self._tools.cameras(), *self._tools.performances()]
        return {one.key: one.text for one in known}

    def _on_camera(self) -> None:
        self._camera_seen = self._camera_seen or self.camera.ready
        self._unlock()

    def _keep_camera(self) -> None:
        """Go on with the camera that was chosen, and remember it."""
        self._source = self.camera.chosen or self._source
        name = self._source_names().get(self._source, self._choices.camera)
        self._keep(camera=name, hold=self.camera.hold_wanted)

    def _keep(self, **chosen: Any) -> None:
        choices = replace(self._choices, **chosen)
        if choices != self._choices:
            self._choices = choices
            self._tools.keep_choices(choices)

    # -- landmarks -----------------------------------------------------------------------

    def _fit(self, book: Workbook, picture: str) -> None:
        """Fit the face in the background, then show the editor."""
        notice = Notice()
        notice.say("Fitting a face to the pictures…")
        self._window.set_check_page(notice)
        self._job = Job(self._tools.first_fit(book), self)
        self._job.returned.connect(lambda refitter: self._show_editor(book, refitter, picture))
        self._job.failed.connect(lambda error: notice.say(str(error)))
        self._job.start()

    def _show_editor(self, book: Workbook, refitter: Refitter, picture: str) -> None:
        if self._step != "check":
            return
        editor = EditorWindow(book.folder.name)
        # Training has a page of its own here.
        editor.retrain_button.setVisible(False)
        editor.outdated_label.setVisible(False)
        self._window.set_check_page(editor)
        self._editor = EditorController(editor, book, lambda: refitter, self._tools.train)
        self._editor.start(picture)

    def _end_job(self) -> None:
        if self._job is not None:
            self._job.cancel()
            self._job.deleteLater()
            self._job = None
