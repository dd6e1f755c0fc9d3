"""`facepuppet track [PROFILE] SOURCE`: follow a face through a video, images or a camera."""

import argparse
import signal
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from app.capture.source import FrameSource, expected_frames
from app.commands.modes import FrameTracker, Way, add_source_and_mode, way_of
from app.commands.progress import TerminalProgress
from app.painting import AVATARS, OWN, AvatarPainter, make_avatar
from app.recording.outputs import Outputs
from app.recording.table import Table
from app.recording.track_file import TrackFile
from app.recording.video import SideBySideVideo
from app.sources import open_source
from core.camera import camera_for
from core.plain_json import json_text
from core.records import Camera, Progress, UserBlendshapes

if TYPE_CHECKING:
    from app.models import Models

DESCRIPTION = "Track a video file, a folder of images or a camera, with or without a profile."
#: Output suffixes of --out.
ARRAYS, TABLE = ".npz", ".csv"


@dataclass(frozen=True, slots=True)
class TrackSummary:
    """What is told at the end of a track.

    Attributes:
        frames: Frames tracked.
        lost: Frames without a face.
        step_ms: Median wall time to solve one frame, without reading and writing.
        note: What else the user should know, or "".
    """

    frames: int
    lost: int
    step_ms: float
    note: str


def add_parser(commands: Any) -> None:
    """Add the command and its options."""
    parser = commands.add_parser("track", help=DESCRIPTION, description=DESCRIPTION)
    add_source_and_mode(parser)
    parser.add_argument(
        "--out", metavar="FILE", type=output_path, action="append", default=[],
        help="write the track: .npz arrays or .csv table; may be given twice",
    )  # fmt: skip
    parser.add_argument(
        "--video", metavar="FILE", type=Path, help="write the source beside the avatar: .mp4"
    )
    parser.add_argument("--avatar", choices=AVATARS, default=OWN, help="the avatar of --video")
    parser.add_argument("--frames", type=int, metavar="N", help="stop after N frames")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    parser.set_defaults(run=run)


def output_path(text: str) -> Path:
    """Return the path of an output whose suffix is known."""
    path = Path(text)
    if path.suffix.lower() not in (ARRAYS, TABLE):
        raise argparse.ArgumentTypeError(f"{text}: expected a name ending in {ARRAYS} or {TABLE}")
    return path


def run(args: argparse.Namespace) -> int:
    """Track and write; return the exit code."""
    from app.models import load_models

    way = way_of(args)
    size_px = (640, 480) if way.profile is None else way.profile.camera.size_px
    with ExitStack() as opened:
        source = opened.enter_context(open_source(args.source, size_px))
        outputs = opened.enter_context(Outputs())
        models = load_models()
        tracker = way.tracker(models, source, args.source)
        for path in args.out:
            outputs.add(_file_sink(path, lambda: tracker.camera, way.mode))
        if args.video:
            outputs.add(_film(args, models, source, user_of(way, tracker, source), opened))
        stopped = opened.enter_context(interrupt_ends(source.live))
        steps = track(source, tracker, outputs, args.frames, stopped)
        summary = TerminalProgress(sys.stderr).follow(steps)
    _tell(summary, args)
    return 0


def user_of(way: Way, tracker: FrameTracker, source: FrameSource) -> UserBlendshapes | None:
    """Return whose head the own avatar has, None where it is not known before tracking."""
    from core.free_live import FreeTracker

    if way.profile is not None:
        return way.profile.user
    if isinstance(tracker, FreeTracker) and not source.live:
        return tracker.user
    return None


def _film(
    args: argparse.Namespace, models: "Models", source: FrameSource,
    user: UserBlendshapes | None, opened: ExitStack,
) -> SideBySideVideo:  # fmt: skip
    """Return the film of source and avatar; its painter is released with what is opened."""
    avatar = make_avatar(args.avatar, models.face_model, user)
    # A portrait needs the size of the pictures, not the focal length.
    painter = AvatarPainter(avatar, camera_for(source.size_px, max(source.size_px)), user)
    opened.callback(painter.release)
    return SideBySideVideo(args.video, source.fps, source.size_px, painter.paint)


def track(
    source: FrameSource,
    tracker: FrameTracker,
    outputs: Outputs,
    most_frames: int | None = None,
    stopped: Callable[[], bool] = lambda: False,
) -> Generator[Progress, None, TrackSummary]:
    """Follow the face through a source and write every state.

    Args:
        source: Read to its end.
        tracker: Solves the frames.
        outputs: Take frames and states.
        most_frames: Stop after so many.
        stopped: Asked before every frame.

    Yields:
        Progress, once per frame; its total is 0 where the number of frames is not known.
    """
    promised = most_frames or expected_frames(source)
    label = f"Tracking {source.name}" + (" (Ctrl-C ends)" if source.live else "")
    times_ms: list[float] = []
    lost = 0
    while len(times_ms) != most_frames and not stopped():
        frame = source.read()
        if frame is None:
            break
        before_s = time.perf_counter()
        state = tracker.step(frame)
        times_ms.append(1000 * (time.perf_counter() - before_s))
        lost += state.lost
        outputs.write(frame, state)
        yield Progress(len(times_ms), max(promised, len(times_ms)) if promised else 0, label)
    step_ms = float(np.median(times_ms)) if times_ms else 0.0
    return TrackSummary(len(times_ms), lost, step_ms, _note(source, most_frames))


@contextmanager
def interrupt_ends(live: bool) -> Iterator[Callable[[], bool]]:
    """Make Ctrl-C end a live recording as wished, not break it off; yields "was it pressed"."""
    pressed = threading.Event()
    if not live:
        yield pressed.is_set
        return
    before = signal.signal(signal.SIGINT, lambda *_: pressed.set())
    try:
        yield pressed.is_set
    finally:
        signal.signal(signal.SIGINT, before)


def _note(source: FrameSource, most_frames: int | None) -> str:
    cut_short: Callable[[], bool] = getattr(source, "cut_short", lambda: False)
    if most_frames is None and cut_short():
        return f"{source.name} ended before the number of frames it promises: it may be damaged"
    return ""


def _file_sink(path: Path, camera: Callable[[], Camera], mode: str) -> Any:
    return TrackFile(path, camera, mode) if path.suffix.lower() == ARRAYS else Table(path)


def _tell(summary: TrackSummary, args: argparse.Namespace) -> None:
    if summary.note:
        sys.stderr.write(f"note: {summary.note}\n")
    written = [str(path) for path in [*args.out, args.video] if path]
    if args.json:
        figures = {
            "frames": summary.frames, "lost": summary.lost, "step_ms": summary.step_ms,
            "written": written, "note": summary.note,
        }  # fmt: skip
        sys.stdout.write(json_text(figures) + "\n")
        return
    sys.stdout.write(
        f"{summary.frames} frames, {summary.lost} without a face, "
        f"{summary.step_ms:.1f} ms per frame\n"
    )
    for path in written:
        sys.stdout.write(f"wrote {path}\n")
