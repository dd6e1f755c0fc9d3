"""From what a recording left on the disk to a take, after its end or after a crash."""

import shutil
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

from app.errors import AppError
from app.recording.sink import PartialFile
from app.takes.claims import claimed, claiming, show_life
from app.takes.film import FILM_NAME, mend
from app.takes.library import (
    HEADER,
    PART,
    TRACK,
    Take,
    TakeError,
    TakeFacts,
    free_name,
    read_facts,
    read_take,
    takes_folder,
    visible_name,
    write_facts,
)
from app.takes.rows import appended, mode_of, write_columns
from core.camera import camera_for

#: Rows as they come, until the take is complete.
STATES = "states.bin"
#: A recording shows every second that it lives; one silent for so long has been abandoned.
SILENT_S = 12.0


def complete(part: Path, facts: TakeFacts) -> Take | None:
    """Make a take of what was recorded; without a single frame nothing stays.

    Args:
        part: The folder of the recording.
        facts: As they were at its begin, with what is known of the video.

    Raises:
        OSError, OutputError: The disk takes no more; what was recorded stays for another try.
    """
    rows = appended(part / STATES)
    if len(rows) == 0:
        shutil.rmtree(part, ignore_errors=True)
        return None
    frame_s = 1 / max(facts.fps, 1.0)
    facts = replace(
        facts, frames=len(rows), seconds=float(rows["play_s"][-1]) + frame_s, mode=mode_of(rows)
    )
    track = PartialFile(part / TRACK)
    try:
        camera = camera_for(facts.size_px, facts.focal_px)
        write_columns(track.path, rows, camera, partial(show_life, part))
    except OSError:
        track.discard()
        raise
    track.finish()
    write_facts(part, facts)
    # The map of the file must be gone before the file can be moved.
    del rows
    return _placed(part)


def abandoned(now_s: float | None = None) -> list[Path]:
    """Return recordings that nobody completes any more, here or in another program.

    Args:
        now_s: On the clock of the files' times.
    """
    now_s = time.time() if now_s is None else now_s
    return [
        part for part in unfinished()
        if not claimed(part) and now_s - _last_sign_s(part) > SILENT_S
    ]  # fmt: skip


def unfinished() -> list[Path]:
    """Return all recordings that are not complete, also those that go on."""
    folder = takes_folder()
    return sorted(folder.glob(f".*{PART}")) if folder.is_dir() else []


def recover(part: Path) -> Take | None:
    """Make a take of an abandoned recording; only one that holds nothing is removed.

    Raises:
        TakeError: It cannot be completed now; it stays as it is.
    """
    with claiming(part) as own:
        if not own:
            return None
        facts = read_facts(part)
        if facts is None:
            _drop_empty(part)
            return None
        show_life(part)
        try:
            return _recovered(part, facts)
        except (OSError, AppError) as error:
            raise TakeError(
                f"the take {visible_name(part)}, whose recording was broken off, cannot be "
                f"completed: {error}; make room and start again"
            ) from None


def recovered() -> Iterator[Take | TakeError]:
    """Complete all abandoned recordings, one after the other."""
    for part in abandoned():
        try:
            take = recover(part)
        except TakeError as error:
            yield error
            continue
        if take is not None:
            yield take


def _recovered(part: Path, facts: TakeFacts) -> Take | None:
    if _holds(part / TRACK) and not _holds(part / STATES):
        # Complete but for its place.
        return _placed(part)
    film = part / FILM_NAME
    n_pictures = mend(film, partial(show_life, part)) if film.exists() else 0
    return complete(part, replace(facts, video=n_pictures > 0))


def _drop_empty(part: Path) -> None:
    """Remove a recording that ended before it began.

    Raises:
        TakeError: It holds something, of another version or on a disk that cannot be read now.
    """
    if any(_holds(part / name) for name in (STATES, FILM_NAME, TRACK)):
        raise TakeError(
            f"the take {visible_name(part)}, whose recording was broken off, cannot be completed: "
            f"found no {HEADER} in {part} that this version of the program understands; start the "
            "version that recorded it, or delete the folder"
        )
    shutil.rmtree(part, ignore_errors=True)


def _holds(path: Path) -> bool:
    try:
        return path.stat().st_size > 0
    except FileNotFoundError:
        return False
    except OSError:
        # Not known now is not empty.
        return True


def _placed(part: Path) -> Take | None:
    """Move a complete take to where takes are; only then are its rows needed no more."""
    target = takes_folder() / visible_name(part)
    if target.exists():
        target = takes_folder() / free_name(target.name)
    part.rename(target)
    with suppress(OSError):
        (target / STATES).unlink(missing_ok=True)
    return read_take(target)


def _last_sign_s(part: Path) -> float:
    header = part / HEADER
    return header.stat().st_mtime if header.exists() else part.stat().st_mtime
