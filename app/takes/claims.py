"""Which unfinished takes are being worked on, so that nobody takes them for what a crash left."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock

from app.takes.library import HEADER

_LOCK = Lock()
#: Folders that this process writes, however long a step of that takes.
_CLAIMED: set[Path] = set()


def claim(part: Path) -> bool:
    """Call a folder one's own until `release`; False if somebody here has done so already."""
    with _LOCK:
        free = part not in _CLAIMED
        _CLAIMED.add(part)
    return free


def release(part: Path) -> None:
    """Leave a folder to others."""
    with _LOCK:
        _CLAIMED.discard(part)


def claimed(part: Path) -> bool:
    """Return whether this process works on a folder."""
    with _LOCK:
        return part in _CLAIMED


@contextmanager
def claiming(part: Path) -> Iterator[bool]:
    """Own a folder for a while; gives False, and owns nothing, if somebody here owns it."""
    own = claim(part)
    try:
        yield own
    finally:
        if own:
            release(part)


def show_life(part: Path) -> None:
    """Let other programs see that this take is being worked on."""
    with suppress(OSError):
        (part / HEADER).touch()
