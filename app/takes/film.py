"""The pictures of a take: a video whose frames are counted, and read again in any order.

The container is Matroska: what was written of it before a crash can still be read.
"""

import errno
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from app.capture.source import frame_from_bgr
from app.errors import AppError
from core.records import U8, Frame

#: The video's name in a take's folder.
FILM_NAME = "video.mkv"
#: What must stay free on the disk beside a video that is written anew.
SPARE_BYTES = 64 << 20
WRITE_ELSE = "OpenCV began none there, expected MPEG-4 in Matroska; record without video"
READ_ELSE = (
    "found none that OpenCV understands, expected MPEG-4 in Matroska; copy the take again from "
    "where it is whole. Its states are not affected: they can be exported as a table or arrays"
)


class FilmError(AppError):
    """A take's video cannot be written or read."""

    def __init__(self, path: Path, what: str, way_out: str) -> None:
        self.path = path
        super().__init__(f"cannot {what} the video {path}: {way_out}")


class FilmWriter:
    """Writes the frames of a take.

    Attributes:
        n_frames: Written so far.
    """

    def __init__(self, path: Path, fps: float, size_px: tuple[int, int]) -> None:
        """Begin a video.

        Raises:
            FilmError: It cannot be written.
        """
        self.n_frames = 0
        # MPEG-4 halves the colour planes, so both sides must be even.
        self._size_px = (size_px[0] // 2 * 2, size_px[1] // 2 * 2)
        code = cv2.VideoWriter.fourcc(*"mp4v")
        self._writer = cv2.VideoWriter(str(path), code, fps, self._size_px)
        if not self._writer.isOpened():
            raise FilmError(path, "write", WRITE_ELSE)

    def write(self, rgb: U8) -> int:
        """Add a picture (H, W, 3); return its number in the video."""
        width, height = self._size_px
        bgr = cv2.cvtColor(rgb[:height, :width], cv2.COLOR_RGB2BGR)
        self._writer.write(bgr)
        self.n_frames += 1
        return self.n_frames - 1

    def close(self) -> None:
        """Complete the video."""
        self._writer.release()


class FilmReader:
    """Reads the frames of a take in any order; to be used in one thread."""

    def __init__(self, path: Path) -> None:
        """Open a video.

        Raises:
            FilmError: It cannot be read.
        """
        self._capture = cv2.VideoCapture(str(path))
        if not self._capture.isOpened():
            raise FilmError(path, "read", READ_ELSE)
        self._next = 0
        self._last: tuple[int, U8] | None = None

    def picture(self, number: int) -> U8 | None:
        """Return a picture (H, W, 3) BGR, None where the video has none of this number."""
        if self._last is not None and self._last[0] == number:
            return self._last[1]
        if number != self._next and not self._capture.set(cv2.CAP_PROP_POS_FRAMES, number):
            return None
        found, bgr = self._capture.read()
        if not found:
            # What is read next is not known then.
            self._next = -1
            return None
        self._next = number + 1
        self._last = (number, np.asarray(bgr, np.uint8))
        return self._last[1]

    def frame(self, number: int, size_px: tuple[int, int], time_s: float, index: int) -> Frame:
        """Return a frame of the take; it is dark where there is no picture."""
        bgr = self.picture(number) if number >= 0 else None
        return blank(size_px, time_s, index) if bgr is None else (
            frame_from_bgr(bgr, size_px, time_s, index)
        )  # fmt: skip

    def close(self) -> None:
        """Give the file back."""
        self._capture.release()


def blank(size_px: tuple[int, int], time_s: float, index: int) -> Frame:
    """Return a dark frame of a size (width, height)."""
    gray = np.full((size_px[1], size_px[0]), 32, np.uint8)
    return Frame(np.repeat(gray[..., None], 3, axis=2), gray, time_s, index)


def mend(path: Path, sign: Callable[[], object] = lambda: None) -> int:
    """Write a video anew that was not completed; return how many frames it has.

    A video of which nothing can be read is removed. Else it is replaced only by one with as many
    frames: OpenCV does not tell of a full disk.

    Args:
        path: Of the video.
        sign: Called every now and then.

    Raises:
        OSError: The disk has no room; the video is as it was.
        FilmError: No video can be written there; the video is as it was.
    """
    capture = cv2.VideoCapture(str(path))
    try:
        found, bgr = capture.read() if capture.isOpened() else (False, None)
        if not found or bgr is None:
            capture.release()
            path.unlink(missing_ok=True)
            return 0
        _check_room(path)
        return _rewrite(path, capture, np.asarray(bgr, np.uint8), sign)
    finally:
        capture.release()


def _rewrite(path: Path, capture: cv2.VideoCapture, first: U8, sign: Callable[[], object]) -> int:
    """Write what a video gives into a new one in its place; return the number of frames."""
    fresh = path.with_name(f".mended{path.suffix}")
    fps = capture.get(cv2.CAP_PROP_FPS)
    try:
        writer = FilmWriter(fresh, fps if 1 <= fps <= 1000 else 30.0, first.shape[1::-1])
        found, bgr = True, first
        while found:
            writer.write(cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB))
            sign()
            found, read = capture.read()
            bgr = np.asarray(read, np.uint8) if found else bgr
        capture.release()
        writer.close()
        if _count(fresh, sign) < writer.n_frames:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        fresh.replace(path)
    finally:
        fresh.unlink(missing_ok=True)
    return writer.n_frames


def _check_room(path: Path) -> None:
    if shutil.disk_usage(path.parent).free < path.stat().st_size + SPARE_BYTES:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def _count(path: Path, sign: Callable[[], object]) -> int:
    """Return how many frames of a video can be read."""
    capture, number = cv2.VideoCapture(str(path)), 0
    while capture.grab():
        number += 1
        sign()
    capture.release()
    return number
