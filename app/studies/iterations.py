"""What more iterations of the paper's solver cost and bring [FaceIt19, fig. 4]."""

import argparse
from collections.abc import Generator, Sequence

from app.models import Models
from app.performer.opening import Scenario
from app.studies.film import perform
from app.studies.report import Cell, Column, Report, Table
from app.studies.solving import Case, case_of, figures_of, solve
from core.energy_terms import PaperSettings
from core.energy_tracker import EnergySettings
from core.records import Progress

HELP = "time and error of the paper's solver against its iterations rho and epsilon"
COUNTS = (1, 2, 5, 10, 15, 20, 30, 50)
#: What the paper chose for both.
CHOSEN = 15
#: Rounds of which the quickest counts: other programs only ever make a solver slower.
_ROUNDS = 3
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
    for anew, start in ((False, "from the last frame"), (True, "every frame anew")):
        for name in ("rho", "epsilon"):
            rows = yield from vary(case, name, anew)
            other = "epsilon" if name == "rho" else "rho"
            tables.append(Table(f"{name}, {other} = {CHOSEN}, {start}", _COLUMNS, rows))
    return Report("iterations", tables, [
        f"{len(film.seen)} frames of {film.name}; rho: iterations for the pose, epsilon: for the "
        "expression, at most: both stop where nothing improves; ms: median processor time of a "
        f"frame, the best of {_ROUNDS} rounds; shown: coefficients above 0.3 in the truth",
        "[FaceIt19] needs 31.6 ms with rho = epsilon = 15",
    ])  # fmt: skip


def vary(case: Case, name: str, anew: bool) -> Generator[Progress, None, dict[str, Sequence[Cell]]]:
    """Return a row of figures for each number of iterations.

    Args:
        case: What to solve.
        name: "rho" or "epsilon".
        anew: Every frame is solved as if it were the first.

    Yields:
        Progress, once per number and round.
    """
    rows: dict[str, Sequence[Cell]] = {}
    best_ms = dict.fromkeys(COUNTS, float("inf"))
    for done in range(_ROUNDS * len(COUNTS)):
        count = COUNTS[done % len(COUNTS)]
        figures = figures_of([solve(case, settings_for(name, count), anew)])
        best_ms[count] = min(best_ms[count], figures["ms"])
        figures["ms"] = best_ms[count]
        rows[f"{name} {count}"] = [figures[column] for column in _SHOWN]
        yield Progress(done + 1, _ROUNDS * len(COUNTS), f"Solving with {name} {count}")
    return rows


def settings_for(name: str, count: int) -> EnergySettings:
    """Return the paper's solver with so many iterations rho or epsilon, the other as chosen."""
    rho, epsilon = (count, CHOSEN) if name == "rho" else (CHOSEN, count)
    paper = PaperSettings(pose_iterations=rho, expression_iterations=epsilon)
    return EnergySettings(solver="paper", paper=paper, pose_filter=None)
