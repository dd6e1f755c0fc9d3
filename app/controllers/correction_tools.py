"""What corrections need of the rest of the program: preparing, keeping, training."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from app.controllers.editing import is_placed
from app.controllers.frame_book import FrameBook
from app.controllers.player import Performer
from app.errors import AppError
from app.models import live_tracker, load_aligner, load_models
from app.priority import stepping_back, taking_turns
from app.profiles import encoded, pictures_kept, profile_folder
from app.resizing import at_size
from app.resources import asset
from app.workbook import Workbook
from core.draft import Draft, DraftPicture
from core.errors import NoFaceError
from core.face_model import load_face_model
from core.generations import read_generation
from core.landmark_refit import Refitter
from core.landmarks import N_INTERNAL
from core.pipeline import gray_from_rgb
from core.records import U8, FaceState, Frame, Landmarks2D, Progress
from core.state_landmarks import landmarks_of_state, with_outline, with_pupils
from core.store import Profile, load

#: Pictures from the live view are called so, with a number.
KIND = "live"


class NoPicturesError(AppError):
    """A profile cannot be trained again."""

    def __init__(self, profile: str) -> None:
        super().__init__(
            f"the pictures of the profile {profile} were deleted: it cannot be trained again; take "
            "new ones in the guided setup"
        )


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """A frozen frame, ready for the editor."""

    profile: str
    book: FrameBook
    refitter: Refitter


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """A frame that the user has put right.

    Attributes:
        profile: Name of the profile that is to learn from it.
        rgb: (H, W, 3), of the size of the profile's pictures.
        landmarks: As the user left them.
        found: As the tracker had them.
    """

    profile: str
    rgb: U8
    landmarks: Landmarks2D
    found: Landmarks2D


@dataclass(frozen=True, slots=True, eq=False)
class Retrained:
    """A profile after another training: what follows its person now, and what has changed."""

    profile: str
    performer: Performer
    text: str


class Opener(Protocol):
    """What is needed of the toolbox."""

    def open_profile(self, key: str) -> Performer:
        """Load a profile and make its tracker."""
        ...


class CorrectionTools(Protocol):
    """What is needed of the workshop; tests can stand in for it."""

    def prepare(
        self, profile: str, frame: Frame, state: FaceState
    ) -> Generator[Progress, None, Prepared]:
        """Return a frame ready for the editor."""
        ...

    def keep(self, correction: Correction) -> Generator[Progress, None, str]:
        """Keep a correction on the disk; return its name."""
        ...

    def train(self, profile: str) -> Generator[Progress, None, Retrained]:
        """Train a profile with all that was kept."""
        ...

    def unlearned(self, profile: str) -> int:
        """Return how many corrections are kept and not learned yet."""
        ...


class CorrectionWorkshop:
    """Works on the profiles of the user's data folder."""

    def __init__(self, opener: Opener) -> None:
        self._opener = opener

    def prepare(
        self, profile: str, frame: Frame, state: FaceState
    ) -> Generator[Progress, None, Prepared]:
        """Return a frame at the size of the profile's pictures, with the tracker's landmarks.

        Raises:
            CoreError, AppError: The profile cannot be read, or not be trained again; no face was
                ever seen.
        """
        yield Progress(0, 1, "Preparing the frame")
        folder = profile_folder(profile)
        whole, model = load(folder), load_face_model(asset("face_model.npz"))
        if not pictures_kept(folder):
            raise NoPicturesError(profile)
        size_px = (frame.rgb.shape[1], frame.rgb.shape[0])
        found = landmarks_of_state(model, whole.user, whole.camera, state, size_px)
        seen = _find(frame.rgb)
        if seen is not None:
            # A lost face is repeated where it was last; the irises are filtered by the tracker.
            found = seen if state.lost else with_pupils(found, seen)
        if not is_placed(found):
            raise NoFaceError("this frame")
        rgb, found = at_size(frame.rgb, found, whole.camera.size_px)
        refitter = Refitter(model, whole.user, whole.camera)
        if not state.lost:
            found = with_outline(found, refitter)
        return Prepared(profile, FrameBook(rgb, found), refitter)

    def keep(self, correction: Correction) -> Generator[Progress, None, str]:
        """Put a correction into the profile's draft.

        Raises:
            ProfileUnwritableError: It is not kept.
        """
        yield Progress(0, 1, "Keeping the correction")
        folder = profile_folder(correction.profile)
        draft = Draft(folder)
        name = next_name({*draft.names(), *read_generation(folder).header["names"]})
        picture = DraftPicture(
            correction.landmarks, correction.found, f"{name}.png", {"from": "the live view"}
        )
        draft.put(name, picture, encoded(correction.rgb))
        return name

    def unlearned(self, profile: str) -> int:
        """Return how many corrections are kept and not learned yet."""
        names = Draft(profile_folder(profile)).names()
        return sum(name.startswith(f"{KIND}-") for name in names)

    def train(self, profile: str) -> Generator[Progress, None, Retrained]:
        """Train a profile behind the live view.

        Raises:
            CoreError, AppError: The profile is as it was.
        """
        return stepping_back(taking_turns(self._train(profile)))

    def _train(self, profile: str) -> Generator[Progress, None, Retrained]:
        yield Progress(0, 1, "Reading the profile's pictures")
        book = Workbook(profile_folder(profile), _find)
        drafted = Draft(book.folder).names()
        fresh = [name for name in book.used_names if name in drafted and name.startswith(KIND)]
        before: Any = book.profile.report if book.profile is not None else {}
        was_px = {
            name: rms_px(book.automatic(name).points_px, book.landmarks(name)) for name in fresh
        }
        model = load_face_model(asset("face_model.npz"))
        trained = yield from book.train(model, np.random.default_rng(1))
        yield Progress(1, 1, "Looking at the corrected pictures")
        now_px = errors_px(trained, book, fresh)
        lines = [picture_text(name, was_px[name], now_px[name]) for name in now_px]
        text = " ".join([*lines, held_out_text(before, trained.report)])
        return Retrained(profile, self._opener.open_profile(profile), text.strip())


def errors_px(profile: Profile, book: Workbook, names: list[str]) -> dict[str, float | None]:
    """Return how far a profile's regressor is from the landmarks of pictures.

    Args:
        profile: With the regressor.
        book: With the pictures.
        names: Of the pictures; those that the book does not have any more are left out.

    Returns:
        Name -> px (RMS), None where it finds no face.
    """
    models = load_models() if names else None
    errors: dict[str, float | None] = {}
    for name in names:
        if models is not None and name in book.names:
            rgb = book.image(name)
            state = live_tracker(models, profile).step(Frame(rgb, gray_from_rgb(rgb), 0.0, 0))
            marks = book.landmarks(name)
            errors[name] = None if state.lost else rms_px(state.landmarks_px, marks)
    return errors


def next_name(known: set[str]) -> str:
    """Return the name of one more picture from the live view."""
    last = max(
        (int(name.rpartition("-")[2]) for name in known
         if name.startswith(f"{KIND}-") and name.rpartition("-")[2].isdigit()), default=0,
    )  # fmt: skip
    return f"{KIND}-{last + 1:04d}"


def rms_px(points_px: Any, landmarks: Landmarks2D) -> float:
    """Return the distance (RMS) of internal landmarks from those that are trusted."""
    squares = np.sum((points_px - landmarks.points_px)[:N_INTERNAL] ** 2, axis=1)
    trusted = landmarks.confidence[:N_INTERNAL] > 0
    return float(np.sqrt(np.mean(squares[trusted]))) if trusted.any() else 0.0


def picture_text(name: str, before_px: float, after_px: float | None) -> str:
    """Return what has become of a corrected picture, for people."""
    if after_px is None:
        return f"In {name} the face is not found yet."
    text = f"In {name} the landmarks are {after_px:.1f} px off now"
    # A frame that was used as it is tells nothing of before.
    return f"{text}, {before_px:.1f} px before." if before_px > after_px else f"{text}."


def held_out_text(before: Any, after: Any) -> str:
    """Return what has become of the test on pictures kept for it, for people."""
    try:
        limit, share = next(iter(after["held_out"]["share_under_px"].items()))
        text = f"On pictures kept for testing, {100 * share:.0f} % are within {limit} px"
        was = before["held_out"]["share_under_px"][limit]
    except (KeyError, TypeError, StopIteration):
        return ""
    return f"{text} ({100 * was:.0f} % before)."


def _find(rgb: U8) -> Landmarks2D | None:
    found = load_aligner().first(rgb)
    return None if found is None else found.landmarks
