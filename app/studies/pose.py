"""How well the head's pose is found [FaceIt19, table 1], on the performer's head-motion takes."""

import argparse
from collections.abc import Generator, Sequence
from typing import Any

import numpy as np

from app.models import Models
from app.performer.opening import PEOPLE, Scenario
from app.studies.film import Film, Way, perform, track
from app.studies.measures import (
    MM_PER_INCH,
    PoseErrors,
    errors_since_first,
    head_angles_deg,
    pose_errors,
    together,
)
from app.studies.report import Cell, Column, Report, Table
from core.records import Progress

HELP = "errors of head rotation and translation on the performer's head-motion takes"
#: Frames of a take, as of a Boston University film; heads turned further do not count.
FRAMES, MOST_YAW_DEG = 200, 60.0
TARGET_DEG = 2.0
NO_ERRORS = PoseErrors(np.empty((0, 3)), np.empty((0, 3)))

POSE_COLUMNS = (
    Column("roll deg"), Column("pitch deg"), Column("yaw deg"), Column("mean deg"),
    Column("x mm", 1), Column("y mm", 1), Column("z mm", 1),
    Column("x in"), Column("y in"), Column("z in"),
)  # fmt: skip
#: What is published for the Boston University films: roll, pitch, yaw, mean, then x, y, z in
#: inches [FaceIt19, table 1 and text].
PUBLISHED: dict[str, tuple[float, ...]] = {
    "[FaceIt19] on BU": (2.35, 3.62, 4.38, 3.45, 2.27, 0.90, 2.04),
    "Diaz Barros et al. 2018 on BU": (2.32, 3.41, 3.90, 3.21),
    "Gou et al. 2017 on BU": (3.3, 4.8, 5.1, 4.4),
    "Wu et al. 2017 on BU": (3.1, 5.3, 4.9, 4.43),
    "Jeni et al. 2017 on BU": (2.41, 2.66, 3.93, 3.0),
}
#: The training-free mode in different situations.
WAYS: dict[str, Way] = {
    "a recording": Way(),
    "a recording, focal length known": Way(known_focal=True),
    "live from the first frame": Way(learn_first=False),
    "mean face, focal length known": Way(known_focal=True, learn=False),
}


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of this study."""
    parser.add_argument(
        "--takes", type=int, default=3, metavar="N",
        help="takes of 200 frames, by the performers in turn (default: 3)",
    )  # fmt: skip
    parser.add_argument(
        "--frames", type=int, default=FRAMES, metavar="N", help="of each take (default: 200)"
    )


def run(args: argparse.Namespace, models: Models) -> Generator[Progress, None, Report]:
    """Film the takes, track them in every way, compare.

    Yields:
        Progress of filming.
    """
    films = []
    for k in range(args.takes):
        scenario = Scenario("head_motion", PEOPLE[k % len(PEOPLE)], seed=k)
        films.append((yield from perform(scenario, models, args.frames)))
    rows: dict[str, Sequence[Cell]] = {}
    each: dict[str, Sequence[Cell]] = {}
    lost = 0
    for name, way in WAYS.items():
        errors, moves = [], []
        for k, film in enumerate(films):
            found, moved, n_lost = errors_of(film, models, way)
            errors.append(found)
            moves.append(moved)
            if way == Way():
                lost += n_lost
                each[f"take {k}, {film.name}"] = pose_cells(found)
        rows[name] = pose_cells(together(errors))
        if way == Way():
            rows["a recording, since the first frame as on BU"] = pose_cells(together(moves))
    tables = [
        Table("Mean absolute errors of the pose", POSE_COLUMNS, rows | published_rows()),
        Table("Each take as a recording", POSE_COLUMNS, each),
    ]
    n_frames = sum(len(film.seen) for film in films)
    return Report("pose", tables, [
        f"{n_frames} frames of {len(films)} takes, {lost} lost; heads turned up to "
        f"{MOST_YAW_DEG:g} degrees count; wanted: a mean of {TARGET_DEG} degrees",
        "a recording: face and focal length are learned from its first seconds, as track does",
    ])  # fmt: skip


def errors_of(film: Film, models: Models, way: Way) -> tuple[PoseErrors, PoseErrors, int]:
    """Return the errors in the camera frame, those since the first frame, and lost frames."""
    states = track(film, models, way)
    kept = [n for n, state in enumerate(states) if not state.lost]
    if not kept:
        return NO_ERRORS, NO_ERRORS, len(states)
    solved, truths = [states[n] for n in kept], [film.truths[n] for n in kept]
    near = np.array([abs(head_angles_deg(t.rotation_wxyz)[2]) <= MOST_YAW_DEG for t in truths])
    absolute, moved = (
        PoseErrors(errors.degrees[near], errors.mm[near])
        for errors in (pose_errors(solved, truths), errors_since_first(solved, truths))
    )
    return absolute, moved, len(states) - len(kept)


def pose_cells(errors: PoseErrors) -> list[Cell]:
    """Return the mean absolute errors in the order of POSE_COLUMNS."""
    if not len(errors.degrees):
        return [None] * len(POSE_COLUMNS)
    degrees, mm = np.abs(errors.degrees).mean(axis=0), np.abs(errors.mm).mean(axis=0)
    figures: Any = [*degrees, degrees.mean(), *mm, *(mm / MM_PER_INCH)]
    return [float(figure) for figure in figures]


def published_rows() -> dict[str, Sequence[Cell]]:
    """Return what is published, in the order of POSE_COLUMNS."""
    rows: dict[str, Sequence[Cell]] = {}
    for name, (*degrees, mean) in ((n, f[:4]) for n, f in PUBLISHED.items()):
        inches = PUBLISHED[name][4:]
        mm: list[Cell] = [inch * MM_PER_INCH for inch in inches] or [None] * 3
        rows[name] = [*degrees, mean, *mm, *(inches or [None] * 3)]
    return rows
