"""`facepuppet bench`: how long every stage takes on this machine."""

import argparse
import sys
import time
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from itertools import islice
from typing import Any, TypeVar

import cv2
import numpy as np

from app.commands.progress import TerminalProgress
from app.models import Models, live_tracker, load_models
from app.painting import AvatarPainter, make_avatar
from app.performer.opening import Scenario, open_performer, setup_pictures
from app.setup_steps import Pictures, make_profile, unseen
from core.camera import project
from core.evaluation import frame_rmse_px
from core.live import tracker_model
from core.plain_json import json_text
from core.records import FaceState, FloatArray, Frame, Progress, SetupImages
from core.regressor import Regression
from core.setup_plan import standard_for
from core.store import Profile
from core.tracker import Tracker

T = TypeVar("T")

DESCRIPTION = "Measure the speed of every stage on the virtual performer, at 640x480."
#: Frames measured, after as many for warming up.
N_FRAMES, WARM_UP = 150, 20
#: Label of the pipeline's progress while it trains.
TRAINING = "Training the regressor"


@dataclass(frozen=True, slots=True)
class Row:
    """One measured stage.

    Attributes:
        stage: What was measured.
        value: Median CPU time of one thread in ms, or wall time in s.
        unit: "ms" or "s".
        target: What we want, in the same unit, None without a target.
        paper: What [Cao13] reports, None if it does not.
    """

    stage: str
    value: float
    unit: str
    target: float | None = None
    paper: float | None = None


def add_parser(commands: Any) -> None:
    """Add the command and its options."""
    parser = commands.add_parser("bench", help=DESCRIPTION, description=DESCRIPTION)
    parser.add_argument("--json", action="store_true", help="print the figures as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure and print; return the exit code."""
    # The thread clock sees one thread only, so OpenCV must not use others.
    cv2.setNumThreads(1)
    models, progress = load_models(), TerminalProgress(sys.stderr)
    sys.stderr.write("Filming the virtual performer\n")
    filmed = setup_pictures(Scenario())
    with open_performer(Scenario(take="talking")) as source:
        frames = list(islice(iter(source.read, None), N_FRAMES + WARM_UP))
    profile, rows = measure_setup(models, filmed, progress)
    rows += measure_live(models, profile, frames)
    rows += measure_aligner(models, frames)
    rows += measure_avatar(models, profile, frames)
    table = [row_dict(row) for row in rows]
    sys.stdout.write((json_text(table) if args.json else table_text(rows)) + "\n")
    return 0


def measure_setup(
    models: Models, filmed: Iterable[tuple[str, Frame, Any]], progress: TerminalProgress
) -> tuple[Profile, list[Row]]:
    """Return a profile made from setup pictures, and how long that took."""
    shots = [(name, frame) for name, frame, _ in filmed]
    images = SetupImages(
        tuple(frame.rgb for _, frame in shots),
        tuple(name for name, _ in shots),
        np.stack([standard_for(name) for name, _ in shots]),
    )
    started_s = time.perf_counter()
    found = [models.aligner.first(image) for image in images.images]
    landmarks = tuple(one.landmarks if one else unseen() for one in found)
    seconds: dict[str, float] = {}
    steps = make_profile(
        models.face_model, Pictures(images, landmarks, ()), None, np.random.default_rng(1)
    )
    profile, _ = progress.follow(time_by_label(steps, seconds))
    whole_s = time.perf_counter() - started_s
    return profile, [
        Row("training, 2 cores", seconds[TRAINING], "s", target=30.0),
        Row("60 pictures to profile, 2 cores", whole_s, "s", target=90.0, paper=600.0),
    ]


def measure_live(models: Models, profile: Profile, frames: list[Frame]) -> list[Row]:
    """Return the time of regression, tracking and both with their checks, per frame."""
    live = live_tracker(models, profile)
    states: list[FaceState] = []
    step_ms = times_ms(lambda frame: states.append(live.step(frame)), frames)
    regression = Regression(profile.regressor, profile.camera)
    previous = nearest_shape(profile, states[0])
    shapes = []

    def regress(frame: Frame) -> None:
        nonlocal previous
        previous = regression.run(frame.gray, previous).points_mm
        shapes.append((previous, frame.time_s))

    regress_ms = times_ms(regress, frames)
    tracker = Tracker(tracker_model(models.face_model, profile.user), models.prior)
    track_ms = times_ms(lambda shape: tracker.step(*shape), shapes)
    return [
        Row("regression", regress_ms, "ms", target=1.0, paper=5.0),
        Row("tracking", track_ms, "ms", target=0.3, paper=8.0),
        Row("whole live step", step_ms, "ms", paper=15.0),
    ]


def nearest_shape(profile: Profile, state: FaceState) -> FloatArray:
    """Return the setup shape (Q, 3) that lies nearest to a tracked face in the picture."""
    n_landmarks = len(state.landmarks_px)
    places = project(profile.camera, profile.shapes.points_mm[:, :n_landmarks])
    nearest = int(frame_rmse_px(places, state.landmarks_px).argmin())
    return np.asarray(profile.shapes.points_mm[nearest])


def measure_aligner(models: Models, frames: list[Frame]) -> list[Row]:
    """Return the time of the generic aligner on a first and on a following frame."""
    aligner, few = models.aligner, frames[: N_FRAMES // 3]
    previous = aligner.first(few[0].rgb)
    first_ms = times_ms(lambda frame: aligner.first(frame.rgb), few)
    follow_ms = times_ms(lambda frame: aligner.follow(frame.rgb, previous), few)
    return [
        Row("generic aligner, first frame", first_ms, "ms"),
        Row("generic aligner, following", follow_ms, "ms"),
    ]


def measure_avatar(models: Models, profile: Profile, frames: list[Frame]) -> list[Row]:
    """Return the time of an avatar's picture."""
    live = live_tracker(models, profile)
    states = [live.step(frame) for frame in frames[: N_FRAMES // 3]]
    painter = AvatarPainter(make_avatar("nora", models.face_model), profile.camera)
    try:
        return [Row("avatar picture", times_ms(painter.paint, states), "ms")]
    finally:
        painter.release()


def times_ms(step: Callable[[T], object], inputs: Iterable[T]) -> float:
    """Return the median CPU time of this thread for a step, the first ones not counted."""
    times_s = []
    for given in inputs:
        before_s = time.thread_time()
        step(given)
        times_s.append(time.thread_time() - before_s)
    return 1000 * float(np.median(times_s[WARM_UP:]))


def time_by_label(
    steps: Generator[Progress, None, T], seconds: dict[str, float]
) -> Generator[Progress, None, T]:
    """Pass a generator through, adding up the wall time of each label of its progress."""
    label, since_s = "", time.perf_counter()
    while True:
        try:
            progress = next(steps)
        except StopIteration as end:
            seconds[label] = seconds.get(label, 0.0) + time.perf_counter() - since_s
            return end.value  # type: ignore[no-any-return]
        now_s = time.perf_counter()
        seconds[label] = seconds.get(label, 0.0) + now_s - since_s
        label, since_s = progress.label, now_s
        yield progress


def row_dict(row: Row) -> dict[str, object]:
    """Return a row as JSON values."""
    return {
        "stage": row.stage, "value": row.value, "unit": row.unit, "target": row.target,
        "paper": row.paper,
    }  # fmt: skip


def table_text(rows: Iterable[Row]) -> str:
    """Return the rows as a table."""

    def number(value: float | None, unit: str) -> str:
        return "" if value is None else f"{value:.2f} {unit}"

    lines = [f"{'stage':<34}{'here':>12}{'wanted':>12}{'[Cao13]':>12}"]
    for row in rows:
        cells = [number(value, row.unit) for value in (row.value, row.target, row.paper)]
        lines.append(f"{row.stage:<34}" + "".join(f"{cell:>12}" for cell in cells))
    return "\n".join([*lines, "ms: CPU time of one thread, median; s: wall time"])
