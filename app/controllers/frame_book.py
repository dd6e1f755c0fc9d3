"""One frame with its landmarks, in the form in which the landmark editor wants pictures."""

from pathlib import Path

from app.workbook import Workbook
from core.landmark_edit import points_of
from core.records import U8, FloatArray, Landmarks2D
from core.setup_plan import standard_for

#: What the frame is called while it is corrected.
FRAME = "this frame"


class FrameBook(Workbook):
    """Keeps one frame in memory; nothing of it is on the disk."""

    def __init__(self, rgb: U8, found: Landmarks2D) -> None:
        """Take a frame.

        Args:
            rgb: (H, W, 3).
            found: Where the tracker had the landmarks.
        """
        # Not that of the parent, which reads a profile from the disk.
        self.folder, self.profile, self.pictures_deleted = Path(), None, False
        self._images, self._landmarks = {FRAME: rgb}, {FRAME: found}
        self._out, self._found = set(), found

    @property
    def outdated(self) -> bool:
        """Whether anything was moved."""
        return bool((points_of(self._landmarks[FRAME]) != points_of(self._found)).any())

    @property
    def now(self) -> Landmarks2D:
        """The landmarks as they are now."""
        return self._landmarks[FRAME]

    @property
    def found(self) -> Landmarks2D:
        """The landmarks as the tracker had them."""
        return self._found

    def standard(self, name: str) -> FloatArray:
        """Return NaN: nobody asked for what the frame shows."""
        return standard_for(name)

    def quality(self, name: str) -> dict[str, object]:
        """Return that nothing is known."""
        return {}

    def automatic(self, name: str) -> Landmarks2D:
        """Return the landmarks as the tracker had them."""
        return self._found

    def correct(self, name: str, landmarks: Landmarks2D) -> None:
        """Take new landmarks."""
        self._landmarks[name] = landmarks
