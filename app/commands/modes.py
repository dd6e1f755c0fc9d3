"""The ways of tracking, as the commands offer them."""

import argparse
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from app.capture.source import FrameSource
from app.commands.setup import positive
from app.errors import AppError
from app.profiles import profile_folder
from app.sources import SOURCE_HELP, open_source
from core.camera import camera_for
from core.records import Camera, FaceState, Frame

if TYPE_CHECKING:
    from app.models import Looking, Models
    from core.detection_policy import Detection
    from core.free_live import FreeTracker
    from core.store import Profile

TRAINED, FREE, AUTO = "trained", "free", "auto"
MODES = (TRAINED, FREE, AUTO)


class ModeError(AppError):
    """The mode and what else was asked for do not go together."""


class FrameTracker(Protocol):
    """What a track needs of every kind of tracker."""

    @property
    def camera(self) -> Camera:
        """The camera in pixels of the last frame."""
        ...

    def step(self, frame: Frame) -> FaceState:
        """Return the face in a frame."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """How a source is to be tracked.

    Attributes:
        mode: One of MODES.
        profile: None without one.
        focal_px: Of the source's pictures, None if it is not known.
        detection: How often the network looks in the training-free mode; None: every frame of
            recordings, when it is needed with live sources.
    """

    mode: str
    profile: "Profile | None"
    focal_px: float | None
    detection: "Detection | None"

    def tracker(self, models: "Models", source: FrameSource, name: str) -> FrameTracker:
        """Return the tracker of a source.

        Without a profile the person's face and the focal length are learned from the beginning of
        a recording, so that its first frames are solved as well as its last ones.

        Args:
            models: The shipped models.
            source: To be tracked; not read here.
            name: What the source was called: a recording is opened once more.
        """
        from app.models import auto_tracker, free_tracker, live_tracker

        profile, looking = self.profile, self._looking(source)
        if profile is not None and self.mode != FREE:
            if self.mode == TRAINED:
                return live_tracker(models, profile)
            return auto_tracker(models, profile, looking)
        user = None if profile is None else profile.user
        tracker = free_tracker(models, self._camera(source), looking, user)
        if user is None and not source.live:
            learn(tracker, name)
        return tracker

    def _camera(self, source: FrameSource) -> Camera | None:
        if self.focal_px is not None:
            return camera_for(source.size_px, self.focal_px)
        return None if self.profile is None else self.profile.camera

    def _looking(self, source: FrameSource) -> "Looking":
        from app.models import LIVE, Looking

        if self.detection is None:
            return LIVE if source.live else Looking()
        return Looking(self.detection, measured=source.live)


def learn(tracker: "FreeTracker", name: str) -> None:
    """Let a tracker see the beginning of a recording, and forget where the face was."""
    from app.models import LEARNING_S

    with open_source(name) as beginning:
        for _ in range(round(LEARNING_S * beginning.fps)):
            frame = beginning.read()
            if frame is None:
                break
            tracker.step(frame)
    tracker.reset()


def add_source_and_mode(parser: Any) -> None:
    """Add the profile, the source and the options of the mode."""
    parser.add_argument(
        "profile", metavar="PROFILE", nargs="?", help="name or path of a profile, if there is one"
    )
    parser.add_argument("source", metavar="SOURCE", help=SOURCE_HELP)
    parser.add_argument(
        "--mode", choices=MODES,
        help="trained: with the profile's regressor (default with a PROFILE); free: any face, "
        "without setup (default without); auto: trained where the profile fits, else free",
    )  # fmt: skip
    parser.add_argument(
        "--focal", type=positive, metavar="PX",
        help="mode free: focal length in px of the source, if known; else it is found",
    )  # fmt: skip
    parser.add_argument(
        "--detection", type=detection, metavar="WHEN",
        help="modes free and auto: the landmark network looks at 'every' frame, every N-th for a "
        "number, or 'adaptive' as needed (default: every; adaptive with a camera)",
    )  # fmt: skip


def detection(text: str) -> "Detection":
    """Return how often the network looks."""
    if text == "every":
        return "every"
    if text == "adaptive":
        return "adaptive"
    if text.isdecimal() and int(text) >= 1:
        return int(text)
    raise argparse.ArgumentTypeError(f"{text}: expected every, adaptive, or a number above 0")


def way_of(args: argparse.Namespace) -> Way:
    """Return what the options ask for, the profile loaded.

    Raises:
        ModeError: The options do not go together.
        AppError, CoreError: The profile cannot be used.
    """
    from core.store import load

    mode = args.mode or (FREE if args.profile is None else TRAINED)
    if mode != FREE and args.profile is None:
        raise ModeError(
            f"--mode {mode} needs a profile, found only the source {args.source}; make one by "
            "facepuppet setup PROFILE SOURCE, or use --mode free"
        )
    if mode != FREE and args.focal is not None:
        raise ModeError(
            f"--focal {args.focal:g} does not go with --mode {mode}: the profile has the focal "
            "length already; leave it out, or use --mode free"
        )
    if mode == TRAINED and args.detection is not None:
        raise ModeError(
            "--detection does not go with --mode trained, which hardly needs the landmark "
            "network; leave it out, or use --mode free or auto"
        )
    profile = None if args.profile is None else load(profile_folder(args.profile))
    return Way(mode, profile, args.focal, args.detection)
