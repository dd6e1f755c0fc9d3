"""Glasses, beard, hair, a hand, dim light, one-sided faces [FaceIt19, discussion]; real films."""

import argparse
from collections.abc import Generator, Sequence

import numpy as np

from app.models import Models
from app.performer.conditions import HAND, LASTING
from app.performer.events import held_share
from app.performer.opening import PEOPLE, Scenario
from app.sources import open_source
from app.studies.film import Film, Way, perform, track, watch
from app.studies.measures import coefficient_errors, landmark_errors_px, pose_errors
from app.studies.report import Cell, Column, Report, Table
from core.evaluation import against_reference
from core.landmarks import N_INTERNAL
from core.records import FaceState, Progress

HELP = "errors with glasses, beard, hair, a hand, dim light, one-sided faces; --video: real films"
#: Share of the way up from which a hand counts as covering.
_COVERING = 0.9

_COLUMNS = (
    Column("frames"), Column("lost"), Column("network px"), Column("landmarks px"),
    Column("rotation deg"), Column("place mm", 1), Column("coefficients", 3), Column("shown", 3),
)  # fmt: skip
_FILM_COLUMNS = (
    Column("frames"), Column("lost"), Column("median px"), Column("under 3 px %", 1),
    Column("noise px"), Column("aligner's"), Column("noise deg", 3), Column("aligner lost"),
)  # fmt: skip


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of this study."""
    parser.add_argument(
        "--frames", type=int, default=120, metavar="N", help="of each take (default: 120)"
    )
    parser.add_argument("--person", choices=PEOPLE, default=PEOPLE[0], help="who performs")
    parser.add_argument(
        "--video", action="append", default=[], metavar="FILE",
        help="also track this film and compare it with the generic aligner; may be repeated",
    )  # fmt: skip
    parser.add_argument("--only-videos", action="store_true", help="leave the performer out")


def scenarios(person: str) -> dict[str, Scenario]:
    """Return what is compared, by name."""
    out = {
        "plain": Scenario("talking", person),
        "asymmetric": Scenario("asymmetric", person),
    }
    return out | {name: Scenario("talking", person, conditions=(name,)) for name in LASTING}


def run(args: argparse.Namespace, models: Models) -> Generator[Progress, None, Report]:
    """Film every condition, track it as a recording, compare; then the real films.

    Yields:
        Progress of filming and watching.
    """
    rows: dict[str, Sequence[Cell]] = {}
    for name, scenario in ({} if args.only_videos else scenarios(args.person)).items():
        film = yield from perform(scenario, models, args.frames)
        rows |= condition_rows(name, film, models)
    films: dict[str, Sequence[Cell]] = {}
    for name in args.video:
        with open_source(name) as source:
            film = yield from watch(source, models, args.frames, with_reference=True)
        films[film.name] = film_cells(film, models)
    tables = [Table(f"Conditions ({args.person}), as recordings", _COLUMNS, rows)] if rows else []
    if films:
        tables.append(
            Table("Films against the generic aligner, at 640 px width", _FILM_COLUMNS, films)
        )
    return Report("conditions", tables, [
        "network px, landmarks px: root mean square distance of the internal landmarks from the "
        "truth, as the network saw them and as they were solved; shown: coefficients above 0.3 "
        "in the truth",
    ])  # fmt: skip


def condition_rows(name: str, film: Film, models: Models) -> dict[str, list[Cell]]:
    """Return the errors of a performer's film by name; a hand also while it covers the mouth."""
    states = track(film, models, Way())
    rows = {name: condition_cells(film, states, range(len(states)))}
    if name == HAND:
        covered = [n for n, time_s in enumerate(film.times_s) if held_share(time_s) > _COVERING]
        rows[f"{name}, while it covers"] = condition_cells(film, states, covered)
    return rows


def condition_cells(film: Film, states: Sequence[FaceState], frames: Sequence[int]) -> list[Cell]:
    """Return the errors in some frames of a performer's film in the order of the columns."""
    kept = [n for n in frames if not states[n].lost]
    n_lost = len(frames) - len(kept)
    if film.camera is None or not kept:
        return [len(frames), n_lost, *[None] * (len(_COLUMNS) - 2)]
    solved, truths = [states[n] for n in kept], [film.truths[n] for n in kept]
    seen = [one.landmarks.points_px for one in (film.seen[n] for n in kept) if one is not None]
    network = landmark_errors_px(seen, truths, film.camera).mean()
    landmarks = landmark_errors_px([s.landmarks_px for s in solved], truths, film.camera).mean()
    errors = pose_errors(solved, truths)
    degrees, mm = np.abs(errors.degrees).mean(), np.abs(errors.mm).mean()
    figures = [network, landmarks, degrees, mm, *coefficient_errors(solved, truths)]
    return [len(frames), n_lost, *(float(figure) for figure in figures)]


def film_cells(film: Film, models: Models) -> list[Cell]:
    """Return how a real film's track differs from the generic aligner, by columns."""
    states = track(film, models, Way())
    rows = range(N_INTERNAL)
    found = against_reference(states, film.reference_px, rows, film.size_px[0])
    share: object = found["share_under_px"]
    under = share["3"] if isinstance(share, dict) else float("nan")
    unseen = int(np.isnan(film.reference_px[:, 0, 0]).sum())
    names = ("jitter_px", "jitter_reference_px", "jitter_rotation_deg")
    return [
        len(states), _number(found["lost"]), _number(found["median_rmse_px"]), 100 * under,
        *(_number(found[name]) for name in names), unseen,
    ]  # fmt: skip


def _number(value: object) -> float | int:
    """Return a number of a report."""
    if not isinstance(value, int | float):
        raise TypeError(f"expected a number in the report, found {value!r}")
    return value
