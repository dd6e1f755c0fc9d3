"""A folder whose content is replaced as a whole: the old state or the new one, never a mixture.

    profile.json     names the current generation, with the size and SHA-256 of each of its files
    data-0002/       the current generation
    data-0001/       an older one on its way out, or a newer one that was never finished

A new generation is written completely and pushed to the disk; only then is profile.json replaced,
in one step, and the older generations deleted. Whatever stops the program on the way, profile.json
names a complete generation.
"""

import hashlib
import json
import os
import shutil
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from core.errors import CoreError

HEADER_NAME = "profile.json"
#: The folder of pictures and corrections that no generation holds yet; see core.draft.
DRAFT_NAME = "draft"
FORMAT = "facepuppet profile"
#: Raised when an older program would misread what this one writes.
SCHEMA = 1


class ProfileMissingError(CoreError):
    """There is no profile here."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        super().__init__(
            f"found no profile in {folder}, expected a file {HEADER_NAME} there: check the name, "
            "or make the profile by the guided setup (Face > Set up my face in the window, "
            "facepuppet setup on the command line)"
        )


class ProfileNewerError(CoreError):
    """The profile was written by a newer program."""

    def __init__(self, folder: Path, found: int) -> None:
        self.folder, self.found, self.known = folder, found, SCHEMA
        super().__init__(
            f"the profile {folder} has schema version {found}, this program knows versions up to "
            f"{SCHEMA}: update facepuppet, or make the profile anew under another name"
        )


class ProfileDamagedError(CoreError):
    """A file of the profile is missing or not what was written."""

    def __init__(self, path: Path, found: str, expected: str) -> None:
        self.path, self.found, self.expected = path, found, expected
        super().__init__(
            f"the profile is damaged: {path} is {found}, expected {expected}; copy the profile "
            "again from where it is whole, or make it anew under another name"
        )


class ProfileUnwritableError(CoreError):
    """The profile cannot be written here."""

    def __init__(self, folder: Path, reason: str) -> None:
        self.folder, self.reason = folder, reason
        super().__init__(
            f"cannot write the profile {folder}: {reason}; what was there is unchanged. Choose "
            "another folder, or make this one writable with enough free space"
        )


@dataclass(frozen=True, slots=True)
class Generation:
    """The current content of a folder.

    Attributes:
        header: What was stored beside the files.
        folder: Where the files are.
        files: Name -> size in bytes and SHA-256.
    """

    header: dict[str, Any]
    folder: Path
    files: dict[str, tuple[int, str]]

    def read(self, name: str) -> bytes:
        """Return the content of a file.

        Raises:
            ProfileDamagedError: It is missing or differs from what was written.
        """
        path = self.folder / name
        if name not in self.files:
            raise ProfileDamagedError(path, "not listed", f"listed in {HEADER_NAME}")
        size, digest = self.files[name]
        try:
            content = path.read_bytes()
        except OSError as error:
            raise ProfileDamagedError(path, reason_of(error), f"a file of {size} bytes") from None
        if len(content) != size:
            raise ProfileDamagedError(path, f"{len(content)} bytes long", f"{size} bytes")
        if hashlib.sha256(content).hexdigest() != digest:
            raise ProfileDamagedError(path, "changed since it was written", f"SHA-256 {digest}")
        return content


def check_target(folder: Path) -> None:
    """Check, before any long work, that a generation can be written to a folder; make the folder.

    Raises:
        ProfileNewerError: A newer program's profile is there.
        ProfileUnwritableError: The folder holds other things, or cannot be written.
    """
    if (folder / HEADER_NAME).exists():
        _read_header(folder)
    elif folder.is_dir() and any(not _is_ours(path) for path in folder.iterdir()):
        raise ProfileUnwritableError(folder, "the folder holds other files and no profile")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        trial = folder / "data-trial"
        trial.mkdir()
        trial.rmdir()
    except OSError as error:
        raise ProfileUnwritableError(folder, reason_of(error)) from None


def write_generation(
    folder: Path, header: Mapping[str, object], files: Mapping[str, bytes]
) -> None:
    """Replace the content of a folder.

    Args:
        folder: Made if it is not there.
        header: JSON values to keep beside the files.
        files: Name, with "/" between folders -> content.

    Raises:
        ProfileNewerError, ProfileUnwritableError: Nothing was changed.
    """
    check_target(folder)
    current = folder / f"data-{_last_number(folder) + 1:04d}"
    try:
        current.mkdir()
        for name, content in files.items():
            write_through(current / PurePosixPath(name), content)
        for path in {current, *(entry for entry in current.rglob("*") if entry.is_dir())}:
            push_folder(path)
        _replace_header(folder, current.name, header, files)
    except BaseException as error:
        # An interrupt may come after the replacement: then the new state stands.
        if _current_name(folder) != current.name:
            shutil.rmtree(current, ignore_errors=True)
        if isinstance(error, OSError):
            raise ProfileUnwritableError(folder, reason_of(error)) from None
        raise
    with suppress(OSError):
        push_folder(folder)
    for path in folder.glob("data-*"):
        if path != current:
            shutil.rmtree(path, ignore_errors=True)


def read_generation(folder: Path) -> Generation:
    """Return the current content of a folder; its files are read and checked on demand.

    Raises:
        ProfileMissingError: There is none.
        ProfileNewerError: A newer program wrote it.
        ProfileDamagedError: Its header cannot be read.
    """
    header = _read_header(folder)
    try:
        files = {
            str(name): (int(entry["bytes"]), str(entry["sha256"]))
            for name, entry in header["files"].items()
        }
        return Generation(dict(header["header"]), folder / str(header["data"]), files)
    except (KeyError, TypeError, ValueError, AttributeError):
        path = folder / HEADER_NAME
        raise ProfileDamagedError(path, "incomplete", f"a {FORMAT} header") from None


def _read_header(folder: Path) -> dict[str, Any]:
    path = folder / HEADER_NAME
    if not path.is_file():
        raise ProfileMissingError(folder)
    try:
        header = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise ProfileDamagedError(path, "damaged or cut short", f"a {FORMAT} header") from None
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise ProfileDamagedError(path, "something else", f'JSON with "format": "{FORMAT}"')
    schema = header.get("schema")
    if not isinstance(schema, int):
        raise ProfileDamagedError(path, f"of schema {schema!r}", f"a number up to {SCHEMA}")
    if schema > SCHEMA:
        raise ProfileNewerError(folder, schema)
    return header


def _replace_header(
    folder: Path, data: str, header: Mapping[str, object], files: Mapping[str, bytes]
) -> None:
    listed = {
        name: {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
        for name, content in files.items()
    }
    whole = {
        "format": FORMAT, "schema": SCHEMA, "data": data, "header": dict(header), "files": listed,
    }  # fmt: skip
    fresh = folder / (HEADER_NAME + ".new")
    try:
        write_through(fresh, json.dumps(whole, indent=1, allow_nan=False).encode())
        os.replace(fresh, folder / HEADER_NAME)
    finally:
        fresh.unlink(missing_ok=True)


def write_through(path: Path, content: bytes) -> None:
    """Write a file and wait until the disk has it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def push_folder(folder: Path) -> None:
    """Wait until the disk has the names in a folder; Windows does that without being asked."""
    if os.name == "posix":
        handle = os.open(folder, os.O_RDONLY)
        try:
            # Some network file systems cannot; they are no worse off than without.
            with suppress(OSError):
                os.fsync(handle)
        finally:
            os.close(handle)


def _current_name(folder: Path) -> str | None:
    try:
        return str(_read_header(folder).get("data"))
    except CoreError:
        return None


def _last_number(folder: Path) -> int:
    names = [path.name.removeprefix("data-") for path in folder.glob("data-*")]
    return max((int(name) for name in names if name.isdigit()), default=0)


def _is_ours(path: Path) -> bool:
    ours = (HEADER_NAME + ".new", DRAFT_NAME)
    return path.name.startswith(("data-", ".")) or path.name in ours


def reason_of(error: OSError) -> str:
    """Return what the system says about an error, as part of a sentence."""
    return (error.strerror or str(error)).lower()
