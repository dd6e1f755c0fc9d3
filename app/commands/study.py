"""`facepuppet study NAME`: the papers' experiments."""

import argparse
import sys
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

import cv2

from app.commands.progress import TerminalProgress
from app.models import Models, load_models
from app.studies import bu, conditions, iterations, pose, robust, solvers, still
from app.studies.report import Report
from core.plain_json import json_text
from core.records import Progress

DESCRIPTION = (
    "Repeat an experiment of the papers: pose, iterations, solvers, conditions, robust, still, bu."
)


@dataclass(frozen=True, slots=True)
class Study:
    """An experiment.

    Attributes:
        help: What it asks.
        add_options: Adds its own options to a parser.
        run: (options, models) -> steps that return a report.
    """

    help: str
    add_options: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace, Models], Generator[Progress, None, Report]]


STUDIES: dict[str, Study] = {
    "pose": Study(pose.HELP, pose.add_options, pose.run),
    "bu": Study(bu.HELP, bu.add_options, bu.run),
    "iterations": Study(iterations.HELP, iterations.add_options, iterations.run),
    "solvers": Study(solvers.HELP, solvers.add_options, solvers.run),
    "conditions": Study(conditions.HELP, conditions.add_options, conditions.run),
    "robust": Study(robust.HELP, robust.add_options, robust.run),
    "still": Study(still.HELP, still.add_options, still.run),
}


def add_parser(commands: Any) -> None:
    """Add the command, its studies and their options."""
    parser = commands.add_parser("study", help=DESCRIPTION, description=DESCRIPTION)
    studies = parser.add_subparsers(title="studies", metavar="NAME", required=True)
    for name, study in STUDIES.items():
        one = studies.add_parser(name, help=study.help, description=study.help)
        study.add_options(one)
        one.add_argument("--json", action="store_true", help="print the tables as JSON")
        one.set_defaults(run=run, study=study)


def run(args: argparse.Namespace) -> int:
    """Run a study and print what it found; return the exit code."""
    # The thread clock sees one thread only, so OpenCV must not use others.
    cv2.setNumThreads(1)
    steps = args.study.run(args, load_models())
    report: Report = TerminalProgress(sys.stderr).follow(steps)
    sys.stdout.write((json_text(report.values()) if args.json else report.text()) + "\n")
    return 0
