"""What the capture page needs of the rest of the program: sources, and a tracker that judges."""

from collections.abc import Callable
from dataclasses import replace
from queue import SimpleQueue
from typing import Protocol

from app.capture.source import FrameSource
from app.controllers.announcing import Speaker
from app.controllers.player import Performer
from app.controllers.scene import Studio
from app.views.choice import Choice
from app.workers.latest import Latest
from core.capture_judge import CaptureJudge, Judgement, Taken
from core.free_live import FreeTracker
from core.ghost import Ghost, GhostHead
from core.records import U8, FaceState, FloatArray, Frame

#: Frames between two looks for other people.
LOOK_AROUND_EVERY = 15


class Tools(Studio, Protocol):
    """What is needed of the toolbox."""

    def cameras(self) -> list[Choice]:
        """Return the cameras of this machine."""
        ...

    def performances(self) -> list[Choice]:
        """Return what the virtual performer can play."""
        ...

    def open_source(self, key: str, began_again: Callable[[], None]) -> FrameSource:
        """Open a source."""
        ...

    def make_speaker(self) -> Speaker:
        """Return what plays sounds."""
        ...

    def prompt(self, name: str) -> None:
        """Let a performer who stands in for a camera know what is asked for."""
        ...

    def capture_tracker(self) -> tuple[FreeTracker, Callable[[U8], int]]:
        """Return a tracker, and what counts rival faces in a picture."""
        ...


class CaptureTracker:
    """Tracks, judges, and puts what was taken aside; works in the live thread."""

    def __init__(
        self, tracker: FreeTracker, rivals: Callable[[U8], int], judge: CaptureJudge
    ) -> None:
        self._tracker, self._count_rivals, self._judge = tracker, rivals, judge
        self.judged: Latest[Judgement] = Latest()
        self.taken: SimpleQueue[Taken] = SimpleQueue()
        self._frames, self._rivals = 0, 0
        self._ghosts = GhostHead(tracker.model)
        self._known: tuple[object, FloatArray] | None = None

    def step(self, frame: Frame) -> FaceState:
        """Return the face in a frame."""
        state = self._tracker.step(frame)
        if self._frames % LOOK_AROUND_EVERY == 0:
            self._rivals = self._count_rivals(frame.rgb)
        self._frames += 1
        judgement = self._judge.step(frame, state, self._tracker.looked, self._rivals)
        judgement = replace(judgement, ghost=self._ghost(judgement, state))
        self.judged.put(judgement)
        if judgement.taken is not None:
            self.taken.put(judgement.taken)
        return state

    def _ghost(self, judgement: Judgement, state: FaceState) -> Ghost | None:
        """Return how the head is to be held, as long as it is held otherwise."""
        shot, matched = self._judge.shot, judgement.match
        if shot is None or matched is None or matched.pose:
            return None
        if self._known is None or self._known[0] is not shot:
            # Asking for the face takes some milliseconds: once a prompt is enough.
            self._known = shot, self._tracker.user.neutral_mm
        facing = self._judge.facing_wxyz
        return self._ghosts.ghost(shot, self._known[1], facing, state, self._tracker.camera)

    def reset(self) -> None:
        """Forget the past, as after a cut."""
        self._tracker.reset()


class CaptureOpener:
    """Opens sources, each with a new tracker that judges; used in background threads."""

    def __init__(self, tools: Tools, judge: CaptureJudge) -> None:
        self._tools, self._judge = tools, judge
        self.tracker: CaptureTracker | None = None

    def open_source(self, key: str, began_again: Callable[[], None]) -> FrameSource:
        """Open a source."""
        return self._tools.open_source(key, began_again)

    def open_profile(self, key: str) -> Performer:
        """Make a tracker; pictures are taken of anybody."""
        return self.open_free()

    def open_free(self) -> Performer:
        """Make a tracker that judges, too."""
        tracker, rivals = self._tools.capture_tracker()
        self.tracker = CaptureTracker(tracker, rivals, self._judge)
        return Performer(self.tracker, None)
