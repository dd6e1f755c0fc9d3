"""Offers to add a few pictures where the light has changed for good since the setup."""

from collections.abc import Callable, Generator

from PySide6.QtCore import QObject, Qt, Signal

from app.controllers.live import LiveController
from app.errors import AppError
from app.priority import stepping_back
from app.profiles import load_setup_images, pictures_kept, profile_folder
from app.views.choice import Choice
from app.views.live_window import LiveWindow
from app.workers.job import Job
from core.errors import CoreError
from core.light_change import LightChange, LightReference, LightWatch, light_reference
from core.records import FaceState, Frame, Progress
from core.store import load

#: The set of more pictures that is offered.
SET = "light"
ADD = Choice("light.add", "Add a few pictures in this light", "Eight pictures, about a minute")
ADVICE = "With a few pictures in this light the avatar follows as well as before."
#: After the regressor was last seen to follow its person, other light may be why it does not; after
#: so long it may be somebody else.
OWN_S = 20.0

Reader = Callable[[str], Generator[Progress, None, LightReference | None]]


class LightOffer(QObject):
    """Watches the light in the live thread; speaks once for each profile and kind of change."""

    _changed = Signal(str, object)  # profile, LightChange

    def __init__(
        self, controller: LiveController, window: LiveWindow, read: Reader | None = None
    ) -> None:
        """Watch from the first profile on.

        Args:
            controller: Of the live view; parent of this.
            window: Shows the offer.
            read: Returns the light of a profile's setup pictures, None if it is not known.
        """
        super().__init__(controller)
        self._controller, self._window = controller, window
        self._read = read or read_light
        self._profile = ""
        self._watch: LightWatch | None = None
        self._own_s = -OWN_S
        self._told: set[tuple[str, str]] = set()
        self._job: Job | None = None
        self._reading, self._ending = "", False
        # It is emitted in the live thread.
        self._changed.connect(self._on_changed, Qt.ConnectionType.QueuedConnection)
        controller.profile_changed.connect(self._on_profile)
        controller.source_changed.connect(lambda _: self._begin_anew())
        controller.ending.connect(self._on_ending)
        controller.add_listener(self._look)
        window.message_bar.chosen.connect(self._on_chosen)

    # -- the profile's light -------------------------------------------------------------

    def _on_profile(self, profile: str) -> None:
        if profile == self._profile:
            self._begin_anew()
            return
        self._profile, self._watch = profile, None
        if self._job is None:
            self._read_next()

    def _read_next(self) -> None:
        if self._ending or not self._profile:
            return
        profile = self._reading = self._profile
        self._job = Job(stepping_back(self._read(profile)), self)
        self._job.returned.connect(lambda light: self._on_read(profile, light))
        self._job.finished.connect(self._on_finished)
        self._job.start()

    def _on_read(self, profile: str, light: LightReference | None) -> None:
        if profile == self._profile and light is not None:
            self._own_s = -OWN_S
            self._watch = LightWatch(light)

    def _on_finished(self) -> None:
        job = self._job
        if job is None or not job.isFinished():
            return
        job.wait()
        job.deleteLater()
        self._job = None
        if self._reading != self._profile:
            self._read_next()

    def _on_ending(self) -> None:
        self._ending = True
        self._controller.remove_listener(self._look)
        if self._job is not None:
            self._job.cancel()
            self._on_finished()

    def _begin_anew(self) -> None:
        """Forget what the source before showed."""
        self._own_s = -OWN_S
        if self._watch is not None:
            self._watch.reset()

    # -- in the live thread --------------------------------------------------------------

    def _look(self, frame: Frame, state: FaceState, driven: FaceState, delivered_s: float) -> None:
        """Compare a frame of the profile's person with the setup."""
        watch = self._watch
        if watch is None:
            return
        if state.mode == "trained" and not state.lost:
            self._own_s = frame.time_s
        if not 0 <= frame.time_s - self._own_s < OWN_S:
            return
        change = watch.step(frame, state)
        if change is not None and (self._profile, change.kind) not in self._told:
            self._told.add((self._profile, change.kind))
            self._changed.emit(self._profile, change)

    # -- the offer -----------------------------------------------------------------------

    def _on_changed(self, profile: str, change: LightChange) -> None:
        if profile == self._controller.wanted.profile:
            self._window.message_bar.offer(f"{change.reason} {ADVICE}", [ADD])

    def _on_chosen(self, key: str) -> None:
        if key == ADD.key and self._controller.wanted.profile:
            self._controller.add_pictures(SET)


def read_light(profile: str) -> Generator[Progress, None, LightReference | None]:
    """Return the light of a profile's setup pictures, None where it cannot be told."""
    yield Progress(0, 1, "Looking at the light of the setup")
    try:
        folder = profile_folder(profile)
        whole = load(folder)
        if not pictures_kept(folder):
            return None
        images = load_setup_images(folder, whole)
    except (CoreError, AppError):
        # The live view has told of a profile that cannot be read.
        return None
    return light_reference(images.images, whole.shapes, whole.camera)
