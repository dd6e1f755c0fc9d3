"""Hands, cups, other people, lamps, shakes, leaving: how every mode gets through, by numbers."""

import argparse
from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from app.models import Looking, Models, auto_tracker, free_tracker, live_tracker
from app.performer.opening import PEOPLE
from app.profiles import load_setup_images, profile_folder
from app.studies.measures import coefficient_errors, pose_errors
from app.studies.report import Cell, Column, Report, Table
from app.studies.robust_events import Filmed, events, filmed
from core.camera import project
from core.evaluation import frame_rmse_px
from core.landmarks import N_INTERNAL, REGION_NAMES
from core.light_change import LightReference, LightWatch, light_reference
from core.records import FaceState, FloatArray, Progress
from core.store import Profile, load

if TYPE_CHECKING:
    from core.auto_live import AutoTracker
    from core.free_live import FreeTracker
    from core.live import LiveTracker

HELP = "a hand, a cup, other people, lamps, shakes, leaving: errors meanwhile and recovery"
MODES = ("trained", "free", "auto")
#: A face is found again when its landmarks are nearer to the truth than this, px.
FOUND_PX = 5.0
#: Frames at the beginning that are not judged: a tracker gets to know the face.
_BEGIN = 20
#: Frames after which a recovery counts as failed.
_NEVER = 60
#: From this share of an event on a frame belongs to it; below the other nothing of it is left.
_DURING, _OVER = 0.9, 0.02

_COLUMNS = (
    Column("lost"), Column("calm px"), Column("meanwhile px"), Column("worst px", 1),
    Column("turned deg", 1), Column("calm coeff", 3), Column("meanwhile coeff", 3),
    Column("found after", 1), Column("at most"), Column("trained %"),
    *(Column(name) for name in REGION_NAMES), Column("light"),
)  # fmt: skip

#: Numbers of frames.
Frames = np.typing.NDArray[np.intp]


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of this study."""
    parser.add_argument(
        "--profile", metavar="PROFILE",
        help="of the performer, as `facepuppet demo` makes one; without, only the free mode",
    )  # fmt: skip
    parser.add_argument("--person", choices=PEOPLE, default=PEOPLE[0], help="who performs")
    parser.add_argument("--only", nargs="+", metavar="EVENT", help="these events only")


def run(args: argparse.Namespace, models: Models) -> Generator[Progress, None, Report]:
    """Film every event, track it in all modes, compare.

    Yields:
        Progress of filming.
    """
    profile, light = None, None
    if args.profile:
        folder = profile_folder(args.profile)
        profile = load(folder)
        images = load_setup_images(folder, profile)
        light = light_reference(images.images, profile.shapes, profile.camera)
    rows: dict[str, Sequence[Cell]] = {}
    for name, event in events(args.person).items():
        if args.only and name not in args.only:
            continue
        film = yield from filmed(name, event)
        for mode in MODES if profile is not None else ("free",):
            states, lights = track(film, models, mode, profile, light)
            rows[f"{name}, {mode}"] = event_cells(film, states, lights)
    return Report("robust", [Table(f"Robustness ({args.person}), live", _COLUMNS, rows)], [
        "calm, meanwhile: while nothing is before the face, and while it happens; px: root mean "
        "square distance of the internal landmarks from the truth, lost faces where they were "
        "seen last; turned deg: error of the head's angles meanwhile; coeff: mean error of all "
        f"coefficients; found after, at most: frames until the error is below {FOUND_PX:.0f} px "
        "once nothing is before the face; region names: confidence meanwhile (median); light: "
        "frames in which other light was told",
    ])  # fmt: skip


def track(
    film: Filmed, models: Models, mode: str, profile: Profile | None,
    light: LightReference | None,
) -> tuple[list[FaceState], int]:  # fmt: skip
    """Return the states of a film in a mode, and in how many frames other light was told."""
    looking = Looking("adaptive")
    tracker: LiveTracker | FreeTracker | AutoTracker
    if profile is None or mode == "free":
        tracker = free_tracker(models, None, looking)
    elif mode == "trained":
        tracker = live_tracker(models, profile)
    else:
        tracker = auto_tracker(models, profile, looking)
    watch = None if light is None else LightWatch(light)
    states, told = [], 0
    for frame in film.frames:
        states.append(tracker.step(frame))
        told += watch is not None and watch.step(frame, states[-1]) is not None
    return states, told


def event_cells(film: Filmed, states: Sequence[FaceState], lights: int) -> list[Cell]:
    """Return the errors of a film in the order of the columns."""
    true = [project(film.camera, truth.points_mm[:N_INTERNAL]) for truth in film.truths]
    found = [state.landmarks_px[:N_INTERNAL] for state in states]
    errors = frame_rmse_px(np.array(found), np.array(true))
    lost = np.array([state.lost for state in states])
    judged = np.arange(len(states)) >= _BEGIN
    during = np.flatnonzero((film.shares > _DURING) & judged)
    calm = np.flatnonzero((film.shares < _OVER) & judged)
    waits = recoveries(film.shares, (errors < FOUND_PX) & ~lost)
    regions = np.array([state.regions for state in states])
    trained = np.mean([state.mode == "trained" for state in states])
    return [
        int(lost.sum()), _mean(errors[calm]), _mean(errors[during]), _most(errors[during]),
        _turned(film, states, during), _coefficients(film, states, calm),
        _coefficients(film, states, during), _mean(waits), int(waits.max()) if len(waits) else None,
        round(100 * float(trained)),
        *(float(np.median(column)) if len(during) else None for column in regions[during].T),
        lights,
    ]  # fmt: skip


def recoveries(shares: FloatArray, good: FloatArray) -> FloatArray:
    """Return how many frames each end of an event was waited for a good one (E,)."""
    ends = np.flatnonzero((shares[1:] < _OVER) & (shares[:-1] >= _OVER)) + 1
    waits = []
    for end in ends:
        after = np.flatnonzero(good[end : end + _NEVER])
        # A film that ends before says nothing.
        if len(after) or end + _NEVER <= len(good):
            waits.append(float(after[0]) if len(after) else float(_NEVER))
    return np.array(waits)


def _turned(film: Filmed, states: Sequence[FaceState], frames: Frames) -> float | None:
    if not len(frames):
        return None
    errors = pose_errors([states[n] for n in frames], [film.truths[n] for n in frames])
    return float(np.abs(errors.degrees).mean())


def _coefficients(film: Filmed, states: Sequence[FaceState], frames: Frames) -> float | None:
    if not len(frames):
        return None
    return coefficient_errors([states[n] for n in frames], [film.truths[n] for n in frames])[0]


def _mean(values: FloatArray) -> float | None:
    return float(values.mean()) if len(values) else None


def _most(values: FloatArray) -> float | None:
    return float(values.max()) if len(values) else None
