"""The steps from a source of setup pictures to a profile, as generators for terminal and window."""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from app.capture.folder import setup_pictures
from app.capture.video import VideoSource
from app.errors import SeveralFacesError, TooFewPicturesError
from app.profiles import encoded_pictures
from app.replacing import REPLACING, check_edition
from core.alignment import Alignment
from core.arkit import EXPRESSION_NAMES
from core.blind_pictures import prompt_of, rows_of_shapes
from core.calibration import Before
from core.errors import NoFaceError
from core.face_model import FaceModel
from core.face_regions import FaceBox
from core.frame_selection import Candidate, candidate, choose
from core.free_comparison import free_report
from core.held_out_pairs import HeldOutSettings, Measured
from core.landmarks import N_LANDMARKS
from core.pipeline import LEAST_PICTURES, BuildSettings, Built, build
from core.records import U8, Frame, Landmarks2D, Progress, SetupImages
from core.setup_plan import standard_for
from core.store import Profile, save

#: A second face this much as wide as the largest is somebody, not a picture on the wall.
RIVAL_SHARE = 0.6
#: Frames chosen from a video, and how many are looked at for that: 20 ms each.
N_PICTURES, MOST_EXAMINED = 60, 700
#: Names listed in a note before it is cut.
MOST_NAMES = 5


class Aligner(Protocol):
    """What is needed of the generic aligner."""

    def detect(self, rgb: U8) -> list[FaceBox]:
        """Return the faces, the largest first."""
        ...

    def first(self, rgb: U8) -> Alignment | None:
        """Return the landmarks of the largest face."""
        ...

    def follow(self, rgb: U8, previous: Alignment | None) -> Alignment | None:
        """Return the landmarks of the face near the previous one, or of the largest."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Pictures:
    """Setup pictures with their landmarks.

    Attributes:
        images: N pictures.
        landmarks: Theirs; confidence 0 where no face was found.
        notes: What the user should know about the pictures.
        automatic: The landmarks as the aligner found them, before any correction; nothing where
            none was corrected.
        before: What an earlier training of the same person found with the same camera.
    """

    images: SetupImages
    landmarks: tuple[Landmarks2D, ...]
    notes: tuple[str, ...]
    automatic: tuple[Landmarks2D, ...] = ()
    before: Before | None = None


def collect(source: Path, aligner: Aligner) -> Generator[Progress, None, Pictures]:
    """Return the setup pictures of a folder, or those chosen from a video, with landmarks.

    Raises:
        AppError: The source cannot be read, or shows several people.
        NoFaceError: No picture shows a face.
    """
    if source.is_dir():
        return (yield from from_folder(source, aligner))
    return (yield from from_video(source, aligner))


def from_folder(folder: Path, aligner: Aligner) -> Generator[Progress, None, Pictures]:
    """Return all pictures of a folder; those named by a shot have standard coefficients."""
    rgbs, names = setup_pictures(folder)
    landmarks = []
    for done, (name, rgb) in enumerate(zip(names, rgbs, strict=True), 1):
        check_one_person(aligner.detect(rgb), name)
        found = aligner.first(rgb)
        landmarks.append(found.landmarks if found else unseen())
        yield Progress(done, len(names), "Finding landmarks")
    blind = [n for n, marks in zip(names, landmarks, strict=True) if not marks.confidence.any()]
    if len(blind) == len(names):
        raise NoFaceError(f"any of the {len(names)} pictures of {folder}")
    standard = np.stack([standard_for(name) for name in names])
    return Pictures(SetupImages(rgbs, names, standard), tuple(landmarks), blind_notes(blind))


def blind_notes(names: Sequence[str]) -> tuple[str, ...]:
    """Return what to tell about pictures in which no face was found."""
    prompted = [name for name in names if prompt_of(name)]
    others = [name for name in names if name not in prompted]
    notes = []
    if prompted:
        notes.append(
            f"no face found in {listed(prompted)}: placed by the prompt, not trained on "
            "unless you place landmarks"
        )
    if others:
        notes.append(f"no face found in {listed(others)}: left out")
    return tuple(notes)


def from_video(path: Path, aligner: Aligner) -> Generator[Progress, None, Pictures]:
    """Return about 60 pictures chosen from a video for their sharpness and variety.

    The video is read twice, so that only the chosen frames are held in memory.
    """
    with VideoSource(path) as video:
        every = max(1, round(video.n_frames / MOST_EXAMINED))
        found = yield from _examine(video, aligner, every)
        if not found:
            raise NoFaceError(f"any frame of {path}")
        notes = [f"{path.name} ended early: it may be damaged"] if video.cut_short() else []
    chosen = choose([one for one, _ in found], N_PICTURES)
    if len(chosen) < LEAST_PICTURES:
        raise TooFewPicturesError(path.name, len(chosen), LEAST_PICTURES)
    landmarks = {one.index: marks for one, marks in found}
    frames = yield from _pick(path, chosen)
    alone = [frame for frame in frames if not rivals(aligner.detect(frame.rgb))]
    if len(alone) < max(LEAST_PICTURES, len(frames) // 2):
        raise SeveralFacesError(f"most frames of {path.name}", 2)
    if len(alone) < len(frames):
        notes.append(f"{len(frames) - len(alone)} frames show several people: left out")
    standard = np.full((len(alone), len(EXPRESSION_NAMES)), np.nan)
    names = tuple(f"frame_{frame.index:05d}" for frame in alone)
    images = SetupImages(tuple(frame.rgb for frame in alone), names, standard)
    return Pictures(images, tuple(landmarks[frame.index] for frame in alone), tuple(notes))


def _examine(
    video: VideoSource, aligner: Aligner, every: int
) -> Generator[Progress, None, list[tuple[Candidate, Landmarks2D]]]:
    """Return what every so many-th frame with a face offers, and its landmarks."""
    found, previous = [], None
    for frame in iter(video.read, None):
        if frame.index % every:
            continue
        previous = aligner.follow(frame.rgb, previous)
        if previous is not None:
            offer = candidate(frame.index, frame.gray, previous)
            found.append((offer, previous.landmarks))
        total = max(video.n_frames, frame.index + 1)
        yield Progress(frame.index, total, "Looking for good frames")
    return found


def _pick(path: Path, chosen: Sequence[int]) -> Generator[Progress, None, list[Frame]]:
    """Return the frames of these numbers."""
    frames, wanted = [], set(chosen)
    with VideoSource(path) as video:
        for frame in iter(video.read, None):
            if frame.index in wanted:
                frames.append(frame)
                yield Progress(len(frames), len(chosen), "Taking the chosen frames")
    return frames


def make_profile(
    model: FaceModel, pictures: Pictures, focal_px: float | None, rng: np.random.Generator
) -> Generator[Progress, None, tuple[Profile, SetupImages]]:
    """Return a profile made from pictures, and the pictures that went into it."""
    settings = BuildSettings(before=pictures.before)
    built = yield from build(model, pictures.images, pictures.landmarks, focal_px, rng, settings)
    images = built.images
    free = yield from _without_training(model, built, pictures)
    profile = Profile(
        images.names, images.standard, built.landmarks, built.camera, built.fit, built.user,
        built.shapes, built.regressor, built.report | {"free": free}, built.eyes,
    )  # fmt: skip
    return profile, images


def _without_training(
    model: FaceModel, built: Built, pictures: Pictures
) -> Generator[Progress, None, dict[str, object]]:
    """Return how the training-free mode does on the pictures that were tested."""
    report: Mapping[str, Any] = built.report
    names = tuple(report["picture_names"])
    found = dict(zip(pictures.images.names, pictures.automatic or pictures.landmarks, strict=True))
    rows = [built.images.names.index(name) for name in names]
    measured = Measured(names, (), built.camera, rows_of_shapes(built.shapes, rows))
    every = HeldOutSettings().every
    steps = free_report(model, measured, [found[name] for name in names], every)
    while True:
        try:
            step = next(steps)
        except StopIteration as end:
            return end.value  # type: ignore[no-any-return]
        # It takes next to nothing and comes last.
        yield replace(step, done=1, total=1)


def keep(
    folder: Path, profile: Profile, images: SetupImages, begun: str | None = None, **facts: Any
) -> Profile:
    """Write a profile and its pictures; return it with the facts added to its report.

    Args:
        folder: Of the profile.
        profile: To write.
        images: Its pictures.
        begun: The `edition` of what it replaces when the work on it began; None: whatever is
            there is replaced.
        **facts: JSON values.

    Raises:
        ProfileChangedError: There is not any more what the work began with.
        CoreError: It cannot be written.
    """
    told = replace(profile, report=profile.report | facts)
    files = encoded_pictures(images)
    with REPLACING:
        if begun is not None:
            check_edition(folder, begun)
        save(folder, told, files)
    return told


def check_one_person(faces: Sequence[FaceBox], where: str) -> None:
    """Check that one face is clearly the largest.

    Raises:
        SeveralFacesError: It is not.
    """
    others = rivals(faces)
    if others:
        raise SeveralFacesError(where, 1 + others)


def rivals(faces: Sequence[FaceBox]) -> int:
    """Return how many faces beside the largest are about as large."""
    widths = sorted(float(face.size_px[0]) for face in faces)
    return sum(width >= RIVAL_SHARE * widths[-1] for width in widths[:-1])


def unseen() -> Landmarks2D:
    """Return landmarks that say nothing."""
    nothing = np.zeros(N_LANDMARKS)
    return Landmarks2D(
        np.zeros((N_LANDMARKS, 2)), nothing.astype(bool), nothing, np.zeros((2, 2)), np.zeros(2)
    )


def listed(names: Sequence[str]) -> str:
    """Return names as a text that stays short."""
    shown = ", ".join(names[:MOST_NAMES])
    more = len(names) - MOST_NAMES
    return f"{shown} and {more} more" if more > 0 else shown
