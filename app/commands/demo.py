"""`facepuppet demo`: the virtual performer is set up and tracked, and its truth is known."""

import argparse
import sys
import time
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from app.commands.progress import TerminalProgress, duration
from app.commands.track import track
from app.errors import OutputError
from app.models import Models, live_tracker, load_models
from app.painting import OWN, AvatarPainter, make_avatar
from app.performer.opening import (
    LIGHT_NAMES,
    PEOPLE,
    TAKE_NAMES,
    Scenario,
    open_performer,
    setup_pictures,
)
from app.recording.highlights import Highlights
from app.recording.outputs import Outputs
from app.recording.sink import PartialFile
from app.recording.track_file import TrackFile
from app.recording.video import SideBySideVideo
from app.setup_steps import from_folder, keep, listed, make_profile
from core.camera import seen_by
from core.evaluation import Truth, against_truth
from core.generations import check_target
from core.plain_json import json_text
from core.store import Profile

DESCRIPTION = (
    "Let the virtual performer follow the 60 prompts, make a profile, track a take, and report "
    "the errors against the truth."
)
#: What the demo writes into its folder.
PICTURES, PROFILE, REPORT = "setup", "profile", "report.json"
FRAMES, TRACK, VIDEO = "frames.png", "take.npz", "take.mp4"
OURS = {PICTURES, PROFILE, REPORT, FRAMES, TRACK, VIDEO}


@dataclass(frozen=True, slots=True)
class DemoOptions:
    """What the demo plays.

    Attributes:
        out: Folder for pictures, profile, video and report.
        scenario: Person, take, light and camera.
        seed: Of the training.
        frames: Track so many frames of the take only.
    """

    out: Path = Path("demo")
    scenario: Scenario = field(default_factory=Scenario)
    seed: int = 1
    frames: int | None = None


def add_parser(commands: Any) -> None:
    """Add the command and its options."""
    parser = commands.add_parser("demo", help=DESCRIPTION, description=DESCRIPTION)
    parser.add_argument("--out", type=Path, default=Path("demo"), metavar="FOLDER")
    parser.add_argument("--take", choices=TAKE_NAMES, default="mixed")
    parser.add_argument("--person", choices=PEOPLE, default=PEOPLE[0])
    parser.add_argument("--light", choices=LIGHT_NAMES, default=LIGHT_NAMES[0])
    parser.add_argument("--focal", type=float, default=620.0, metavar="PX", help="of the webcam")
    parser.add_argument("--seed", type=int, default=1, help="of all random choices")
    parser.add_argument("--frames", type=int, metavar="N", help="track N frames only")
    parser.add_argument("--json", action="store_true", help="print the whole report as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Play the demo; return the exit code."""
    scenario = Scenario(args.take, args.person, args.light, args.focal, seed=args.seed)
    return play(DemoOptions(args.out, scenario, args.seed, args.frames), args.json)


def play(options: DemoOptions, as_json: bool = False) -> int:
    """Film, set up, track, compare; write everything to the folder and print the figures."""
    started_s = time.monotonic()
    check_folder(options.out)
    progress, models = TerminalProgress(sys.stderr), load_models()
    truths = film_setup(options)
    profile = set_up(options, models, progress)
    report = perform(options, models, profile, progress)
    focal_px = options.scenario.focal_px
    report |= {
        "setup": profile.report,
        "setup_truth_mm": shape_errors_mm(profile, truths),
        "focal_px": profile.camera.focal_px,
        "focal_error_percent": 100 * (profile.camera.focal_px / focal_px - 1),
        "seconds": time.monotonic() - started_s,
    }
    part = PartialFile(options.out / REPORT)
    part.path.write_text(json_text(report), encoding="utf-8")
    part.finish()
    sys.stdout.write((json_text(report) if as_json else report_text(report)) + "\n")
    sys.stderr.write(f"pictures, profile, video, track and report: {options.out.resolve()}\n")
    return 0


def check_folder(out: Path) -> None:
    """Check that the folder is new, or of an earlier demo.

    Raises:
        OutputError: It holds something else.
        ProfileUnwritableError: It cannot be written.
    """
    others = [path.name for path in out.iterdir() if path.name not in OURS] if out.is_dir() else []
    if others:
        found = f"the folder holds other files ({listed(sorted(others))})"
        raise OutputError(out, found)
    check_target(out / PROFILE)


def film_setup(options: DemoOptions) -> dict[str, Truth]:
    """Write the 60 setup pictures; return what is really there by name of the shot."""
    sys.stderr.write("Filming the performer in the 60 setup poses\n")
    folder = options.out / PICTURES
    folder.mkdir(parents=True, exist_ok=True)
    truths = {}
    for name, frame, truth in setup_pictures(options.scenario):
        done, encoded = cv2.imencode(".png", cv2.cvtColor(frame.rgb, cv2.COLOR_RGB2BGR))
        (folder / f"{name}.png").write_bytes(encoded.tobytes() if done else b"")
        truths[name] = truth
    return truths


def set_up(options: DemoOptions, models: Models, progress: TerminalProgress) -> Profile:
    """Make and keep the profile from the pictures, as `facepuppet setup` does."""
    started_s = time.monotonic()
    pictures = progress.follow(from_folder(options.out / PICTURES, models.aligner))
    rng = np.random.default_rng(options.seed)
    steps = make_profile(models.face_model, pictures, None, rng)
    profile, images = progress.follow(steps)
    seconds = time.monotonic() - started_s
    return keep(options.out / PROFILE, profile, images, source="setup", seconds=seconds)


def perform(
    options: DemoOptions, models: Models, profile: Profile, progress: TerminalProgress
) -> dict[str, object]:
    """Track the take, write it, and return its errors."""
    # A take with other details than the setup session had.
    scenario = replace(options.scenario, seed=options.scenario.seed + 1)
    with ExitStack() as opened:
        source = opened.enter_context(open_performer(scenario))
        outputs = opened.enter_context(Outputs())
        tracker = live_tracker(models, profile)
        avatar = make_avatar(OWN, models.face_model, profile.user)
        painter = AvatarPainter(avatar, seen_by(profile.camera, source.size_px), profile.user)
        opened.callback(painter.release)
        expected = min(options.frames or source.n_frames, source.n_frames)
        highlights = Highlights(options.out / FRAMES, source.size_px, painter.paint, expected)
        outputs.add(highlights)
        outputs.add(TrackFile(options.out / TRACK, lambda: tracker.camera))
        video = options.out / VIDEO
        outputs.add(SideBySideVideo(video, source.fps, source.size_px, painter.paint))
        summary = progress.follow(track(source, tracker, outputs, options.frames))
        truths = [source.truth(n) for n in range(summary.frames)]
        errors = against_truth(highlights.states, truths, source.camera)
    return {"take": scenario.take, "step_ms": summary.step_ms, **errors}


def shape_errors_mm(profile: Profile, truths: Mapping[str, Truth]) -> float:
    """Return the mean distance of the setup shapes from the truth, up to the size of the face.

    Size and distance of a face cannot be told apart by one camera: each shape is compared after
    both are moved to the origin and scaled to the same size.
    """
    distances = []
    measured = np.flatnonzero(np.isfinite(profile.shapes.rms_px)).tolist()
    for name, found in ((profile.names[n], profile.shapes.points_mm[n]) for n in measured):
        true = truths[name].points_mm - truths[name].points_mm.mean(axis=0)
        here = found - found.mean(axis=0)
        scale = np.sum(here * true) / np.sum(here**2)
        distances.append(np.linalg.norm(scale * here - true, axis=1).mean())
    return float(np.mean(distances))


def report_text(report: Mapping[str, Any]) -> str:
    """Return the figures that most people want."""
    lines = [
        f"setup           {duration(report['setup']['seconds'])} from pictures to profile, "
        f"{report['setup']['pictures']} pictures, shapes off by {report['setup_truth_mm']:.1f} mm",
        f"focal length    {report['focal_px']:.0f} px, off by "
        f"{report['focal_error_percent']:+.1f} %",
        f"take            {report['take']}: {report['frames']} frames, {report['lost']} lost, "
        f"{report['step_ms']:.1f} ms per frame",
    ]
    if "rmse_px" in report:
        under = report["share_under_px"].items()
        lines += [
            f"landmarks       {report['rmse_px']['mean']:.2f} px RMSE on average, "
            + ", ".join(f"{100 * share:.1f} % under {limit} px" for limit, share in under),
            f"depth           {report['depth_mm']['mean']:.1f} mm on average, below 40 degrees of "
            "yaw and up to the size of the face",
            f"head pose       {report['rotation_deg']['mean']:.1f} degrees",
            f"coefficients    {report['coefficients_mean_abs']:.3f} on average, "
            f"{report['coefficients_active_mean_abs']:.3f} where active",
            f"gaze            {report['gaze_deg']['mean']:.1f} degrees",
        ]
    return "\n".join([*lines, f"time            {duration(report['seconds'])}"])
