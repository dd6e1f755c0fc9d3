"""Long work on a profile replaces only the profile that it began with."""

import hashlib
import threading
from pathlib import Path

from app.errors import AppError
from core.generations import HEADER_NAME

#: Held by whoever replaces, empties or deletes a profile, and writes what was made of one.
REPLACING = threading.RLock()


class ProfileChangedError(AppError):
    """A profile is not any more what a long work began with."""

    def __init__(self, folder: Path, what: str) -> None:
        self.folder, self.what = folder, what
        super().__init__(
            f"the profile {folder.name} was {what} while something was made from it, expected it "
            "to stay as it was: nothing was written; if its pictures are still there, try again"
        )


def edition(folder: Path) -> str:
    """Return what tells the trained content of a profile from any other, "" without one."""
    try:
        return hashlib.sha256((folder / HEADER_NAME).read_bytes()).hexdigest()
    except OSError:
        return ""


def check_edition(folder: Path, begun: str) -> None:
    """Check that a profile still has the content that a work began with; hold REPLACING.

    Args:
        folder: Of the profile.
        begun: Its `edition` then.

    Raises:
        ProfileChangedError: It was deleted, emptied or trained meanwhile.
    """
    if not folder.is_dir():
        raise ProfileChangedError(folder, "deleted")
    if edition(folder) != begun:
        raise ProfileChangedError(folder, "changed")
