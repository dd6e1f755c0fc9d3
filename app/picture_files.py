"""Picture files that users choose as background."""

from pathlib import Path

import cv2
import numpy as np

from app.errors import AppError
from core.records import U8

#: Larger pictures are made smaller: no avatar's picture shows more.
_MOST_PX = 1920
#: What file dialogs offer.
SUFFIXES = (".png", ".jpg", ".jpeg", ".webp", ".bmp", ".tif", ".tiff")


class PictureFileError(AppError):
    """A file cannot be used as a picture."""

    def __init__(self, path: str, found: str) -> None:
        self.path, self.found = path, found
        super().__init__(
            f"{path or 'no file'}: {found}, expected a picture; choose one of "
            f"{', '.join(suffix[1:] for suffix in SUFFIXES)}"
        )


def load_picture(path: str) -> U8:
    """Return the picture of a file, (H, W, 3) uint8, at most as large as a screen.

    Raises:
        PictureFileError: There is none.
    """
    if not path:
        raise PictureFileError(path, "nothing was chosen")
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise PictureFileError(path, error.strerror or str(error)) from error
    data = np.frombuffer(content, np.uint8)
    try:
        picture = cv2.imdecode(data, cv2.IMREAD_COLOR) if len(data) else None
    except cv2.error:
        # OpenCV refuses headers that promise absurd sizes.
        picture = None
    if picture is None:
        raise PictureFileError(path, "the file is empty" if not content else "no picture inside")
    factor = _MOST_PX / max(picture.shape[:2])
    if factor < 1:
        picture = cv2.resize(picture, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB), np.uint8)


class PictureShelf:
    """Keeps the picture that was last asked for; a bad file leaves the one before in place."""

    def __init__(self) -> None:
        self._key: tuple[str, int] = ("", 0)
        self._picture: U8 | None = None

    def get(self, path: str) -> U8 | None:
        """Return the picture of a file, the one before if there is none, None without any.

        A file that has changed is read again.
        """
        key = (path, _changed_ns(path))
        if key != self._key:
            self._key = key
            try:
                self._picture = load_picture(path)
            except PictureFileError:
                # Whoever chose the file was told when it was chosen.
                return self._picture
        return self._picture


def _changed_ns(path: str) -> int:
    """Return when a file was changed, 0 if that cannot be known."""
    try:
        return Path(path).stat().st_mtime_ns
    except (OSError, ValueError):
        return 0
