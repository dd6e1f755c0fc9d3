"""How much the track of a face shakes that does not move at all."""

import argparse
from collections.abc import Generator, Sequence

import numpy as np

from app.models import Models
from app.performer.opening import PEOPLE, Scenario
from app.studies.film import Film, Way, perform, track
from app.studies.measures import head_angles_deg, shake
from app.studies.report import Cell, Column, Report, Table
from core.records import Progress

HELP = "jitter of rotation, place and coefficients on a still face"
TARGET_DEG = 0.05
#: The first frames, in which filters settle, do not count.
_SETTLING = 15

_COLUMNS = (
    Column("roll deg", 3), Column("pitch deg", 3), Column("yaw deg", 3), Column("x mm", 3),
    Column("y mm", 3), Column("z mm", 3), Column("coefficients", 4), Column("roll std", 3),
    Column("pitch std", 3), Column("yaw std", 3), Column("lost"),
)  # fmt: skip


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of this study."""
    parser.add_argument(
        "--frames", type=int, default=150, metavar="N", help="of each take (default: 150)"
    )
    parser.add_argument(
        "--people", choices=PEOPLE, nargs="+", default=list(PEOPLE), help="who sits still"
    )


def run(args: argparse.Namespace, models: Models) -> Generator[Progress, None, Report]:
    """Film everybody, track, measure the noise.

    Yields:
        Progress of filming.
    """
    recorded: dict[str, Sequence[Cell]] = {}
    live: dict[str, Sequence[Cell]] = {}
    for person in args.people:
        film = yield from perform(Scenario("statue", person), models, args.frames)
        recorded[person] = still_cells(film, models, Way())
        live[person] = still_cells(film, models, Way(learn_first=False))
    tables = [
        Table("Noise from frame to frame, a recording", _COLUMNS, recorded),
        Table("Noise from frame to frame, live from the first frame", _COLUMNS, live),
    ]
    return Report("still", tables, [
        f"wanted: at most {TARGET_DEG} degrees for each axis",
        "noise: standard deviation after slow drift is taken off; std: with the drift, which "
        "live comes from the face that is learned meanwhile",
    ])  # fmt: skip


def still_cells(film: Film, models: Models, way: Way) -> list[Cell]:
    """Return the noise of a track in the order of the columns."""
    states = track(film, models, way)
    kept = [state for state in states[_SETTLING:] if not state.lost]
    if len(kept) < 3:
        return [*[None] * (len(_COLUMNS) - 1), sum(state.lost for state in states)]
    angles = np.array([head_angles_deg(state.rotation_wxyz) for state in kept])
    places = np.array([state.translation_mm for state in kept])
    coefficients = shake(np.array([state.expression for state in kept])).mean()
    figures = [*shake(angles), *shake(places), coefficients, *angles.std(axis=0)]
    return [*(float(figure) for figure in figures), sum(state.lost for state in states)]
