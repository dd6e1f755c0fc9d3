"""Landmarks for pictures in which the aligner finds no face: a start for the user's hand.

At +-90 degrees of yaw no detector sees the face. The pose is then known from the prompt, and the
person from the other pictures.
"""

from collections.abc import Sequence

import numpy as np

from core.camera import project
from core.face_model import FaceModel, eye_centers_mm
from core.fit_problem import State, picked, posed
from core.fit_space import face_at
from core.geometry import matrix_from_head_angles, matrix_from_quaternion
from core.model_fit import choose_picks
from core.records import Camera, FloatArray, Landmarks2D, ModelFit, UserBlendshapes
from core.setup_plan import Shot

#: What the head turns about, in the model frame: the top of the spine.
PIVOT_MM = np.array([0.0, 70.0, 90.0])


def guess_landmarks(
    model: FaceModel, user: UserBlendshapes, camera: Camera, shot: Shot,
    fitted: Sequence[Shot], fit: ModelFit,
) -> Landmarks2D:  # fmt: skip
    """Return the landmarks of a prompted picture as the model expects them, confidence 0.

    Args:
        model: The face model.
        user: The user's blendshapes.
        camera: The camera.
        shot: The prompt of the picture.
        fitted: Prompts of the N pictures that were fitted.
        fit: Their fit.
    """
    return landmarks_at(model, user, camera, expected_state(shot, fitted, fit))


def landmarks_at(
    model: FaceModel, user: UserBlendshapes, camera: Camera, state: State
) -> Landmarks2D:
    """Return the landmarks of the one picture of a state, confidence 0, eyes straight ahead."""
    face = face_at(model, user)
    points = project(camera, picked(face, state, choose_picks(face, state)))[0]
    pupils = project(camera, posed(straight_pupils_mm(model, user)[None], state))[0]
    n_points = len(points)
    return Landmarks2D(points, np.zeros(n_points, bool), np.zeros(n_points), pupils, np.zeros(2))


def straight_pupils_mm(model: FaceModel, user: UserBlendshapes) -> FloatArray:
    """Return both pupils (2, 3) of eyes that look straight ahead, in the model frame."""
    forward = np.array([0.0, 0.0, model.eyeball_radius_mm])
    return np.asarray(eye_centers_mm(model, user.neutral_mm) - forward)


def placed_kept(guess: Landmarks2D, before: Landmarks2D) -> Landmarks2D:
    """Return a guess with the points that the user has placed."""
    placed = before.edited
    seen = before.pupil_confidence > 0
    return Landmarks2D(
        np.where(placed[:, None], before.points_px, guess.points_px),
        placed,
        np.where(placed, before.confidence, guess.confidence),
        np.where(seen[:, None], before.pupils_px, guess.pupils_px),
        before.pupil_confidence,
    )


def expected_state(shot: Shot, fitted: Sequence[Shot], fit: ModelFit) -> State:
    """Return pose and coefficients in which a prompt will have been followed; see below."""
    rotation, translation = expected_pose(shot, fitted, fit)
    return State(rotation[None], translation[None], shot.standard[None])


def expected_pose(
    shot: Shot, fitted: Sequence[Shot], fit: ModelFit
) -> tuple[FloatArray, FloatArray]:
    """Return rotation (3, 3) and translation (3,) in which a prompt will have been followed.

    The pose of the fitted picture with the nearest prompt, turned about the neck by the
    difference of the two prompts.
    """
    nearest = nearest_prompt(shot, fitted)
    near = fitted[nearest]
    was = matrix_from_quaternion(fit.rotations_wxyz[nearest])
    asked_there = matrix_from_head_angles(near.yaw, near.pitch, near.roll)
    turned = matrix_from_head_angles(shot.yaw, shot.pitch, shot.roll) @ asked_there.T @ was
    neck = was @ PIVOT_MM + fit.translations_mm[nearest]
    return turned, neck - turned @ PIVOT_MM


def nearest_prompt(shot: Shot, others: Sequence[Shot]) -> int:
    """Return the number of the prompt whose head angles are most like a shot's."""
    prompts = np.array([[one.yaw, one.pitch, one.roll] for one in others])
    distance = np.linalg.norm(prompts - [shot.yaw, shot.pitch, shot.roll], axis=1)
    return int(distance.argmin())
