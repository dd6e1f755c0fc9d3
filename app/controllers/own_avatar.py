"""The user's own avatar in the live window: made from the profile's pictures, hair as chosen."""

from collections.abc import Callable, Generator
from pathlib import Path

from PySide6.QtCore import QObject, QTimer
from PySide6.QtGui import QAction, QActionGroup

from app.avatars.likeness.judge import Likeness
from app.controllers.live import LiveController
from app.errors import AppError
from app.own_looks import (
    HAIR_STYLES,
    LooksUnwritableError,
    choose_hair,
    chosen_hair,
    likeness_steps,
)
from app.painting import OWN
from app.priority import stepping_back
from app.replacing import ProfileChangedError
from app.resources import asset
from app.views.live_window import LiveWindow
from app.workers.job import Job
from core.errors import CoreError
from core.face_model import load_face_model
from core.records import Progress

#: The picture runs before anything is made beside it.
BEGINS_AFTER_MS = 2500
WORDS = {
    "": "&As in the pictures", "short": "&Short", "cropped": "&Cropped", "bob": "&Long",
    "bald": "&None",
}  # fmt: skip
MADE = "Your own avatar now has your own skin."
Maker = Callable[[Path], Generator[Progress, None, Likeness | None]]


def own_looks_in(folder: Path) -> Generator[Progress, None, Likeness | None]:
    """Make the looks of a profile's user unless they are there; return them or None."""
    model = load_face_model(asset("face_model.npz"))
    return (yield from stepping_back(likeness_steps(folder, model)))


class OwnAvatar(QObject):
    """Makes the own looks in the background, once for each profile, and shows them."""

    def __init__(
        self, controller: LiveController, window: LiveWindow, folder_of: Callable[[str], Path],
        make: Maker = own_looks_in,
    ) -> None:  # fmt: skip
        """Add the menu of hair and listen to the choice of profiles.

        Args:
            controller: Tells of profiles and shows avatars.
            window: Gets the menu.
            folder_of: Where the profile of a name is kept.
            make: Makes the looks of a profile's user, if they are not there.
        """
        super().__init__(controller)
        self._controller, self._window = controller, window
        self._folder_of, self._make = folder_of, make
        self._profile, self._worked = "", False
        self._job: Job | None = None
        self._wanted = False
        self.hair = window.menu("Avatar").addMenu("Your own &hair")
        self._group = QActionGroup(self)
        self._actions = {style: self._action(style) for style in HAIR_STYLES}
        self._begin_soon = QTimer(self, singleShot=True, interval=BEGINS_AFTER_MS)
        self._begin_soon.timeout.connect(self.begin)
        controller.profile_changed.connect(self._on_profile)
        # After a correction the same user is better known, and has another face for the files.
        controller.swapped.connect(self._begin_soon.start)
        controller.ending.connect(self.stop)
        self._on_profile("")

    def begin(self) -> None:
        """Make the looks of the profile's user now, or when what is under way is done."""
        self._wanted = self._job is not None
        if self._wanted or not self._profile:
            return
        self._worked = False
        self._job = Job(self._make(self._folder_of(self._profile)), self)
        self._job.progressed.connect(self._on_progressed)
        self._job.returned.connect(self._on_returned)
        self._job.failed.connect(self._on_failed)
        self._job.finished.connect(self._on_finished)
        self._job.start()

    def stop(self) -> None:
        """Make nothing more; wait for what is under way."""
        self._begin_soon.stop()
        self._wanted = False
        if self._job is not None:
            self._job.cancel()
            self._on_finished()

    def choose(self, style: str) -> None:
        """Let the own avatar of the profile wear other hair, one of HAIR_STYLES."""
        try:
            choose_hair(self._folder_of(self._profile), style)
        except LooksUnwritableError as error:
            self._window.message_bar.tell(str(error))
            self._check_chosen()
            return
        self._show_again()

    def _action(self, style: str) -> QAction:
        action = QAction(WORDS[style], self, checkable=True)
        action.triggered.connect(lambda: self.choose(style))
        self._group.addAction(action)
        self.hair.addAction(action)
        return action

    def _on_profile(self, profile: str) -> None:
        self._profile = profile
        self.hair.setEnabled(bool(profile))
        self._check_chosen()
        if profile:
            self._begin_soon.start()

    def _check_chosen(self) -> None:
        style = chosen_hair(self._folder_of(self._profile)) if self._profile else ""
        self._actions[style].setChecked(True)

    def _on_progressed(self) -> None:
        self._worked = True

    def _on_returned(self, made: Likeness | None) -> None:
        if not self._worked or made is None:
            return
        self._show_again()
        if made.skin is not None and self._controller.scene.avatar == OWN:
            self._window.message_bar.announce(MADE)

    def _on_failed(self, error: CoreError | AppError) -> None:
        # Who deletes a profile wants no looks of it, and one that was trained anew is begun anew.
        if not isinstance(error, ProfileChangedError):
            self._window.message_bar.tell(str(error))

    def _on_finished(self) -> None:
        if self._job is None or not self._job.isFinished():
            return
        self._job.wait()
        self._job.deleteLater()
        self._job = None
        if self._wanted:
            self.begin()

    def _show_again(self) -> None:
        if self._controller.scene.avatar == OWN:
            self._controller.scene.choose(OWN)
