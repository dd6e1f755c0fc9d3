"""The setup pictures of a profile with their landmarks: as trained, and as corrected since."""

from collections.abc import Callable, Generator, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.profiles import decoded, encoded, load_setup_images, pictures_kept
from app.replacing import REPLACING, ProfileChangedError, edition
from app.resizing import at_size, thumbnail, toned
from app.setup_steps import Pictures, keep, make_profile
from core.calibration import Before
from core.draft import Draft, DraftPicture, Stamp
from core.extra_shots import as_seen
from core.face_model import FaceModel
from core.generations import HEADER_NAME
from core.held_out_choice import held_out_rows
from core.held_out_pairs import HeldOutSettings
from core.landmark_edit import points_of
from core.model_fit import LEAST_LANDMARKS, trusted_landmarks
from core.records import (
    U8,
    FloatArray,
    Landmarks2D,
    Progress,
    SetupImages,
)
from core.setup_plan import SHOTS, standard_for
from core.store import Profile, load

__all__ = ["Workbook", "thumbnail", "toned"]

#: What the generic aligner sees in a picture, None without a face.
Find = Callable[[U8], Landmarks2D | None]


class Workbook:
    """Reads a profile and its draft; keeps every shot and correction on the disk at once."""

    def __init__(self, folder: Path, find: Find) -> None:
        """Open the pictures of a profile, or of one that is still to be trained.

        Args:
            folder: Of the profile; it need not be there.
            find: The aligner, for points as they were found.

        Raises:
            ProfileNewerError, ProfileDamagedError: What is there cannot be opened.
        """
        self.folder, self._find = folder, find
        self._draft = Draft(folder)
        self.profile: Profile | None = None
        #: Whether the user deleted the pictures of the profile: only new ones can be looked at.
        self.pictures_deleted = False
        self._images: dict[str, U8] = {}
        self._landmarks: dict[str, Landmarks2D] = {}
        self._out: set[str] = set()
        # What this book knows: the profile's edition, and the draft's state.
        self._edition, self._known = "", dict[str, Stamp]()
        self._open()

    def _open(self) -> None:
        """Read profile and draft anew; until all is read, a window sees what was there before."""
        now, profile, deleted = edition(self.folder), None, False
        images: dict[str, U8] = {}
        landmarks: dict[str, Landmarks2D] = {}
        if (self.folder / HEADER_NAME).exists():
            profile, deleted = load(self.folder), not pictures_kept(self.folder)
        if profile is not None and not deleted:
            read = load_setup_images(self.folder, profile)
            images = dict(zip(read.names, read.images, strict=True))
            landmarks = dict(zip(profile.names, profile.landmarks, strict=True))
        known = self._draft.state()
        self._add_drafts(known, images, landmarks)
        out = set(self._draft.taken_out()) & set(landmarks)
        self._images, self._landmarks, self._out = images, landmarks, out
        self.profile, self.pictures_deleted = profile, deleted
        self._edition, self._known = now, known
        # What the window kept while this was read.
        self._catch_up()

    def _catch_up(self) -> None:
        """Read what has come into the draft, or changed there, since it was read."""
        state = self._draft.state()
        fresh = {file: stamp for file, stamp in state.items() if self._known.get(file) != stamp}
        self._add_drafts(fresh, self._images, self._landmarks)
        self._known |= fresh
        self._out = set(self._draft.taken_out()) & set(self._landmarks)

    def _add_drafts(
        self, files: Iterable[str], images: dict[str, U8], landmarks: dict[str, Landmarks2D]
    ) -> None:
        for name in sorted({Path(file).stem for file in files if not file.endswith(".out")}):
            self._add_draft(name, images, landmarks)

    def _add_draft(
        self, name: str, images: dict[str, U8], landmarks: dict[str, Landmarks2D]
    ) -> None:
        picture = self._draft.get(name)
        if picture is None:
            return
        if picture.picture_name:
            rgb = decoded(self._draft.content(picture))
            if rgb is None:
                return
            images[name] = rgb
        if name in images:
            landmarks[name] = picture.landmarks

    @property
    def names(self) -> tuple[str, ...]:
        """The pictures' names: prompts in their order, then others as they came."""
        prompts = [shot.name for shot in SHOTS if shot.name in self._landmarks]
        return (*prompts, *(name for name in self._landmarks if name not in prompts))

    @property
    def taken_out(self) -> frozenset[str]:
        """The pictures that the next training leaves out; it drops them for good."""
        return frozenset(self._out)

    @property
    def used_names(self) -> tuple[str, ...]:
        """The pictures of the next training."""
        return tuple(name for name in self.names if name not in self._out)

    @property
    def n_usable(self) -> int:
        """How many pictures show a face well enough to be trained on."""
        marks = [self._landmarks[name] for name in self.used_names]
        return sum(trusted_landmarks(one) >= LEAST_LANDMARKS for one in marks)

    @property
    def outdated(self) -> bool:
        """Whether the profile was trained with other pictures or landmarks, or not at all."""
        trained = self.profile.names if self.profile is not None else ()
        if self._out & set(trained):
            return True
        return any(not self._is_trained(name) for name in self.used_names)

    def image(self, name: str) -> U8:
        """Return a picture (H, W, 3)."""
        return self._images[name]

    def standard(self, name: str) -> FloatArray:
        """Return the coefficients a* (B,) of a picture's prompt, NaN without one."""
        if self.profile is not None and name in self.profile.names:
            return np.asarray(self.profile.standard[self.profile.names.index(name)])
        return standard_for(name)

    def landmarks(self, name: str) -> Landmarks2D:
        """Return the landmarks of a picture as they are now."""
        return self._landmarks[name]

    def quality(self, name: str) -> dict[str, object]:
        """Return what is known of how good a shot is; nothing of one from a profile."""
        known = self._draft.get(name)
        return dict(known.quality) if known is not None else {}

    def automatic(self, name: str) -> Landmarks2D:
        """Return the landmarks as they were found, before any correction.

        Where no face is found they are those of the profile.
        """
        known = self._draft.get(name)
        if known is not None:
            return known.automatic
        now = self._landmarks[name]
        return self._find(self.image(name)) or now if now.edited.any() else now

    def correct(self, name: str, landmarks: Landmarks2D) -> None:
        """Keep new landmarks of a picture, on the disk, too.

        Raises:
            ProfileUnwritableError: They are only in memory; the profile is as it was.
        """
        known = self._draft.get(name) or DraftPicture(landmarks, self.automatic(name))
        self._landmarks[name] = landmarks
        if not known.picture_name and self._is_trained(name):
            self._draft.remove(name)
        else:
            self._draft.put(name, replace(known, landmarks=landmarks))
        self._own(name)

    def suggest(self, name: str, landmarks: Landmarks2D) -> None:
        """Use other landmarks for a picture until the user corrects them; nothing is kept."""
        self._landmarks[name] = landmarks

    def put(
        self, name: str, rgb: U8, landmarks: Landmarks2D, quality: Mapping[str, object]
    ) -> None:
        """Keep a shot, or a frame from elsewhere; one of the same name is replaced.

        A picture of another size becomes one of the size of the others. Landmarks behind a hand
        that the prompt asked for count as not seen. Pictures of no prompt, say "live-0001", are
        trained on without knowing what they were meant to show.

        Raises:
            ProfileUnwritableError: It is not kept.
        """
        rgb, landmarks = at_size(rgb, as_seen(name, landmarks), self._size_px(rgb))
        picture = DraftPicture(landmarks, landmarks, f"{name}.png", quality)
        self._draft.put(name, picture, encoded(rgb))
        self._own(name)
        self._images[name], self._landmarks[name] = rgb, landmarks
        self.take_out(name, False)

    def new_name(self, kind: str = "live") -> str:
        """Return a name for one more picture of a kind: "live-0001" after none."""
        numbers = [name.removeprefix(f"{kind}-") for name in self._landmarks]
        last = max((int(one) for one in numbers if one.isdigit()), default=0)
        return f"{kind}-{last + 1:04d}"

    def take_out(self, name: str, out: bool = True) -> None:
        """Leave a picture out of the next training, which then drops it, or use it after all.

        Raises:
            ProfileUnwritableError: Nothing has changed.
        """
        if name in self._landmarks and (name in self._out) != out:
            self._draft.take_out(name, out)
            self._own(name)
            self._out = self._out | {name} if out else self._out - {name}

    def _own(self, name: str) -> None:
        """Take what the draft holds of a picture for known: this book has just written it."""
        self._known |= self._draft.state_of(name)

    def _size_px(self, rgb: U8) -> tuple[int, int]:
        """Return the size of all pictures; it is that of the first."""
        if self.profile is not None:
            return self.profile.camera.size_px
        first = next(iter(self._images.values()), rgb)
        return first.shape[1], first.shape[0]

    def remove(self, name: str) -> None:
        """Drop a shot that no training has seen, if there is one."""
        if self.profile is None or self.pictures_deleted or name not in self.profile.names:
            self.take_out(name, False)
            self._draft.remove(name)
            self._images.pop(name, None)
            self._landmarks.pop(name, None)

    def train(
        self, model: FaceModel, rng: np.random.Generator
    ) -> Generator[Progress, None, Profile]:
        """Train the profile with pictures and landmarks as they are now, and keep it.

        Yields:
            Progress of the training.

        Returns:
            The new profile; this book is then one of the new profile.

        Raises:
            CoreError, AppError: The profile is as it was; or it was deleted, emptied or trained
                elsewhere meanwhile, and is as that left it.
        """
        self._bring_up_to_date()
        begun, before = self._edition, dict(self._known)
        steps = make_profile(model, self._pictures(), self.given_focal_px, rng)
        profile, used = yield from steps
        with REPLACING:
            kept = keep(self.folder, profile, used, begun, **history(self.profile))
            self._draft.clear(before)
        # With what was taken or corrected, here or elsewhere, while the training was at work.
        self._open()
        return kept

    def _bring_up_to_date(self) -> None:
        """Read what is on the disk, if it is not any more what was read from there.

        Raises:
            ProfileChangedError: Profile or pictures were deleted.
        """
        now = edition(self.folder)
        if not self.folder.is_dir() or (self._edition and not now):
            raise ProfileChangedError(self.folder, "deleted")
        if now != self._edition:
            self._open()
        self._catch_up()
        if not self.used_names:
            raise ProfileChangedError(self.folder, "emptied")

    def _pictures(self) -> Pictures:
        """Return what the next training is made from."""
        names = self.used_names
        standard = np.stack([self.standard(name) for name in names])
        images = SetupImages(tuple(self._images[name] for name in names), names, standard)
        marks = tuple(self._landmarks[name] for name in names)
        # To look again takes a moment; only the pictures that are tested need it.
        tested = {names[row] for row in held_out_rows(names, HeldOutSettings().every)}
        automatic = [
            self.automatic(name) if name in tested else self._landmarks[name] for name in names
        ]
        return Pictures(images, marks, (), tuple(automatic), self._before())

    def _before(self) -> Before | None:
        """Return what the last training found; it is where the next one begins."""
        profile = self.profile
        return None if profile is None else Before(profile.camera.focal_px, profile.fit)

    @property
    def given_focal_px(self) -> float | None:
        """The focal length if the user gave it, None if it is found in each training."""
        if self.profile is None or self.profile.report.get("focal_source") != "given":
            return None
        return self.profile.camera.focal_px

    def _is_trained(self, name: str) -> bool:
        """Return whether the profile was trained with a picture as it is now."""
        if self.profile is None or name not in self.profile.names:
            return False
        known = self._draft.get(name)
        if known is not None and known.picture_name:
            return False
        trained = self.profile.landmarks[self.profile.names.index(name)]
        return _same(trained, self._landmarks[name])


def history(before: Profile | None) -> dict[str, object]:
    """Return what a new report keeps of the training before: its report, without what was before.

    Args:
        before: The profile that is replaced, None for the first one.
    """
    if before is None:
        return {}
    return {"previous": {key: value for key, value in before.report.items() if key != "previous"}}


def _same(one: Landmarks2D, other: Landmarks2D) -> bool:
    return (
        np.array_equal(points_of(one), points_of(other))
        and np.array_equal(one.edited, other.edited)
        and np.array_equal(one.confidence, other.confidence)
        and np.array_equal(one.pupil_confidence, other.pupil_confidence)
    )
