"""What happens to every frame in the live thread: solve, drive, hand on.

    frame -> tracker.step -> solved -> Drive.step -> driven -> listeners, avatar

All of it must stay well below a millisecond beside the tracker.
"""

from collections.abc import Callable
from dataclasses import replace

from app.capture.source import FrameSource
from app.controllers.player import FaceTracker, Opener, Performer
from core.drive import Drive
from core.records import Camera, FaceState, Frame

#: Called in the live thread: frame, solved state, driven state, when the frame was delivered on
#: the clock of time.perf_counter.
Listener = Callable[[Frame, FaceState, FaceState, float], None]


class SwappedTracker:
    """A tracker that can be replaced between two frames, from any thread."""

    def __init__(self, tracker: FaceTracker) -> None:
        self.tracker = tracker

    @property
    def camera(self) -> Camera | None:
        """The camera that the tracker assumes, None where it tells none."""
        camera: Camera | None = getattr(self.tracker, "camera", None)
        return camera

    def step(self, frame: Frame) -> FaceState:
        """Return the face in a frame, by the tracker of this moment."""
        return self.tracker.step(frame)

    def reset(self) -> None:
        """Let the tracker forget the past."""
        self.tracker.reset()


class SwappingOpener:
    """Opens what another opener does, with trackers that can be replaced."""

    def __init__(self, opener: Opener) -> None:
        self._opener = opener

    def open_source(self, key: str, began_again: Callable[[], None]) -> FrameSource:
        """Open a source."""
        return self._opener.open_source(key, began_again)

    def open_profile(self, key: str) -> Performer:
        """Load a profile and make its tracker."""
        return swappable(self._opener.open_profile(key))

    def open_free(self) -> Performer:
        """Make a tracker that needs no profile."""
        return swappable(self._opener.open_free())


def swappable(performer: Performer) -> Performer:
    """Return the performer with a tracker that can be replaced."""
    return replace(performer, tracker=SwappedTracker(performer.tracker))


class LiveChain:
    """Drives what was solved and tells all who listen; `solved` runs in the live thread."""

    def __init__(self, drive: Drive, first: Listener) -> None:
        """Prepare to hand states on.

        Args:
            drive: From the solved face to what the avatar does.
            first: Told before all others, that is the avatar: its picture shall not wait.
        """
        self.drive = drive
        # Replaced as a whole, so that the live thread always iterates over one that stays.
        self._listeners: tuple[Listener, ...] = ()
        self._first = first

    def add(self, listener: Listener) -> None:
        """Tell somebody of every frame from the next one on; from any thread."""
        self._listeners = (*self._listeners, listener)

    def remove(self, listener: Listener) -> None:
        """Tell somebody no more; a frame under way may still come."""
        self._listeners = tuple(one for one in self._listeners if one != listener)

    def solved(self, frame: Frame, state: FaceState, delivered_s: float) -> FaceState:
        """Return what the avatar makes of a state, after everybody was told."""
        driven = self.drive.step(state)
        self._first(frame, state, driven, delivered_s)
        for listener in self._listeners:
            listener(frame, state, driven, delivered_s)
        return driven
