"""Frame by frame: the regressor, the tracker, and finding the face again.

`LiveTracker` is the only object here that remembers anything between frames.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from core.agreement import Look, Misfits, disagreement
from core.animation_prior import AnimationPrior
from core.arkit import EXPRESSION_NAMES
from core.blendshapes import mean_user
from core.camera import project, seen_by
from core.eye_reader import EyeReader, EyeReading
from core.face_keeper import Aligner, FaceKeeper, Seeing, Unwatched
from core.face_model import FaceModel, eye_centers_mm, shape_vertices
from core.landmarks import N_INTERNAL, N_LANDMARKS
from core.model_fit import FewLandmarksError
from core.records import (
    Camera,
    FaceState,
    FloatArray,
    Frame,
    Landmarks2D,
    Shape3D,
    UserBlendshapes,
)
from core.region_check import region_confidence, region_means
from core.region_ease import RegionEase
from core.regressor import FernRegressor, Regression
from core.shape_recovery import RecoverySettings, recover_one
from core.tracker import Looks, TrackedFace, Tracker, TrackerModel

if TYPE_CHECKING:
    from core.alignment import Alignment

#: Usual residual before it is known, the share of a frame in it, and what is never sudden.
_USUAL, _LEARNING, _CALM = 0.4, 0.04, 0.65


@dataclass(frozen=True, slots=True, eq=False)
class User:
    """What tracking needs of a profile.

    Attributes:
        camera: Of the setup pictures.
        blendshapes: The user's own.
        regressor: Trained on the user's pictures.
        eyes: Reads where the eyes look; without it the regressed pupils say so.
    """

    camera: Camera
    blendshapes: UserBlendshapes
    regressor: FernRegressor
    eyes: EyeReader | None = None


@dataclass(frozen=True, slots=True)
class LiveSettings:
    """When tracking is doubted, checked and given up.

    Attributes:
        check_every: Frames between two looks by the generic aligner.
        doubt: Residual of the regressor above which a frame is checked at once; 1 is what 99 %
            of good frames stay below.
        sudden: Residual above which a frame is checked, too, in parts of what is usual here.
        doubt_spread_mm: The same for the disagreement of its runs.
        doubt_way_mm: The same for the way from the last frame's shape (RMS).
        doubt_pause: Frames after a doubtful frame that passed its check in which doubt alone asks
            for no other one.
        disagreement: Distance of the regressed landmarks from the aligner's, in eye distances
            (RMS), above which the regressor is wrong. Own faces stay below 0.05, turned ones, too.
        covered: Mean cover of the landmarks from which on the regressor, which has seen no hands,
            gives way to what is recovered from the uncovered landmarks.
        gap_s: Time without frames after which all begins anew: a camera was gone.
        recovery: How a shape is found from landmarks.
        eased: Whether what is covered is held and let go; else it is shown as it was solved.
    """

    check_every: int = 30
    doubt: float = 1.3
    sudden: float = 2.2
    doubt_spread_mm: float = 6.0
    doubt_way_mm: float = 20.0
    doubt_pause: int = 5
    disagreement: float = 0.07
    covered: float = 0.1
    gap_s: float = 1.0
    recovery: RecoverySettings = field(default_factory=RecoverySettings)
    eased: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """The shape of one frame and how far to trust it."""

    points_mm: FloatArray
    confidence: float
    regions: FloatArray


class LiveTracker:
    """Turns frames into face states.

    Frames of another size than the setup's are understood as the same view in more or fewer
    pixels.
    """

    def __init__(
        self, model: FaceModel, user: User, aligner: Aligner | FaceKeeper, prior: AnimationPrior,
        settings: LiveSettings | None = None,
    ) -> None:  # fmt: skip
        """Prepare to follow one user.

        Args:
            model: The face model that the user's profile was made with.
            user: From the profile.
            aligner: Finds the face first and after tracking was lost; a keeper also stays with
                one face and sees what covers it.
            prior: Of the tracker.
            settings: When to check.
        """
        self._model, self._user = model, user
        self._seeing: Seeing = aligner if isinstance(aligner, FaceKeeper) else Unwatched(aligner)
        self._settings = settings or LiveSettings()
        self._ease = RegionEase()
        self._face = tracker_model(model, user.blendshapes)
        self._tracker = Tracker(self._face, prior)
        self._use_size(user.camera.size_px)
        self._alignment: Alignment | None = None
        self._points_mm: FloatArray | None = None
        self._look: Look | None = None
        self._since_check, self._pause, self._usual = 0, 1, _USUAL
        self._last, self._seen_s = resting_state("trained"), -np.inf

    @property
    def camera(self) -> Camera:
        """The camera in pixels of the last frame."""
        return self._camera

    @property
    def user(self) -> UserBlendshapes:
        """The face of the profile."""
        return self._user.blendshapes

    @property
    def look(self) -> Look | None:
        """What the aligner saw in the last frame, None if it did not look or saw nothing."""
        return self._look

    @property
    def follows(self) -> bool:
        """Whether the regressor goes on from the last frame."""
        return self._points_mm is not None

    def reset(self) -> None:
        """Forget the past, as after a cut."""
        self._alignment, self._points_mm, self._look = None, None, None
        self._tracker.reset()

    def look_within(self, frames: int) -> None:
        """Let the aligner look after so many frames, if it would not sooner."""
        self._since_check = max(self._since_check, self._settings.check_every - frames)

    def begin_at(self, frame: Frame, landmarks: Landmarks2D) -> Look | None:
        """Try the regressor where somebody else found the face; it is followed if it agrees.

        Args:
            frame: The frame.
            landmarks: Of the generic aligner in this frame.

        Returns:
            How it went, None if the landmarks do not suffice.
        """
        self._fit_frame(frame)
        self.reset()
        self._seen_s = frame.time_s
        recovered = self._recovered(landmarks)
        if recovered is not None:
            self._look = self._begin(frame, landmarks, recovered)
        return self._look

    def misfits(self, landmarks: Landmarks2D) -> Misfits | None:
        """Return how far faces stay from landmarks; None if they do not suffice."""
        own = self._recovered(landmarks)
        mean = self._recovered(landmarks, self._mean)
        if own is None or mean is None:
            return None
        places = [project(self._camera, shape[:N_LANDMARKS]) for shape in (own, mean)]
        return Misfits(*(disagreement(points_px, landmarks) for points_px in places))

    def step(self, frame: Frame) -> FaceState:
        """Return the face in a frame; `lost` and the last good state where there is none."""
        self._fit_frame(frame)
        self._look = None
        if frame.time_s - self._seen_s > self._settings.gap_s:
            self.reset()
        self._seen_s = frame.time_s
        found = self._continue(frame) or self._start(frame)
        if found is None:
            self._last = replace(self._last, time_s=frame.time_s, confidence=0.0, lost=True)
            return self._shown()
        if self._last.lost:
            self._tracker.reset()
        face = self._tracker.step(
            found.points_mm, frame.time_s, found.confidence, self._looks(frame)
        )
        self._last = self._state(frame.time_s, found, face)
        return self._shown()

    def _shown(self) -> FaceState:
        """Return the last state, what is covered of it held or let go."""
        return self._ease.step(self._last) if self._settings.eased else self._last

    def _fit_frame(self, frame: Frame) -> None:
        """Begin anew where the frames have another size."""
        size_px = (frame.gray.shape[1], frame.gray.shape[0])
        if size_px != self._camera.size_px:
            self._use_size(size_px)
            self.reset()

    def _use_size(self, size_px: tuple[int, int]) -> None:
        self._camera = seen_by(self._user.camera, size_px)
        self._regression = Regression(self._user.regressor, self._camera)
        self._eyes: EyeReading | None = None
        if self._user.eyes is not None:
            face = self._face
            self._eyes = EyeReading(
                self._user.eyes, self._camera, face.eye_centers_mm, face.pupil_radii_mm
            )

    def _looks(self, frame: Frame) -> Looks | None:
        """Return what reads the gaze in a frame, None if only the regressed pupils tell it."""
        eyes = self._eyes
        return None if eyes is None else lambda pose: eyes.directions(frame.gray, pose)

    def _continue(self, frame: Frame) -> _Found | None:
        """Return the shape regressed from the previous one, None if it cannot be trusted."""
        if self._points_mm is None:
            return None
        shape = self._regression.run(frame.gray, self._points_mm)
        if not self._is_sane(shape) or not self._passes_check(frame, shape):
            self._points_mm = None
            return None
        self._points_mm = shape.points_mm
        self._usual += _LEARNING * (min(shape.residual, 2 * self._usual) - self._usual)
        return self._found(shape)

    def _is_sane(self, shape: Shape3D) -> bool:
        """Return whether the shape lies before the camera and inside the picture."""
        depth = shape.points_mm[:, 2]
        if depth.min() <= 50.0 or depth.max() > 10_000.0:
            return False
        center = project(self._camera, shape.points_mm.mean(axis=0))
        return bool(np.all(center >= 0) and np.all(center < self._camera.size_px))

    def _is_doubtful(self, shape: Shape3D) -> bool:
        settings = self._settings
        limit = min(settings.doubt, max(settings.sudden * self._usual, _CALM))
        return shape.residual > limit or shape.spread_mm > settings.doubt_spread_mm

    def _is_fast(self, shape: Shape3D) -> bool:
        """Return whether the face moved so far since the last frame that it may be elsewhere."""
        if self._points_mm is None:
            return False
        way = shape.points_mm - self._points_mm
        return float(np.sqrt(np.mean(np.sum(way**2, axis=1)))) > self._settings.doubt_way_mm

    def _passes_check(self, frame: Frame, shape: Shape3D) -> bool:
        """Let the generic aligner look now and then, and at once where there is doubt."""
        self._since_check += 1
        doubtful = self._is_doubtful(shape)
        due = self._pause if doubtful else self._settings.check_every
        if self._seeing.cover.any() or not self._seeing.knows:
            due = min(due, self._settings.doubt_pause)
        if self._since_check < due and not self._is_fast(shape):
            self._pause = self._pause if doubtful else 1
            return True
        # Doubt that was unfounded once, under another lamp say, will be so in the next frames.
        self._pause = self._settings.doubt_pause if doubtful else 1
        self._since_check = 0
        landmarks_px = project(self._camera, shape.points_mm[:N_LANDMARKS])
        alignment = self._seeing.check(frame, landmarks_px)
        if alignment is None:
            return False
        self._alignment = alignment
        self._look = self._compared(alignment.landmarks, shape)
        return self._look.agrees

    def _start(self, frame: Frame) -> _Found | None:
        """Return the shape recovered from the generic aligner's landmarks, None without a face.

        The regressor goes on from there in the next frame if it agrees.
        """
        self._alignment = self._seeing.follow(frame, self._alignment)
        if self._alignment is None:
            return None
        landmarks = self._alignment.landmarks
        recovered = self._recovered(landmarks)
        if recovered is None:
            return None
        self._look = self._begin(frame, landmarks, recovered)
        if self._look.agrees:
            return self._found(self._look.shape)
        regions = region_confidence(landmarks.confidence)
        return _Found(recovered, 0.5 * self._alignment.presence, regions)

    @cached_property
    def _mean(self) -> UserBlendshapes:
        return mean_user(self._model)

    def _recovered(
        self, landmarks: Landmarks2D, user: UserBlendshapes | None = None
    ) -> FloatArray | None:
        """Return a user's shape (Q, 3) with these landmarks, None if they are too few."""
        user, settings = user or self._user.blendshapes, self._settings.recovery
        try:
            found = recover_one(self._model, user, self._camera, landmarks, settings)
        except FewLandmarksError:
            return None
        return np.asarray(found.points_mm[0])

    def _begin(self, frame: Frame, landmarks: Landmarks2D, recovered: FloatArray) -> Look:
        """Let the regressor start from a recovered shape; follow it if it agrees."""
        look = self._compared(landmarks, self._regression.run(frame.gray, recovered))
        if look.agrees:
            self._points_mm, self._since_check, self._pause = look.shape.points_mm, 0, 1
        return look

    def _compared(self, landmarks: Landmarks2D, shape: Shape3D) -> Look:
        apart = disagreement(project(self._camera, shape.points_mm[:N_LANDMARKS]), landmarks)
        agrees = apart < self._settings.disagreement and self._is_sane(shape)
        agrees = agrees and self._covered() < self._settings.covered
        return Look(landmarks, shape, apart, agrees)

    def _covered(self) -> float:
        """Return how far the face is covered, as far as the last look told."""
        return float(self._seeing.cover[:N_INTERNAL].mean())

    def _found(self, shape: Shape3D) -> _Found:
        """Return a shape; confidence is 1 if it is like the training pictures, 0.5 at doubt."""
        unlike = np.array([shape.residual, *shape.unlike]) / self._settings.doubt
        confidence, *regions = 1 / (1 + unlike**4)
        return _Found(
            shape.points_mm,
            float(confidence),
            np.minimum(regions, 1.0 - region_means(self._seeing.cover)),
        )

    def _state(self, time_s: float, found: _Found, face: TrackedFace) -> FaceState:
        shape = found.points_mm[:N_LANDMARKS]
        return FaceState(
            time_s=time_s,
            rotation_wxyz=face.rotation_wxyz,
            translation_mm=face.translation_mm,
            expression=face.expression,
            gaze_rad=face.gaze_rad,
            shape_mm=shape,
            landmarks_px=project(self._camera, shape),
            confidence=found.confidence,
            mode="trained",
            lost=False,
            regions=found.regions,
        )


def tracker_model(model: FaceModel, user: UserBlendshapes) -> TrackerModel:
    """Return the user's face restricted to the points of the shape."""
    vertices = shape_vertices(model)
    radius = float(model.eyeball_radius_mm)
    neutral = user.neutral_mm[vertices]
    neutral[:N_INTERNAL] += user.landmark_offsets_mm
    return TrackerModel(
        neutral,
        user.deltas_mm[:, vertices].astype(np.float64),
        eye_centers_mm(model, user.neutral_mm),
        np.array([radius, radius]),
    )


def resting_state(mode: str) -> FaceState:
    """Return a resting face half a metre before the camera, lost."""
    return FaceState(
        time_s=0.0,
        rotation_wxyz=np.array([1.0, 0, 0, 0]),
        translation_mm=np.array([0, 0, 500.0]),
        expression=np.zeros(len(EXPRESSION_NAMES)),
        gaze_rad=np.zeros((2, 2)),
        shape_mm=np.zeros((N_LANDMARKS, 3)),
        landmarks_px=np.zeros((N_LANDMARKS, 2)),
        confidence=0.0,
        mode=mode,
        lost=True,
    )
