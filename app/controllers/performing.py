"""Who is tracked and how: replaced while the live view goes on."""

from dataclasses import replace

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.controllers.acquainting import Acquainting
from app.controllers.live_chain import SwappedTracker
from app.controllers.overlays import Overlays
from app.controllers.player import Opened, Opener, Performer
from app.controllers.profile_switch import ProfileSwitch
from app.controllers.scene import AvatarScene
from app.errors import AppError
from core.drive import Drive
from core.errors import CoreError
from core.records import UserBlendshapes

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


class Performing(QObject):
    """Puts performers in place, and tells avatar, drive and overlays whose head it is.

    Attributes:
        unusable: Whether the wanted profile could not be loaded, so that it goes on without one.
    """

    changed = Signal()  # another performer is in place
    failed = Signal(object)  # CoreError or AppError: why a profile cannot be used

    def __init__(
        self,
        opener: Opener,
        drive: Drive,
        scene: AvatarScene,
        overlays: Overlays,
        parent: QObject | None = None,
    ) -> None:
        """Prepare to put performers in place.

        Args:
            opener: Loads profiles, in a background thread.
            drive: Is told how the head is usually held.
            scene: Is told who plays.
            overlays: Draw the user's face.
            parent: Of the object.
        """
        super().__init__(parent)
        self._drive, self._scene, self._overlays = drive, scene, overlays
        self._switch, self._acquainting = ProfileSwitch(opener, self), Acquainting(self)
        self._tracker: SwappedTracker | None = None
        self._stranger: Performer | None = None
        self.unusable = False
        self._switch.loaded.connect(lambda _, performer: self.swap(performer))
        self._switch.failed.connect(self._on_failed)
        self._acquainting.known.connect(self._on_acquainted)

    @property
    def plays(self) -> bool:
        """Whether a source is played, so that performers can be replaced."""
        return self._tracker is not None

    def begin(self, opened: Opened) -> None:
        """Let an opened source's performer begin."""
        tracker = opened.performer.tracker
        self._tracker = tracker if isinstance(tracker, SwappedTracker) else None
        self.unusable = opened.trouble is not None
        self._drive.reset()
        self._scene.enter(opened.performer.user, opened.performer.folder)
        self._meet(opened.performer)

    def forget(self) -> None:
        """Let nobody perform."""
        self._stranger, self._tracker, self.unusable = None, None, False
        self._switch.forget()
        self._overlays.use(None, None)
        self._scene.leave()

    def lend(self) -> None:
        """Let others say whose head the avatar has, until the next `begin`."""
        self._stranger, self._tracker = None, None
        self._switch.forget()

    def load(self, profile: str) -> None:
        """Put a profile's performer in place, as soon as it is loaded; empty: none's."""
        self.unusable = False
        self._switch.load(profile)

    def swap(self, performer: Performer) -> None:
        """Put a performer in place between two frames."""
        if self._tracker is None:
            return
        self._tracker.tracker = performer.tracker
        self._scene.become(performer.user, performer.folder)
        self._meet(performer)
        self.changed.emit()

    def look_around(self) -> None:
        """Ask who is seen without a profile; to be called now and then."""
        self._acquainting.ask(self._stranger)

    def stop(self) -> None:
        """End the background work and wait for that."""
        self._switch.stop()
        self._acquainting.stop()

    def _meet(self, performer: Performer) -> None:
        """Take over what is known of a head; of a stranger's it comes with time."""
        self._stranger = performer if performer.user is None else None
        self._overlays.use(performer, performer.user)
        self._drive.know_levels(performer.levels)
        # The avatar's view takes off the same: nothing of somebody who is not known.
        usual = UPRIGHT if performer.user is None else performer.user.rest_wxyz
        self._drive.know_usual_rotation(usual)

    def _on_acquainted(self, performer: Performer, user: UserBlendshapes) -> None:
        """Give the avatar the head of who was seen without a profile, now that it is known."""
        if performer is self._stranger:
            self._meet(replace(performer, user=user))
            self._scene.become(user)

    def _on_failed(self, profile: str, error: CoreError | AppError) -> None:
        """Go on without a profile."""
        self.failed.emit(error)
        self._switch.load("")
        self.unusable = True
