"""What every kind of tracking needs of the shipped files, loaded once."""

from dataclasses import dataclass

from app.resources import asset
from core.aligner_bias import load_aligner_bias
from core.alignment import FaceAligner
from core.animation_prior import AnimationPrior, load_animation_prior
from core.face_model import FaceModel, load_face_model
from core.live import LiveTracker, User
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


def live_tracker(models: Models, profile: Profile) -> LiveTracker:
    """Return a tracker that follows the person of a profile."""
    user = User(profile.camera, profile.user, profile.regressor)
    return LiveTracker(models.face_model, user, models.aligner, models.prior)
