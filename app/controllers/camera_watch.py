"""Looks at the pictures of the chosen camera."""

from collections.abc import Callable
from threading import Lock

from app.controllers import capture_tools
from core.capture_judge import CaptureJudge, Judgement
from core.free_live import FreeTracker
from core.records import U8, Frame


class Examiner:
    """Judges the frames of one camera after the other; works in the threads that read them."""

    def __init__(self, make_tracker: Callable[[], tuple[FreeTracker, Callable[[U8], int]]]) -> None:
        self._make_tracker = make_tracker
        # The networks are for one thread; two cameras overlap when another one is chosen.
        self._lock = Lock()
        self._tracker: capture_tools.CaptureTracker | None = None
        self._of: object = None

    def look(self, camera: object, frame: Frame) -> Judgement | None:
        """Judge a frame; with the first one of another camera everything before is forgotten."""
        with self._lock:
            if self._tracker is None or self._of != camera:
                tracker, rivals = self._make_tracker()
                self._tracker = capture_tools.CaptureTracker(tracker, rivals, CaptureJudge())
                self._of = camera
            self._tracker.step(frame)
            return self._tracker.judged.take()
