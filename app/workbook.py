"""The setup pictures of a profile with their landmarks: as trained, and as corrected since."""

from collections.abc import Callable, Generator
from pathlib import Path

import cv2
import numpy as np

from app.profiles import load_setup_images
from app.setup_steps import Pictures, keep, make_profile
from core.draft import Draft, DraftPicture
from core.face_model import FaceModel
from core.landmark_edit import points_of
from core.records import U8, FloatArray, Landmarks2D, Progress
from core.store import Profile, load

#: What the generic aligner sees in a picture, None without a face.
Find = Callable[[U8], Landmarks2D | None]


class Workbook:
    """Reads a profile and its draft; keeps every correction on the disk at once."""

    def __init__(self, folder: Path, find: Find) -> None:
        """Open the pictures of a profile.

        Args:
            folder: Of the profile.
            find: The aligner, for points as they were found.

        Raises:
            ProfileMissingError, ProfileNewerError, ProfileDamagedError: There is none to open.
        """
        self.folder, self._find = folder, find
        self.profile = load(folder)
        self._images = load_setup_images(folder, self.profile)
        self._draft = Draft(folder)
        self._landmarks = dict(zip(self.profile.names, self.profile.landmarks, strict=True))
        for name in self._draft.names():
            picture = self._draft.get(name)
            if picture is not None and name in self._landmarks:
                self._landmarks[name] = picture.landmarks

    @property
    def names(self) -> tuple[str, ...]:
        """The pictures' names, in the order of the setup."""
        return self.profile.names

    @property
    def outdated(self) -> bool:
        """Whether the profile was trained with other landmarks."""
        trained = zip(self.profile.names, self.profile.landmarks, strict=True)
        return any(not _same(marks, self._landmarks[name]) for name, marks in trained)

    def image(self, name: str) -> U8:
        """Return a picture (H, W, 3)."""
        return self._images.images[self.names.index(name)]

    def standard(self, name: str) -> FloatArray:
        """Return the coefficients a* (B,) of a picture's prompt, NaN without one."""
        return np.asarray(self.profile.standard[self.names.index(name)])

    def landmarks(self, name: str) -> Landmarks2D:
        """Return the landmarks of a picture as they are now."""
        return self._landmarks[name]

    def trained(self, name: str) -> Landmarks2D:
        """Return the landmarks with which the profile was trained."""
        return self.profile.landmarks[self.names.index(name)]

    def automatic(self, name: str) -> Landmarks2D:
        """Return the landmarks as they were found, before any correction.

        Where no face is found they are those of the profile.
        """
        known = self._draft.get(name)
        if known is not None:
            return known.automatic
        trained = self.trained(name)
        if not trained.edited.any():
            return trained
        return self._find(self.image(name)) or trained

    def correct(self, name: str, landmarks: Landmarks2D) -> None:
        """Keep new landmarks of a picture, on the disk, too.

        Raises:
            ProfileUnwritableError: They are only in memory; the profile is as it was.
        """
        automatic = self.automatic(name)
        self._landmarks[name] = landmarks
        if _same(landmarks, self.trained(name)):
            self._draft.remove(name)
        else:
            self._draft.put(name, DraftPicture(landmarks, automatic))

    def retrain(
        self, model: FaceModel, rng: np.random.Generator
    ) -> Generator[Progress, None, Profile]:
        """Train the profile anew with the landmarks as they are now, and keep it.

        Yields:
            Progress of the training.

        Returns:
            The new profile; this book is then one of the new profile.

        Raises:
            CoreError: The profile is as it was.
        """
        landmarks = tuple(self._landmarks[name] for name in self.names)
        pictures = Pictures(self._images, landmarks, ())
        given = self.profile.report.get("focal_source") == "given"
        focal_px = self.profile.camera.focal_px if given else None
        profile, images = yield from make_profile(model, pictures, focal_px, rng)
        self.profile = keep(self.folder, profile, images)
        self._images = images
        self._landmarks = dict(zip(profile.names, profile.landmarks, strict=True))
        self._draft.clear()
        return self.profile


def thumbnail(rgb: U8, width: int) -> U8:
    """Return a small copy of a picture."""
    height = round(width * rgb.shape[0] / rgb.shape[1])
    return np.asarray(cv2.resize(rgb, (width, height), interpolation=cv2.INTER_AREA), np.uint8)


def toned(rgb: U8, brightness: int, contrast: int) -> U8:
    """Return a picture as shown at a brightness and contrast of -100 to 100."""
    gain = 2.0 ** (contrast / 50)
    return np.asarray(cv2.convertScaleAbs(rgb, None, gain, 128 * (1 - gain) + brightness), np.uint8)


def _same(one: Landmarks2D, other: Landmarks2D) -> bool:
    return (
        np.array_equal(points_of(one), points_of(other))
        and np.array_equal(one.edited, other.edited)
        and np.array_equal(one.confidence, other.confidence)
        and np.array_equal(one.pupil_confidence, other.pupil_confidence)
    )
