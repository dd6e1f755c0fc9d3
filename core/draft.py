"""What the user has shot or corrected since the last training: kept at once, picture by picture.

    draft/NAME.npz    landmarks of a picture, the aligner's own ones, and how good the picture is
    draft/NAME.png    the picture, where the profile itself does not hold it
    draft/NAME.out    there while the picture is to be left out of the next training

A file is complete or not there, and a picture counts from the moment its .npz is there. So nothing
is lost when the program ends at any moment, and a damaged file costs one picture.
"""

import io
import json
import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from core.errors import ArrayShapeError
from core.generations import (
    DRAFT_NAME,
    ProfileUnwritableError,
    push_folder,
    reason_of,
    write_through,
)
from core.records import Landmarks2D

#: What changes with every writing of a file: time in ns, bytes, number on the disk.
Stamp = tuple[int, int, int]
_ARRAYS, _FRESH, _OUT = ".npz", ".new", ".out"


@dataclass(frozen=True, slots=True, eq=False)
class DraftPicture:
    """One picture of a draft.

    Attributes:
        landmarks: As they are now.
        automatic: As the aligner found them.
        picture_name: File of the picture in the draft, "" where the profile holds it.
        quality: JSON values about the picture, for people.
    """

    landmarks: Landmarks2D
    automatic: Landmarks2D
    picture_name: str = ""
    quality: Mapping[str, object] = field(default_factory=dict)


class Draft:
    """The draft of one profile folder. What is read or written is on the disk, nothing else."""

    def __init__(self, profile: Path) -> None:
        """Look at a profile's draft; nothing is made until something is put.

        Args:
            profile: The profile's folder, which need not be there.
        """
        self._profile, self._folder = profile, profile / DRAFT_NAME

    def names(self) -> list[str]:
        """Return the names of the pictures, in alphabetical order."""
        return sorted(path.stem for path in self._folder.glob(f"*{_ARRAYS}"))

    def get(self, name: str) -> DraftPicture | None:
        """Return a picture, None if there is none that can be read."""
        try:
            content = (self._folder / (name + _ARRAYS)).read_bytes()
            with np.load(io.BytesIO(content), allow_pickle=False) as stored:
                arrays = {key: stored[key] for key in stored.files}
            told = json.loads(str(arrays["told"]))
            picture = DraftPicture(
                _record("landmarks", arrays), _record("automatic", arrays),
                str(told["picture"]), dict(told["quality"]),
            )  # fmt: skip
        except (OSError, EOFError, KeyError, TypeError, ValueError, BadZipFile, ArrayShapeError):
            return None
        whole = not picture.picture_name or (self._folder / picture.picture_name).is_file()
        return picture if whole else None

    def content(self, picture: DraftPicture) -> bytes:
        """Return the encoded picture; one that the profile holds is empty."""
        if not picture.picture_name:
            return b""
        return (self._folder / picture.picture_name).read_bytes()

    def put(self, name: str, picture: DraftPicture, content: bytes | None = None) -> None:
        """Keep a picture, or what has changed of it.

        Args:
            name: File stem: the shot's name.
            picture: Its landmarks.
            content: The encoded picture; None leaves the file that is there.

        Raises:
            ProfileUnwritableError: The old state is kept.
        """
        told = json.dumps({"picture": picture.picture_name, "quality": dict(picture.quality)})
        arrays = {"told": np.array(told)}
        arrays |= _arrays("landmarks", picture.landmarks)
        arrays |= _arrays("automatic", picture.automatic)
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **arrays)
        try:
            if content is not None:
                self._replace(picture.picture_name, content)
            self._replace(name + _ARRAYS, buffer.getvalue())
        except OSError as error:
            raise ProfileUnwritableError(self._profile, reason_of(error)) from None

    def taken_out(self) -> list[str]:
        """Return the names of pictures that are to be left out, in alphabetical order."""
        return sorted(path.name.removesuffix(_OUT) for path in self._folder.glob(f"*{_OUT}"))

    def take_out(self, name: str, out: bool = True) -> None:
        """Say that a picture is to be left out of the next training, or not any more.

        Raises:
            ProfileUnwritableError: Nothing has changed.
        """
        try:
            if out:
                self._replace(name + _OUT, b"")
            else:
                (self._folder / (name + _OUT)).unlink(missing_ok=True)
        except OSError as error:
            raise ProfileUnwritableError(self._profile, reason_of(error)) from None

    def remove(self, name: str) -> None:
        """Drop a picture, if there is one."""
        kept = self.get(name)
        (self._folder / (name + _ARRAYS)).unlink(missing_ok=True)
        if kept is not None and kept.picture_name:
            (self._folder / kept.picture_name).unlink(missing_ok=True)

    def state(self) -> dict[str, Stamp]:
        """Return what tells whether a file has changed: its name -> time, size and number."""
        files = [path for end in (_ARRAYS, _OUT) for path in self._folder.glob(f"*{end}")]
        return self._stamps(path.name for path in files)

    def state_of(self, name: str) -> dict[str, Stamp]:
        """Return the part of the state that is about one picture."""
        return self._stamps(name + end for end in (_ARRAYS, _OUT))

    def clear(self, before: Mapping[str, Stamp] | None = None) -> None:
        """Drop everything: a new generation holds it.

        Args:
            before: The draft's state when what went into that generation was read. What has come
                or changed since then stays; None: nothing has.
        """
        for file, stamp in self.state().items():
            if before is None or before.get(file) == stamp:
                self._drop(file)

    def _stamps(self, files: Iterable[str]) -> dict[str, Stamp]:
        stamps = {}
        for file in files:
            # Another program may drop it at any moment.
            with suppress(OSError):
                found = (self._folder / file).stat()
                stamps[file] = (found.st_mtime_ns, found.st_size, found.st_ino)
        return stamps

    def _drop(self, file: str) -> None:
        if file.endswith(_OUT):
            (self._folder / file).unlink(missing_ok=True)
        else:
            self.remove(file.removesuffix(_ARRAYS))

    def _replace(self, name: str, content: bytes) -> None:
        """Write a file of the draft in one step."""
        path = self._folder / name
        fresh = self._folder / (name + _FRESH)
        try:
            write_through(fresh, content)
            os.replace(fresh, path)
            push_folder(self._folder)
        finally:
            fresh.unlink(missing_ok=True)


def _arrays(prefix: str, landmarks: Landmarks2D) -> dict[str, NDArray[Any]]:
    return {f"{prefix}.{one.name}": getattr(landmarks, one.name) for one in fields(landmarks)}


def _record(prefix: str, arrays: Mapping[str, NDArray[Any]]) -> Landmarks2D:
    return Landmarks2D(**{one.name: arrays[f"{prefix}.{one.name}"] for one in fields(Landmarks2D)})
