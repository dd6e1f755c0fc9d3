"""Pictures of a person who is not in the face model's span, with their truth."""

from functools import cache
from types import SimpleNamespace

import numpy as np

from core.camera import camera_for, project
from core.face_model import eye_centers_mm, load_face_model
from core.fit_problem import State, posed
from core.fit_space import face_at
from core.geometry import matrix_from_head_angles
from core.model_fit import choose_picks
from core.records import Landmarks2D, UserBlendshapes
from core.setup_plan import SHOTS
from tests.core.tracked_faces import ASSETS

NECK_MM = np.array([0.0, 70.0, 90.0])


@cache
def face_model():
    return load_face_model(ASSETS / "face_model.npz")


@cache
def person(number):
    """Return the true blendshapes of one of the people that the model was not built from."""
    with np.load(ASSETS / "people.npz", allow_pickle=False) as people:
        neutral, deltas = people["neutral_mm"][number], people["deltas_mm"][number]
    return UserBlendshapes(np.zeros(face_model().n_identities), neutral, deltas)


def filmed(user, shots, rng, focal_px=600.0, noise_px=0.5, nearness=0.75):
    """Return landmarks of a person who follows prompts roughly, and the truth.

    Args:
        user: The person.
        shots: The prompts.
        rng: Randomness of the performance and of the landmarks.
        focal_px: Of a camera of 640 x 480.
        noise_px: Standard deviation of each landmark coordinate.
        nearness: Distance of the neck over the focal length, in mm/px.
    """
    model, camera = face_model(), camera_for((640, 480), focal_px)
    face = face_at(model, user)
    asked = np.array([[shot.yaw, shot.pitch, shot.roll] for shot in shots])
    angles = asked * rng.uniform(0.8, 1.1, asked.shape) + rng.normal(0, 0.05, asked.shape)
    rotations = np.stack([matrix_from_head_angles(*row) for row in angles])
    neck = NECK_MM + [0, 0, nearness * focal_px] + rng.normal(size=asked.shape) * [30, 20, 40]
    expressions = np.stack([shot.standard for shot in shots])
    expressions = np.clip(expressions * rng.uniform(0.6, 1.1, expressions.shape), 0, 1)
    state = State(rotations, neck - rotations @ NECK_MM, expressions)
    points = posed(face.points_mm(expressions), state)
    seen = np.take_along_axis(points, choose_picks(face, state)[..., None], axis=1)
    points_px = project(camera, seen) + noise_px * rng.normal(size=(*seen.shape[:2], 2))
    pupils = posed(straight_pupils(user)[None], state)
    return SimpleNamespace(
        camera=camera, user=user, state=state, points_mm=points, face=face, pupils_mm=pupils,
        standard=np.stack([shot.standard for shot in shots]), shots=shots,
        landmarks=[
            landmarks_of(one, pupils_px)
            for one, pupils_px in zip(points_px, project(camera, pupils), strict=True)
        ],
    )  # fmt: skip


def straight_pupils(user):
    """Return both pupils (2, 3) of eyes that look straight ahead, in the model frame."""
    model = face_model()
    return eye_centers_mm(model, user.neutral_mm) - [0, 0, model.eyeball_radius_mm]


def landmarks_of(points_px, pupils_px):
    n = len(points_px)
    return Landmarks2D(points_px, np.zeros(n, bool), np.ones(n), pupils_px, np.ones(2))


def prompts(*names):
    """Return the shots whose names start with one of these."""
    return [shot for shot in SHOTS if shot.name.startswith(names) and abs(shot.yaw) < 1.2]
