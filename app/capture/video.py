"""A video file as a source of frames."""

from pathlib import Path

import cv2

from app.capture.source import ClosedOnExit, frame_from_bgr
from app.errors import SourceMissingError, SourceUnreadableError
from core.records import U8, Frame

#: For files that do not say how fast they are.
USUAL_FPS = 30.0
#: Share of the promised frames that must come for a file to count as whole.
WHOLE_SHARE = 0.9
#: Frames that are gone through rather than jumped over.
GRABBED_AT_MOST = 20


class VideoSource(ClosedOnExit):
    """Plays a video file as fast as it is read.

    Attributes:
        n_frames: Number of frames the file claims to hold, 0 if it does not say.
    """

    live = False
    skips = True

    def __init__(self, path: Path) -> None:
        """Open a file and decode its first frame, whose size is the size of all.

        Raises:
            SourceMissingError: There is no such file.
            SourceUnreadableError: It is empty, damaged or no video.
        """
        self.name = path.name
        self._index = 0
        self._capture = _open(path)
        self._next: U8 | None = self._decode()
        if self._next is None:
            self.close()
            raise SourceUnreadableError(path, "a video without a single frame", "frames")
        self.size_px: tuple[int, int] = (self._next.shape[1], self._next.shape[0])
        fps = self._capture.get(cv2.CAP_PROP_FPS)
        self.fps = float(fps) if 1 <= fps <= 1000 else USUAL_FPS
        self._time_s = -1 / self.fps
        self.n_frames = max(int(self._capture.get(cv2.CAP_PROP_FRAME_COUNT)), 0)

    def read(self) -> Frame | None:
        """Return the next frame, None after the last one."""
        picture = self._next
        if picture is None:
            return None
        frame = frame_from_bgr(picture, self.size_px, self._frame_time_s(), self._index)
        self._time_s = frame.time_s
        self._index += 1
        self._next = self._decode()
        return frame

    def seek(self, index: int) -> None:
        """Let the next frame be the one of this number, or None if there is none."""
        ahead = index - self._index
        if ahead == 0:
            return
        # A short way forwards is decoded: a jump goes back to a key frame first.
        if self._next is None or not 0 < ahead <= GRABBED_AT_MOST:
            self._capture.set(cv2.CAP_PROP_POS_FRAMES, index)
        else:
            for _ in range(ahead - 1):
                self._capture.grab()
        self._index, self._time_s = index, (index - 1) / self.fps
        self._next = self._decode()

    def close(self) -> None:
        """Give the file back."""
        self._capture.release()
        self._next = None

    def cut_short(self) -> bool:
        """Return whether the file ended well before the number of frames it promised."""
        return self._next is None and self._index < WHOLE_SHARE * self.n_frames

    def _decode(self) -> U8 | None:
        found, picture = self._capture.read()
        self._stamp_s = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000
        return picture if found else None

    def _frame_time_s(self) -> float:
        """Return the file's own time stamp, or the frame's turn where the stamps do not rise."""
        return self._stamp_s if self._stamp_s > self._time_s else self._time_s + 1 / self.fps


def _open(path: Path) -> cv2.VideoCapture:
    expected = "a video (mp4, avi, mkv, mov or webm)"
    if not path.exists():
        raise SourceMissingError(path)
    if path.stat().st_size == 0:
        raise SourceUnreadableError(path, "an empty file (0 bytes)", expected)
    capture = cv2.VideoCapture(str(path))
    if not capture.isOpened():
        capture.release()
        found = f"{path.stat().st_size} bytes that are no video, or a damaged one"
        raise SourceUnreadableError(path, found, expected)
    return capture
