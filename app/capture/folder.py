"""A folder of pictures, as a source of frames and as the setup images of a profile."""

import re
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from app.capture.source import ClosedOnExit, frame_from_bgr
from app.errors import (
    ImageSizesError,
    NoImagesError,
    SourceMissingError,
    SourceUnreadableError,
)
from core.records import U8, Frame

SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".webp", ".tif", ".tiff")


class FolderSource(ClosedOnExit):
    """Shows the pictures of a folder in the order of their names."""

    live = False
    skips = True

    def __init__(self, path: Path, fps: float = 30.0) -> None:
        """List the pictures and decode the first, whose size is the size of all.

        Raises:
            SourceMissingError: There is no such folder.
            NoImagesError: It holds no pictures.
            SourceUnreadableError: The first picture is damaged.
        """
        self.name, self.fps = path.name, fps
        self._files, self._index = image_files(path), 0
        first = read_bgr(self._files[0])
        self.size_px: tuple[int, int] = (first.shape[1], first.shape[0])
        self.n_frames = len(self._files)

    def read(self) -> Frame | None:
        """Return the next frame, None after the last one.

        Raises:
            SourceUnreadableError: The picture is damaged.
        """
        if self._index >= len(self._files):
            return None
        index, self._index = self._index, self._index + 1
        return frame_from_bgr(read_bgr(self._files[index]), self.size_px, index / self.fps, index)

    def seek(self, index: int) -> None:
        """Let the next frame be the one of this number."""
        self._index = index

    def close(self) -> None:
        """Show nothing more."""
        self._index = len(self._files)


def image_files(folder: Path) -> tuple[Path, ...]:
    """Return the picture files of a folder; shot2 comes before shot10.

    Raises:
        SourceMissingError: There is no such folder.
        NoImagesError: It holds no pictures.
    """
    if not folder.is_dir():
        raise SourceMissingError(folder)
    files = [path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES]
    files = [path for path in files if path.is_file() and not path.name.startswith(".")]
    if not files:
        raise NoImagesError(folder, SUFFIXES)
    return tuple(sorted(files, key=_natural_key))


def read_bgr(path: Path) -> U8:
    """Return one picture as OpenCV decodes it, (H, W, 3) BGR, turned as its camera noted.

    Raises:
        SourceUnreadableError: The file is empty, damaged or no picture.
    """
    # Not cv2.imread: on Windows it cannot open a path with letters outside the code page.
    encoded = np.frombuffer(path.read_bytes(), np.uint8)
    if encoded.size == 0:
        raise SourceUnreadableError(path, "an empty file (0 bytes)", "a picture")
    picture = cv2.imdecode(encoded, cv2.IMREAD_COLOR)
    if picture is None:
        found = f"{encoded.size} bytes that are no picture, or a damaged one"
        raise SourceUnreadableError(path, found, "a picture")
    return np.asarray(picture, np.uint8)


def setup_pictures(folder: Path) -> tuple[tuple[U8, ...], tuple[str, ...]]:
    """Return all pictures (H, W, 3) RGB of a folder and their file stems.

    Raises:
        SourceMissingError, NoImagesError, SourceUnreadableError: As for a FolderSource.
        ImageSizesError: They are not all of one size.
    """
    files = image_files(folder)
    pictures = [np.asarray(cv2.cvtColor(read_bgr(path), cv2.COLOR_BGR2RGB)) for path in files]
    _check_sizes(files, pictures)
    return tuple(pictures), tuple(path.stem for path in files)


def _check_sizes(files: Sequence[Path], pictures: Sequence[U8]) -> None:
    size = pictures[0].shape[1::-1]
    for path, picture in zip(files, pictures, strict=True):
        if picture.shape[1::-1] != size:
            raise ImageSizesError(files[0].name, size, path.name, picture.shape[1::-1])


def _natural_key(path: Path) -> list[tuple[int, str]]:
    """Return a sort key in which numbers count as numbers."""
    parts = re.split(r"(\d+)", path.stem.lower())
    return [(int(part), "") if part.isdigit() else (-1, part) for part in parts] + [(0, path.name)]
