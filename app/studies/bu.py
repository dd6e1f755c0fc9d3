"""How well the head's pose is found on the Boston University films [FaceIt19, table 1]."""

import argparse
from collections.abc import Generator, Sequence
from pathlib import Path

import numpy as np

from app.models import Models
from app.sources import open_source
from app.studies.bu_format import LAYOUT, SensorPose, films_in, read_truth
from app.studies.film import Way, track, watch
from app.studies.measures import errors_between, since_first, together
from app.studies.pose import POSE_COLUMNS, pose_cells, published_rows
from app.studies.report import Cell, Column, Report, Table
from core.records import FaceState, FloatArray, Progress

HELP = "the same on the Boston University head tracking database, if you have it"
_AXES = ("roll", "pitch", "yaw", "x", "y", "z")
#: Tracked and true axes that run against each other by more than this are read the other way.
_AGAINST = -0.3

#: (N, 6) roll, pitch, yaw in degrees and x, y, z in mm since the first tracked frame.
Moves = FloatArray


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of this study."""
    parser.add_argument("folder", type=Path, metavar="FOLDER", help=LAYOUT)
    parser.add_argument(
        "--frames", type=int, default=10_000, metavar="N", help="of each film at most"
    )


def run(args: argparse.Namespace, models: Models) -> Generator[Progress, None, Report]:
    """Watch every film, track it as a recording, compare.

    Yields:
        Progress of watching.

    Raises:
        HeadTrackingDataError: The folder is not of the database's layout.
    """
    pairs, lost = [], 0
    for path, table in films_in(args.folder):
        with open_source(str(path)) as source:
            film = yield from watch(source, models, args.frames)
        truth = read_truth(table, len(film.seen))
        states = track(film, models, Way())[: len(truth)]
        lost += sum(state.lost for state in states)
        if not all(state.lost for state in states):
            pairs.append((path.stem, *moves(states, truth)))
    if not pairs:
        return Report("bu", [], [f"no face was found in any film of {args.folder}"])
    agreement = axes_agree([(found, true) for _, found, true in pairs])
    signs = np.where(agreement < _AGAINST, -1.0, 1.0)
    errors = {name: errors_between(found, true * signs) for name, found, true in pairs}
    rows: dict[str, Sequence[Cell]] = {"here": pose_cells(together(list(errors.values())))}
    tables = [
        Table("Mean absolute errors of the pose", POSE_COLUMNS, rows | published_rows()),
        Table("Each film", POSE_COLUMNS, {name: pose_cells(e) for name, e in errors.items()}),
        Table(
            "How tracked and true movement agree (correlation over all films)",
            [Column(axis) for axis in _AXES], {"": [float(value) for value in agreement]},
        ),
    ]  # fmt: skip
    turned = [axis for axis, sign in zip(_AXES, signs, strict=True) if sign < 0]
    notes = [f"{len(pairs)} films, {lost} frames lost; movement since the first tracked frame"]
    if turned:
        notes.append(
            f"read with the other sign, as they ran against the track: {', '.join(turned)}"
        )
    return Report("bu", tables, notes)


def moves(states: Sequence[FaceState], truth: Sequence[SensorPose]) -> tuple[Moves, Moves]:
    """Return the tracked and the true movement in the frames that are not lost."""
    kept = [n for n, state in enumerate(states) if not state.lost]
    return since_first([states[n] for n in kept]), since_first([truth[n] for n in kept])


def axes_agree(pairs: Sequence[tuple[Moves, Moves]]) -> FloatArray:
    """Return the correlation (6,) of tracked and true movement, 0 where nothing moves."""
    found, true = (np.concatenate([pair[k] for pair in pairs]) for k in range(2))
    found, true = found - found.mean(axis=0), true - true.mean(axis=0)
    size = np.sqrt(np.sum(found**2, axis=0) * np.sum(true**2, axis=0))
    return np.asarray(np.sum(found * true, axis=0) / np.maximum(size, 1e-9))
