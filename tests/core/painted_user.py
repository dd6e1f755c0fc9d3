"""A user of the real face model with a painted skin: pictures, landmarks and a small regressor."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from core.alignment import Alignment
from core.augmentation import AugmentationSettings
from core.blendshapes import user_blendshapes
from core.camera import project
from core.face_model import FaceModel, load_face_model
from core.face_regions import Region
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.landmarks import N_INTERNAL, N_LANDMARKS
from core.live import User, tracker_model
from core.records import Frame, Landmarks2D, ModelFit, UserBlendshapes
from core.regressor_trainer import train
from core.tracker import TrackerModel
from core.training_set import TrainingSetSettings, make_training_set
from tests.core.tracked_faces import ASSETS, expression, head_pose, shape_of
from tests.synthetic_face import SMALL, SyntheticFace, finish, make_face

#: Nothing but the head's own pictures: no lamps, no hands.
CALM = TrainingSetSettings(augmentation=AugmentationSettings(0.0, 0.0, 0.0))


@dataclass(frozen=True)
class PaintedUser:
    model: FaceModel
    blendshapes: UserBlendshapes
    points: TrackerModel
    skin: SyntheticFace

    @property
    def camera(self):
        return self.skin.camera

    def shape(self, place_mm=(0.0, 0.0, 600.0), angles=(0.0, 0.0, 0.0), **amounts):
        """The 77 points of a head; its expression by names of blendshapes."""
        return shape_of(self.points, expression(**amounts), head_pose(*angles, place_mm))

    def random_shapes(self, n, rng, reach_mm=25.0):
        shapes = []
        for _ in range(n):
            place = rng.uniform(-reach_mm, reach_mm, 3) + [0, 0, 600]
            jaw, smile = rng.uniform(0, 1, 2)
            angles = rng.uniform(-0.25, 0.25, 3)
            shapes.append(self.shape(place, angles, jawOpen=0.6 * jaw, mouthSmile=smile))
        return np.array(shapes)

    def frame(self, points_mm, time_s, enlarged=1):
        """What the camera sees, with pixels `enlarged` times as many in a row."""
        gray = np.kron(self.skin.picture(points_mm), np.ones((enlarged, enlarged), np.uint8))
        return Frame(np.repeat(gray[..., None], 3, axis=2), gray, time_s, round(30 * time_s))

    def landmarks(self, points_mm, camera=None):
        """Exact landmarks; the contour, which depends on the outline, is left unseen."""
        points = project(camera or self.camera, points_mm)
        seen = np.where(np.arange(N_LANDMARKS) < N_INTERNAL, 1.0, 0.0)
        unedited = np.zeros(N_LANDMARKS, bool)
        return Landmarks2D(
            points[:N_LANDMARKS], unedited, seen, points[N_LANDMARKS:], np.array([1.0, 1.0])
        )

    def alignment(self, points_mm, camera=None, presence=0.9):
        return Alignment(
            self.landmarks(points_mm, camera), np.zeros((478, 2)), np.zeros(478), np.eye(3),
            presence, Region(np.zeros(2), 100.0, 0.0),
        )  # fmt: skip


def fit_of(identity, offsets_mm=None, angles=((0.0, 0.0, 0.0),)):
    """The fit of a person in pictures with the head turned by some angles, straight ahead."""
    rotations = [quaternion_from_matrix(matrix_from_head_angles(*one)) for one in angles]
    n = len(angles)
    return ModelFit(
        identity, np.zeros((n, 46)), rotations, np.tile([0, 0, 600.0], (n, 1)),
        np.zeros((n, N_LANDMARKS), np.int32), np.zeros(n),
        np.zeros((N_INTERNAL, 3)) if offsets_mm is None else offsets_mm,
    )  # fmt: skip


@cache
def painted_user(identity_seed=None):
    """The mean person, or a random one, in pictures of 240 x 180 px."""
    model = load_face_model(ASSETS / "face_model.npz")
    identity = np.zeros(model.n_identities)
    if identity_seed is not None:
        identity = 0.7 * np.random.default_rng(identity_seed).normal(size=identity.shape)
    blendshapes = user_blendshapes(model, fit_of(identity))
    points = tracker_model(model, blendshapes)
    frontal = shape_of(points, expression(), head_pose(0, 0, 0, (0, 0, 600)))[:, :2]
    middle = (frontal.min(axis=0) + frontal.max(axis=0)) / 2
    flat = (frontal - middle) / np.linalg.norm(frontal - middle, axis=1).max()
    skin = replace(make_face(np.random.default_rng(5)), flat=flat)
    return PaintedUser(model, blendshapes, points, skin)


@cache
def trained_user():
    """The mean person's profile as live tracking needs it."""
    user, rng = painted_user(), np.random.default_rng(6)
    shapes = user.random_shapes(40, rng)
    pictures = [user.skin.picture(shape) for shape in shapes]
    samples = make_training_set(pictures, user.camera, shapes, rng, CALM)
    regressor, _ = finish(train(samples, rng, SMALL))
    return User(user.camera, user.blendshapes, regressor)
