"""A take as files for other programs: arrays, a table, a film of the avatar."""

from collections.abc import Callable, Generator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from app.recording.outputs import Outputs
from app.recording.sink import PartialFile
from app.recording.table import Table
from app.recording.video import letterboxed
from app.takes.film import FilmError, FilmReader, FilmWriter, blank
from app.takes.library import Take, TakeError
from app.takes.rows import Moment, Rows, moment_of, write_columns
from core.camera import camera_for
from core.records import U8, Frame, Progress

ARRAYS, TABLE, FILM = ".npz", ".csv", ".mp4"
#: Frames between two steps of quick work.
STEP = 50


@dataclass(frozen=True, slots=True)
class FilmWish:
    """What a film shows.

    Attributes:
        size_px: (width, height) of the avatar's picture, even numbers.
        fps: Frames per second, evenly spaced whatever the camera did.
        beside: Whether the take's video stands on the left of the avatar.
    """

    size_px: tuple[int, int] = (1280, 720)
    fps: float = 30.0
    beside: bool = False


def kept_rows(take: Take) -> Rows:
    """Return the rows of what of a take counts.

    Raises:
        TakeError: There are none.
    """
    rows = take.rows()
    first_s, last_s = take.range_s
    kept = rows[(rows["play_s"] >= first_s) & (rows["play_s"] <= last_s)]
    if len(kept) == 0:
        raise TakeError(f"nothing of the take {take.name} is between its trim marks: move them")
    return kept


def export_arrays(take: Take, path: Path) -> Generator[Progress, None, Path]:
    """Write the states as .npz, in the layout of app.takes.rows.

    Raises:
        TakeError, OutputError: Nothing was written.
    """
    yield Progress(0, 1, "Writing the arrays")
    rows, part = kept_rows(take), PartialFile(path)
    try:
        write_columns(part.path, rows, camera_for(take.facts.size_px, take.facts.focal_px))
        part.finish()
    except OSError as error:
        raise TakeError(f"cannot write {path}: {error.strerror or error}") from None
    finally:
        part.discard()
    return path


def export_table(take: Take, path: Path, driven: bool) -> Generator[Progress, None, Path]:
    """Write a row per frame as .csv; times count from where the take is trimmed.

    Args:
        take: To write.
        path: Where.
        driven: What the avatar did; else what was solved.

    Raises:
        TakeError, AppError: Nothing was written.
    """
    rows = kept_rows(take)
    nothing = blank((1, 1), 0.0, 0)
    with Outputs() as outputs:
        outputs.add(Table(path))
        for number, row in enumerate(rows):
            moment = moment_of(row)
            state = moment.driven if driven else moment.solved
            time_s = moment.play_s - float(rows["play_s"][0])
            frame = Frame(nothing.rgb, nothing.gray, time_s, moment.frame_index)
            outputs.write(frame, replace(state, time_s=time_s))
            if number % STEP == 0:
                yield Progress(number, len(rows), "Writing the table")
    return path


def export_film(
    take: Take, path: Path, wish: FilmWish, draw: Callable[[Moment, Frame | None], U8]
) -> Generator[Progress, None, Path]:
    """Write the avatar's performance as .mp4.

    Args:
        take: To show.
        path: Where.
        wish: How it is shown.
        draw: Gives the avatar's picture (H, W, 4) of a moment and its frame; of any size.

    Raises:
        TakeError, OutputError, FilmError: Nothing was written; FilmError: the take's video cannot
            be read.
    """
    rows, part = kept_rows(take), PartialFile(path)
    with ExitStack() as stack:
        stack.callback(part.discard)
        reader = FilmReader(take.film) if take.film is not None else None
        if reader is not None:
            stack.callback(reader.close)
        writer = _writer(part, wish)
        stack.callback(writer.close)
        turns = evenly(rows["play_s"], wish.fps)
        for number, turn in enumerate(turns):
            moment = moment_of(rows[turn])
            frame = _frame(take, reader, moment)
            avatar = letterboxed(draw(moment, frame)[..., :3], wish.size_px)
            writer.write(_beside(frame, avatar, wish) if wish.beside else avatar)
            yield Progress(number + 1, len(turns), "Drawing the avatar")
        writer.close()
        _check_written(part.path, path)
        part.finish()
    return path


def _writer(part: PartialFile, wish: FilmWish) -> FilmWriter:
    width, height = wish.size_px
    try:
        return FilmWriter(part.path, wish.fps, (2 * width if wish.beside else width, height))
    except FilmError:
        raise TakeError(
            f"cannot write {part.target}: OpenCV began no video there, expected MPEG-4 in a "
            f"{FILM} file; choose another place, or a smaller picture"
        ) from None


def evenly(times_s: Rows, fps: float) -> list[int]:
    """Return which frame to show at each tick of an even clock: the newest that has come."""
    n_ticks = round((float(times_s[-1]) - float(times_s[0])) * fps) + 1
    ticks = float(times_s[0]) + np.arange(n_ticks) / fps
    # A frame that comes a hair after its tick belongs to it.
    shown = np.searchsorted(times_s, ticks + 0.25 / fps, side="right") - 1
    return [int(turn) for turn in np.clip(shown, 0, len(times_s) - 1)]


def _frame(take: Take, reader: FilmReader | None, moment: Moment) -> Frame | None:
    if reader is None:
        return None
    solved = moment.solved
    return reader.frame(moment.video_index, take.facts.size_px, solved.time_s, moment.frame_index)


def _beside(frame: Frame | None, avatar: U8, wish: FilmWish) -> U8:
    source = blank(wish.size_px, 0.0, 0).rgb if frame is None else letterboxed(
        frame.rgb, wish.size_px
    )  # fmt: skip
    return np.concatenate([source, avatar], axis=1)


def _check_written(part: Path, path: Path) -> None:
    """Read the last film back a little: OpenCV does not tell of a full disk."""
    capture = cv2.VideoCapture(str(part))
    whole = capture.isOpened() and capture.read()[0]
    capture.release()
    if not whole:
        raise TakeError(f"cannot write {path}: the disk is probably full; choose another place")
