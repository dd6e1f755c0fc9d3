"""A take's video solved once more: with another profile, in another mode. The result is a take."""

import os
import shutil
from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from app.models import LEARNING_S, Looking, Models, auto_tracker, free_tracker, live_tracker
from app.takes.claims import claiming, show_life
from app.takes.completing import STATES, complete
from app.takes.film import FILM_NAME, FilmReader
from app.takes.library import Take, TakeError, free_name, part_folder, write_facts
from app.takes.rows import Moment, row_of
from core.free_live import FreeTracker
from core.live import resting_state
from core.records import Camera, FaceState, Frame, Progress
from core.store import Profile

TRAINED, FREE, AUTO = "trained", "free", "auto"
#: What a mode is called.
MODE_TEXTS = {
    AUTO: "The profile where it fits, else training-free",
    TRAINED: "The profile only",
    FREE: "Training-free",
}


class Tracker(Protocol):
    """What is needed of every kind of tracker."""

    @property
    def camera(self) -> Camera:
        """The camera in pixels of the last frame."""
        ...

    def step(self, frame: Frame) -> FaceState:
        """Return the face in a frame."""
        ...


@dataclass(frozen=True, slots=True)
class SolveWish:
    """How to solve a take anew.

    Attributes:
        profile: Name of a profile, "" without one.
        mode: "trained", "free" or "auto"; without a profile "free".
        name: Of the new take.
    """

    profile: str
    mode: str
    name: str


def tracker_for(models: Models, profile: Profile | None, mode: str) -> Tracker:
    """Return the tracker that solves recorded frames in a mode; the network looks at every one."""
    if profile is None:
        return free_tracker(models, looking=Looking())
    if mode == TRAINED:
        return live_tracker(models, profile)
    if mode == AUTO:
        return auto_tracker(models, profile, Looking())
    return free_tracker(models, profile.camera, Looking(), profile.user)


def solve(
    take: Take, wish: SolveWish, tracker: Tracker, drive: Callable[[FaceState], FaceState]
) -> Generator[Progress, None, Take]:
    """Solve the whole video of a take; nothing stays of what is not finished.

    Args:
        take: With a video.
        wish: How.
        tracker: That solves it.
        drive: From the solved face to what the avatar does.

    Returns:
        The new take, with the same trim.

    Raises:
        TakeError: There is no video, or the disk takes no more.
    """
    film = take.film
    if film is None:
        raise TakeError(f"the take {take.name} has no video: only one with a video can be solved")
    part = part_folder(free_name(wish.name))
    facts = replace(take.facts, profile=wish.profile, mode=wish.mode, solved_from=take.name)
    try:
        # Until it is complete it looks like what a crash left.
        with claiming(part):
            part.mkdir(parents=True)
            write_facts(part, facts)
            _same_file(film, part / FILM_NAME)
            focal_px = yield from _write_states(part, take, tracker, drive)
            made = complete(part, replace(facts, focal_px=focal_px))
    except OSError as error:
        raise TakeError(f"cannot write the new take: {error.strerror or error}") from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
    if made is None:
        raise TakeError(f"the take {take.name} has no frames: there is nothing to solve")
    return made


def _write_states(
    part: Path, take: Take, tracker: Tracker, drive: Callable[[FaceState], FaceState]
) -> Generator[Progress, None, float]:
    """Write the states of all frames; return the focal length."""
    rows = take.rows()
    reader = FilmReader(part / FILM_NAME)
    label = f"Solving {take.name}"
    last = resting_state(FREE)
    try:
        if isinstance(tracker, FreeTracker) and not tracker.acquainted:
            yield from _learn(part, tracker, take, reader)
        with (part / STATES).open("wb") as file:
            for number, row in enumerate(rows):
                time_s, index = float(row["time_s"]), int(row["video_index"])
                frame = reader.frame(index, take.facts.size_px, time_s, int(row["frame_index"]))
                # A frame without a picture tells nothing of the face.
                last = tracker.step(frame) if index >= 0 else replace(
                    last, time_s=time_s, lost=True
                )  # fmt: skip
                moment = Moment(float(row["play_s"]), frame.index, index, last, drive(last))
                file.write(row_of(moment).tobytes())
                show_life(part)
                yield Progress(number + 1, len(rows), label)
    finally:
        reader.close()
    return float(tracker.camera.focal_px)


def _learn(
    part: Path, tracker: FreeTracker, take: Take, reader: FilmReader
) -> Generator[Progress, None, None]:
    """Let a tracker see the beginning, so that the first frames are solved as well as the last."""
    rows = take.rows()
    some = rows[rows["play_s"] < LEARNING_S]
    for number, row in enumerate(some[some["video_index"] >= 0]):
        frame = reader.frame(
            int(row["video_index"]), take.facts.size_px, float(row["time_s"]), number
        )
        tracker.step(frame)
        show_life(part)
        yield Progress(0, len(rows), "Getting to know the face")
    tracker.reset()


def _same_file(source: Path, target: Path) -> None:
    """Make a second name of a file where the disk can, else a copy."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
