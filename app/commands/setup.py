"""`facepuppet setup PROFILE SOURCE`: make a profile; without a source, the guided setup."""

import argparse
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from app.commands.guided import show_setup
from app.commands.progress import TerminalProgress, duration
from app.errors import SourceMissingError
from app.profiles import profile_folder
from core.generations import check_target
from core.plain_json import json_text

DESCRIPTION = (
    "Make a profile from a folder of setup images or from a video of one person; without SOURCE, "
    "show the guided setup with the webcam."
)
#: Inner corners of the chessboard of --chessboard, the pattern that OpenCV prints.
CHESSBOARD = (9, 6)


def add_parser(commands: Any) -> None:
    """Add the command and its options."""
    parser = commands.add_parser("setup", help=DESCRIPTION, description=DESCRIPTION)
    parser.add_argument(
        "profile",
        metavar="PROFILE",
        nargs="?",
        default="",
        help="name of the profile, or a path to keep it at",
    )
    parser.add_argument(
        "source",
        metavar="SOURCE",
        nargs="?",
        help="folder of images named by shot, or a video file",
    )
    parser.add_argument(
        "--focal", type=positive, metavar="PX",
        help="focal length in px of the pictures, if known; else it is found",
    )  # fmt: skip
    parser.add_argument(
        "--chessboard", type=Path, metavar="FOLDER",
        help="find the focal length from pictures of a chessboard with 9x6 inner corners",
    )  # fmt: skip
    parser.add_argument("--seed", type=int, default=1, help="of all random choices")
    parser.add_argument("--json", action="store_true", help="print the whole report as JSON")
    parser.set_defaults(run=run)


def positive(text: str) -> float:
    """Return a number above 0."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text}: expected a number of px above 0")
    return value


def run(args: argparse.Namespace) -> int:
    """Make and keep the profile, or show the guided setup; return the exit code."""
    if args.source is None:
        return show_setup(args.profile)
    from app.models import load_models
    from app.own_looks import likeness_steps
    from app.setup_steps import collect, keep, make_profile

    started_s = time.monotonic()
    folder = profile_folder(args.profile)
    source = existing_files(args.source)
    check_target(folder)
    focal_px = args.focal or chessboard_focal_px(args.chessboard)
    progress = TerminalProgress(sys.stderr)
    models = load_models()
    pictures = progress.follow(collect(source, models.aligner))
    for note in pictures.notes:
        sys.stderr.write(f"note: {note}\n")
    rng = np.random.default_rng(args.seed)
    profile, images = progress.follow(make_profile(models.face_model, pictures, focal_px, rng))
    seconds = time.monotonic() - started_s
    profile = keep(folder, profile, images, source=source.name, seed=args.seed, seconds=seconds)
    progress.follow(likeness_steps(folder, models.face_model))
    text = json_text(profile.report) if args.json else report_text(profile.report)
    sys.stdout.write(text + "\n")
    sys.stderr.write(f"wrote the profile {folder}\n")
    return 0


def existing_files(text: str) -> Path:
    """Return the folder or file of setup pictures that a text names.

    Raises:
        SourceMissingError: There is none; a live camera cannot pose by itself.
    """
    path = Path(text).expanduser()
    if not path.exists():
        raise SourceMissingError(path)
    return path


def chessboard_focal_px(folder: Path | None) -> float | None:
    """Return the focal length that pictures of a chessboard show, None without pictures.

    Raises:
        CoreError, AppError: The pictures cannot be used.
    """
    if folder is None:
        return None
    from app.capture.folder import setup_pictures
    from core.calibration import chessboard_camera

    pictures, _ = setup_pictures(folder)
    return chessboard_camera(pictures, CHESSBOARD).focal_px


def report_text(report: Mapping[str, Any]) -> str:
    """Return the figures of a report that most people want."""
    held_out = report["held_out"]
    under = ", ".join(
        f"{100 * share:.1f} % under {limit} px"
        for limit, share in held_out["share_under_px"].items()
    )
    left_out = f", left out: {', '.join(report['left_out'])}" if report["left_out"] else ""
    if report["guessed"]:
        left_out = f", not trained on: {', '.join(report['guessed'])}{left_out}"
    width, height = report["size_px"]
    return (
        f"pictures        {report['pictures']} of {width}x{height}{left_out}\n"
        f"focal length    {report['focal_px']:.0f} px ({report['focal_source']})\n"
        f"fit             {report['fit_rms_px_at_640']:.2f} px RMS at 640 px width\n"
        f"held-out test   median {held_out['median_rmse_px']:.2f} px RMSE, {under}\n"
        f"time            {duration(report['seconds'])}"
    )
