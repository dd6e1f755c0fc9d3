"""`facepuppet evaluate [PROFILE] SOURCE`: a track against the generic aligner, frame by frame."""

import argparse
import sys
import time
from collections.abc import Generator, Mapping
from typing import Any, Protocol

import numpy as np

from app.capture.source import FrameSource, expected_frames
from app.commands.modes import FrameTracker, add_source_and_mode, way_of
from app.commands.progress import TerminalProgress
from app.sources import open_source
from core.alignment import Alignment
from core.evaluation import against_reference
from core.landmarks import N_INTERNAL
from core.plain_json import json_text
from core.records import U8, Progress

DESCRIPTION = "Compare a track with the generic aligner run independently on every frame."


class ReferenceAligner(Protocol):
    """What is needed of the generic aligner."""

    def first(self, rgb: U8) -> Alignment | None:
        """Return the landmarks of the largest face."""
        ...


def add_parser(commands: Any) -> None:
    """Add the command and its options."""
    parser = commands.add_parser("evaluate", help=DESCRIPTION, description=DESCRIPTION)
    add_source_and_mode(parser)
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Track, align, compare; return the exit code."""
    from app.models import load_models

    way = way_of(args)
    with open_source(args.source) as source:
        models = load_models()
        steps = evaluate(source, way.tracker(models, source, args.source), models.aligner)
        report = TerminalProgress(sys.stderr).follow(steps)
    text = json_text(report) if args.json else report_text(report)
    sys.stdout.write(text + "\n")
    return 0


def evaluate(
    source: FrameSource, tracker: FrameTracker, aligner: ReferenceAligner
) -> Generator[Progress, None, dict[str, object]]:
    """Track a source and compare with the aligner, which remembers nothing between frames.

    Compared are the internal landmarks: on the outline the schemes mean different points.

    Yields:
        Progress, once per frame.

    Returns:
        The table of [Cao13, table 1] and the time per frame.
    """
    promised = expected_frames(source)
    states, reference, step_ms, cpu_ms = [], [], [], []
    for frame in iter(source.read, None):
        wall_s, cpu_s = time.perf_counter(), time.process_time()
        states.append(tracker.step(frame))
        step_ms.append(1000 * (time.perf_counter() - wall_s))
        cpu_ms.append(1000 * (time.process_time() - cpu_s))
        found = aligner.first(frame.rgb)
        unseen = np.full((N_INTERNAL, 2), np.nan)
        reference.append(found.landmarks.points_px[:N_INTERNAL] if found else unseen)
        yield Progress(len(states), max(promised, len(states)), f"Evaluating {source.name}")
    rows = range(N_INTERNAL)
    report = against_reference(states, np.array(reference), rows, source.size_px[0])
    return report | {
        "step_ms_median": float(np.median(step_ms)),
        "step_cpu_ms_median": float(np.median(cpu_ms)),
        "step_cpu_ms_mean": float(np.mean(cpu_ms)),
    }


def report_text(report: Mapping[str, Any]) -> str:
    """Return the report as lines for people."""
    lines = [
        f"frames             {report['frames']}, {report['lost']} lost, "
        f"{report['compared']} compared with the generic aligner"
    ]
    lines += [
        f"RMSE under {limit + ' px':<7} {100 * share:.1f} %"
        for limit, share in report["share_under_px"].items()
    ]
    lines += [
        f"RMSE               median {report['median_rmse_px']:.2f} px, "
        f"worst {report['worst_rmse_px']:.2f} px, at 640 px width",
        f"jitter when still  {report['jitter_px']:.2f} px (the aligner's own: "
        f"{report['jitter_reference_px']:.2f} px), {report['jitter_rotation_deg']:.2f} degrees, "
        f"over {report['still_frames']} frames",
        f"time per frame     {report['step_ms_median']:.2f} ms median, "
        f"{report['step_cpu_ms_mean']:.2f} ms CPU on average",
    ]
    return "\n".join(lines)
