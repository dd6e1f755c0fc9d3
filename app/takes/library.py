"""The takes on the disk: each is a folder under the user's data, by its name.

takes/NAME/take.json     what it is: source, profile, avatar, mode, times, trim
takes/NAME/track.npz     the states, see app.takes.rows
takes/NAME/video.mkv     the source's pictures, if they were wanted
takes/.NAME.part/        a take that is being recorded, or was when the program ended
"""

import json
import re
import shutil
import struct
import zlib
from contextlib import suppress
from dataclasses import asdict, dataclass, fields, replace
from datetime import datetime
from pathlib import Path
from tokenize import TokenError
from typing import Any
from zipfile import BadZipFile

from app.errors import AppError, OutputError
from app.profiles import data_folder
from app.recording.sink import PartialFile, reason
from app.takes.film import FILM_NAME
from app.takes.rows import Rows, read_columns

HEADER, TRACK = "take.json", "track.npz"
FORMAT, SCHEMA = "facepuppet take", 1
PART = ".part"
#: What a damaged archive raises, by what is damaged: its list, its data, their headers.
UNREADABLE = (
    OSError, EOFError, BadZipFile, RuntimeError, struct.error, zlib.error,
    KeyError, ValueError, TypeError, OverflowError, MemoryError, SyntaxError, TokenError,
)  # fmt: skip


class TakeError(AppError):
    """A take cannot be used, or not be changed as wished."""


@dataclass(frozen=True, slots=True)
class TakeFacts:
    """What take.json tells.

    Attributes:
        made: When the recording began, ISO 8601 local time.
        source: What was recorded, for people.
        profile: Name of the profile, "" without one.
        avatar: Key of the avatar that was shown.
        mode: "trained", "free" or "auto".
        fps: Frames per second that the source promised.
        size_px: (width, height) of the frames.
        focal_px: Of the camera.
        frames: Number of frames.
        seconds: Length without the pauses.
        video: Whether there is a video.
        pictures_left_out: Frames whose picture could not be written in time.
        trim_s: What of it counts, from and to.
        solved_from: Name of the take whose video it was solved from, or "".
    """

    made: str
    source: str
    profile: str
    avatar: str
    mode: str
    fps: float
    size_px: tuple[int, int]
    focal_px: float
    frames: int = 0
    seconds: float = 0.0
    video: bool = False
    pictures_left_out: int = 0
    trim_s: tuple[float, float] | None = None
    solved_from: str = ""


@dataclass(frozen=True, slots=True)
class Take:
    """A complete take.

    Attributes:
        folder: Where it is; its name is the take's.
        facts: What is told about it.
        n_bytes: What it takes on the disk.
    """

    folder: Path
    facts: TakeFacts
    n_bytes: int

    @property
    def name(self) -> str:
        """The take's name."""
        return self.folder.name

    @property
    def range_s(self) -> tuple[float, float]:
        """From when to when it counts."""
        return self.facts.trim_s or (0.0, self.facts.seconds)

    @property
    def film(self) -> Path | None:
        """The video, None without one."""
        path = self.folder / FILM_NAME
        return path if self.facts.video and path.exists() else None

    def rows(self) -> Rows:
        """Return the states.

        Raises:
            TakeError: They cannot be read.
        """
        path = self.folder / TRACK
        try:
            return read_columns(path)
        except UNREADABLE:
            raise TakeError(
                f"the take {self.name} is damaged: found no readable {path}, expected the states; "
                "copy the take again from where it is whole, or delete it"
            ) from None


def takes_folder() -> Path:
    """Return where takes live."""
    return data_folder() / "takes"


def takes() -> list[Take]:
    """Return all complete takes that this program understands, the newest first."""
    folder = takes_folder()
    found = [read_take(path) for path in folder.iterdir()] if folder.is_dir() else []
    known = [take for take in found if take is not None]
    return sorted(known, key=lambda take: (take.facts.made, take.name), reverse=True)


def read_take(folder: Path) -> Take | None:
    """Return a take, None where there is none that is complete and known."""
    if folder.name.startswith(".") or not (folder / TRACK).is_file():
        return None
    facts = read_facts(folder)
    if facts is None:
        return None
    return Take(folder, facts, sum(path.stat().st_size for path in folder.iterdir()))


def read_facts(folder: Path) -> TakeFacts | None:
    """Return what take.json tells, None where there is none of a version we know."""
    try:
        told = json.loads((folder / HEADER).read_text(encoding="utf-8"))
        if told["format"] != FORMAT or told["schema"] > SCHEMA:
            return None
        known: dict[str, Any] = {
            field.name: told[field.name] for field in fields(TakeFacts) if field.name in told
        }
        known["size_px"] = (int(known["size_px"][0]), int(known["size_px"][1]))
        trim = known.get("trim_s")
        known["trim_s"] = None if trim is None else (float(trim[0]), float(trim[1]))
        return TakeFacts(**known)
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return None


def write_facts(folder: Path, facts: TakeFacts) -> None:
    """Write take.json in one step.

    Raises:
        OutputError: It is as it was.
    """
    part = PartialFile(folder / HEADER)
    told = {"format": FORMAT, "schema": SCHEMA, "name": visible_name(folder)} | asdict(facts)
    try:
        part.path.write_text(json.dumps(told, indent=1), encoding="utf-8")
        part.finish()
    except OSError as error:
        raise OutputError(part.target, reason(error)) from None
    finally:
        with suppress(OSError):
            part.discard()


def visible_name(folder: Path) -> str:
    """Return the name of a take, also while it is being recorded."""
    return folder.name.removeprefix(".").removesuffix(PART) if (
        folder.name.startswith(".")
    ) else folder.name  # fmt: skip


def with_trim(take: Take, trim_s: tuple[float, float] | None) -> Take:
    """Keep what of a take counts; None: all of it.

    Raises:
        OutputError: It cannot be kept.
    """
    facts = replace(take.facts, trim_s=trim_s)
    write_facts(take.folder, facts)
    return replace(take, facts=facts)


def renamed(take: Take, name: str) -> Take:
    """Give a take another name.

    Raises:
        TakeError: The name is taken, or is none, or cannot be written; the old one stays.
    """
    trouble = name_trouble(name)
    if not trouble and name != take.name and (take.folder.parent / name).exists():
        trouble = f"there is a take {name!r} already: choose another name"
    if trouble:
        raise TakeError(trouble)
    target = take.folder.parent / name
    try:
        take.folder.rename(target)
    except OSError as error:
        raise TakeError(f"cannot rename the take {take.name}: {reason(error)}") from None
    try:
        write_facts(target, take.facts)
    except OutputError as error:
        target.rename(take.folder)
        raise TakeError(f"cannot rename the take {take.name}: {error.reason}") from None
    return replace(take, folder=target)


def name_trouble(name: str) -> str:
    """Return what is wrong with the name of a take, or an empty text."""
    if re.fullmatch(r"[\w-][\w .,()-]*", name) is None or name.endswith((" ", ".")):
        return (
            f"{name!r} is no name for a take, expected letters, digits, spaces and - _ . , ( ) "
            "without a space or dot at its end"
        )
    return ""


def free_name(wanted: str) -> str:
    """Return a name that no take has: the wanted one, or with a number after it."""
    folder, number, name = takes_folder(), 1, wanted
    while (folder / name).exists() or part_folder(name).exists():
        number += 1
        name = f"{wanted} ({number})"
    return name


def name_at(moment: datetime) -> str:
    """Return the usual name of a take that begins now."""
    return free_name(moment.strftime("%Y-%m-%d %H.%M.%S"))


def part_folder(name: str) -> Path:
    """Return where a take lives until it is complete."""
    return takes_folder() / f".{name}{PART}"


def delete(take: Take) -> None:
    """Delete a take.

    Raises:
        TakeError: It is as it was.
    """
    gone = take.folder.with_name(f".{take.name}.deleted")
    try:
        shutil.rmtree(gone, ignore_errors=True)
        take.folder.rename(gone)
    except OSError as error:
        raise TakeError(f"cannot delete the take {take.name}: {reason(error)}") from None
    shutil.rmtree(gone, ignore_errors=True)
