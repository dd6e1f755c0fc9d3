"""What every kind of tracking needs of the shipped files, loaded once; the kinds of tracking."""

import time
from dataclasses import dataclass

from app.resources import asset
from core.aligner_bias import load_aligner_bias
from core.alignment import FaceAligner
from core.animation_prior import AnimationPrior, load_animation_prior
from core.auto_live import STRICT, AutoTracker
from core.cover_watch import CoverWatch
from core.detection_policy import Detection
from core.face_keeper import FaceKeeper
from core.face_model import FaceModel, load_face_model
from core.free_live import FreeSettings, FreeTracker
from core.landmark_flow import FlowSettings, LandmarkFollower
from core.live import LiveSettings, LiveTracker, User
from core.records import Camera, UserBlendshapes
from core.store import Profile


@dataclass(frozen=True, slots=True, eq=False)
class Models:
    """The shipped models.

    Attributes:
        face_model: The bilinear face model.
        aligner: Finds faces and generic landmarks; remembers nothing of a face.
        prior: Of the tracker.
    """

    face_model: FaceModel
    aligner: FaceAligner
    prior: AnimationPrior


@dataclass(frozen=True, slots=True)
class Looking:
    """How often the landmark network looks in the training-free mode.

    Attributes:
        detection: "every" frame, every so many frames, or "adaptive": when it is needed, as far
            as a budget goes.
        measured: Whether the budget is kept by measured times. Without, the same video always
            gives the same track.
    """

    detection: Detection = "every"
    measured: bool = False


#: Seconds at the beginning of a recording from which a face is learned without a profile.
LEARNING_S = 4.0
#: For live sources: as often as is needed and as this machine can.
LIVE = Looking("adaptive", measured=True)


def load_aligner() -> FaceAligner:
    """Return the generic aligner, its mean error taken off."""
    folder = asset("aligner")
    return FaceAligner(folder, load_aligner_bias(folder / "bias.npz"))


def load_models() -> Models:
    """Return the shipped models."""
    return Models(
        load_face_model(asset("face_model.npz")),
        load_aligner(),
        load_animation_prior(asset("animation_prior.npz")),
    )


def face_keeper(models: Models) -> FaceKeeper:
    """Return what stays with one face, gets to know it, and sees what covers it."""
    return FaceKeeper(models.aligner, CoverWatch(models.aligner.mean))


def live_tracker(
    models: Models, profile: Profile, settings: LiveSettings | None = None,
    keeper: FaceKeeper | None = None,
) -> LiveTracker:  # fmt: skip
    """Return a tracker that follows the person of a profile."""
    user = User(profile.camera, profile.user, profile.regressor, profile.eyes)
    seeing = keeper or face_keeper(models)
    return LiveTracker(models.face_model, user, seeing, models.prior, settings)


def free_tracker(
    models: Models, camera: Camera | None = None, looking: Looking = LIVE,
    user: UserBlendshapes | None = None,
) -> FreeTracker:  # fmt: skip
    """Return a tracker that follows anybody without any setup.

    Args:
        models: The shipped models.
        camera: The source's, None if it is not known.
        looking: How often the network looks.
        user: Whose face to begin with, None for the mean face.
    """
    follower = _follower(models, looking, face_keeper(models))
    return FreeTracker(models.face_model, follower, camera, user=user)


def auto_tracker(models: Models, profile: Profile, looking: Looking = LIVE) -> AutoTracker:
    """Return a tracker that uses a profile as long as its person is there."""
    keeper = face_keeper(models)
    free = FreeTracker(
        models.face_model, _follower(models, looking, keeper), profile.camera,
        FreeSettings(eased=False), profile.user,
    )  # fmt: skip
    return AutoTracker(live_tracker(models, profile, STRICT, keeper), free, keeper=keeper)


def _follower(models: Models, looking: Looking, keeper: FaceKeeper) -> LandmarkFollower:
    clock = time.thread_time if looking.measured else None
    return LandmarkFollower(models.aligner, FlowSettings(looking.detection), clock, keeper)
