"""What more iterations of the paper's solver cost and bring [FaceIt19, fig. 4]."""

import argparse
from collections.abc import Generator, Sequence

from app.models import Models
from app.performer.opening import Scenario
from app.studies.film import perform
from app.studies.report import Cell, Column, Report, Table
from app.studies.solving import case_of, figures_of, solve
from core.energy_terms import PaperSettings
from core.energy_tracker import EnergySettings
from core.records import Progress

HELP = "time and error of the paper's solver against its iterations rho and epsilon"
COUNTS = (5, 10, 15, 20, 30, 40, 50)
#: What the paper chose for both.
CHOSEN = 15
_SHOWN = ("ms", "rotation deg", "place mm", "coefficients", "shown", "landmarks px")
_COLUMNS = tuple(Column(name, 3) for name in _SHOWN)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of this study."""
    parser.add_argument(
        "--frames", type=int, default=240, metavar="N", help="of the take (default: 240)"
    )


def run(args: argparse.Namespace, models: Models) -> Generator[Progress, None, Report]:
    """Film one take, solve it with every number of iterations.

    Yields:
        Progress of filming, then of solving.
    """
    film = yield from perform(Scenario("mixed"), models, args.frames)
    case = case_of(film, models)
    tables = []
    for name, title in (("pose_iterations", "rho"), ("expression_iterations", "epsilon")):
        rows: dict[str, Sequence[Cell]] = {}
        for count in COUNTS:
            settings = {"pose_iterations": CHOSEN, "expression_iterations": CHOSEN} | {name: count}
            paper = PaperSettings(**settings)  # type: ignore[arg-type]
            energy = EnergySettings(solver="paper", paper=paper, pose_filter=None)
            figures = figures_of([solve(case, energy)])
            rows[f"{title} {count}"] = [figures[column] for column in _SHOWN]
            yield Progress(len(rows), len(COUNTS), f"Solving with {title} {count}")
        other = "epsilon" if title == "rho" else "rho"
        tables.append(Table(f"Iterations {title}, {other} = {CHOSEN}", _COLUMNS, rows))
    return Report("iterations", tables, [
        f"{len(film.seen)} frames of {film.name}; ms: median processor time of a frame; shown: "
        "coefficients above 0.3 in the truth; both solvers stop early where nothing improves",
        "[FaceIt19] needs 31.6 ms with rho = epsilon = 15",
    ])  # fmt: skip
