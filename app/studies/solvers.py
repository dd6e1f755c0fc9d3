"""The paper's solver against ours: error, jitter, time in one table."""

import argparse
from collections.abc import Generator, Sequence

import numpy as np

from app.models import Models
from app.performer.opening import Scenario
from app.studies.film import perform
from app.studies.report import Cell, Column, Report, Table
from app.studies.solving import case_of, figures_of, noise_of, solve
from core.energy_terms import PaperSettings
from core.energy_tracker import EnergySettings
from core.records import Progress

HELP = "the paper's solver against our joint one: error, jitter, time"
_FIGURES = ("rotation deg", "place mm", "coefficients", "shown", "landmarks px")
_COLUMNS = (
    *(Column(name, 3) for name in _FIGURES),
    Column("noise deg", 3), Column("noise coeff.", 4), Column("ms", 3),
)  # fmt: skip

#: Eq. 12 with walls wide enough for a derivative to feel them.
_WIDENED = PaperSettings(bounds="barrier", barrier_a=1.01, barrier_b=5e-3, barrier_c=np.pi**2 / 4)
SOLVERS: dict[str, EnergySettings] = {
    "paper, eq. 12 as printed": EnergySettings(
        solver="paper", paper=PaperSettings(bounds="barrier"), pose_filter=None
    ),
    "paper, eq. 12 widened": EnergySettings(solver="paper", paper=_WIDENED, pose_filter=None),
    "paper, bounds": EnergySettings(
        solver="paper", paper=PaperSettings(bounds="box"), pose_filter=None
    ),
    "joint, 68 landmarks": EnergySettings(solver="joint", n_landmarks=68, pose_filter=None),
    "joint, 75 landmarks": EnergySettings(solver="joint", n_landmarks=75, pose_filter=None),
    "as used": EnergySettings(),
}


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of this study."""
    parser.add_argument(
        "--frames", type=int, default=200, metavar="N",
        help="of each of three takes (default: 200)",
    )  # fmt: skip
    parser.add_argument("--person", default="mara", help="who performs (default: mara)")


def run(args: argparse.Namespace, models: Models) -> Generator[Progress, None, Report]:
    """Film two moving takes and a still one, solve them in every way.

    Yields:
        Progress of filming, then of solving.
    """
    cases = []
    for take in ("mixed", "head_motion", "statue"):
        film = yield from perform(Scenario(take, args.person), models, args.frames)
        cases.append(case_of(film, models))
    rows: dict[str, Sequence[Cell]] = {}
    for name, settings in SOLVERS.items():
        *moving, still = (solve(case, settings) for case in cases)
        figures = figures_of(moving)
        rows[name] = [*(figures[f] for f in _FIGURES), *noise_of(still), figures["ms"]]
        yield Progress(len(rows), len(SOLVERS), "Solving")
    return Report("solvers", [Table("Solvers", _COLUMNS, rows)], [
        f"errors and time on {' and '.join(case.film.name for case in cases[:-1])}; noise on a "
        "still face, the worst angle; ms: median processor time of a frame",
        "all have the same learned face and the true focal length; as used: with its pose filter",
    ])  # fmt: skip
