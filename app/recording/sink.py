"""What every output of a track promises, and how a file appears all at once or not at all."""

import os
from pathlib import Path
from typing import Protocol

from app.errors import OutputError
from core.records import FaceState, Frame


class Sink(Protocol):
    """Takes solved frames one after the other."""

    def write(self, frame: Frame, state: FaceState) -> None:
        """Take the next frame."""
        ...

    def finish(self) -> None:
        """Complete the output; only now does its file appear or replace an older one."""
        ...

    def discard(self) -> None:
        """Leave everything as it was before."""
        ...


class PartialFile:
    """A file under a hidden name until it is complete.

    Attributes:
        path: Where to write.
    """

    def __init__(self, target: Path) -> None:
        """Claim the place.

        Raises:
            OutputError: Nothing can be written there.
        """
        self.target = target
        # The suffix stays: video writers choose the container by it.
        self.path = target.with_name(f".{target.stem}.part{target.suffix}")
        if target.is_dir():
            raise OutputError(target, "it is a folder, expected a file name")
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            self.path.write_bytes(b"")
        except OSError as error:
            raise OutputError(target, reason(error)) from None

    def finish(self) -> None:
        """Give the file its real name.

        Raises:
            OutputError: That failed; an older file of that name is unchanged.
        """
        try:
            os.replace(self.path, self.target)
        except OSError as error:
            self.discard()
            raise OutputError(self.target, reason(error)) from None

    def discard(self) -> None:
        """Remove what was written."""
        self.path.unlink(missing_ok=True)


def reason(error: OSError) -> str:
    """Return what the system says, without its numbers."""
    return (error.strerror or str(error)).lower()
