"""The user's own neutral face and 46 blendshapes [Cao13, 4.1, eq. 5]."""

import numpy as np

from core.face_model import FaceModel, deltas_mm, neutral_mm
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    matrix_from_quaternion,
    quaternion_from_matrix,
    rotation_facing_camera,
)
from core.records import I32, FloatArray, ModelFit, UserBlendshapes

#: Reach of a landmark's offset over the face; wide, so that lids and lips move together.
REACH_MM = 18.0


def user_blendshapes(model: FaceModel, fit: ModelFit) -> UserBlendshapes:
    """Return the face of the fitted person.

    The paper stops at the identity weights. We add what the landmarks of all pictures say
    beyond them: as a smooth displacement of the neutral face, and what is left of it as places
    of the landmarks beside their vertices.

    Args:
        model: The bilinear face model.
        fit: Its fit to the setup pictures.
    """
    neutral = neutral_mm(model, fit.identity)
    smooth = spread_offsets(neutral, model.landmark_vertices, fit.offsets_mm)
    left = fit.offsets_mm - smooth[model.landmark_vertices]
    return UserBlendshapes(
        fit.identity, neutral + smooth, deltas_mm(model, fit.identity), left, usual_rotation(fit)
    )


def mean_user(model: FaceModel) -> UserBlendshapes:
    """Return the model's mean face as a user's."""
    identity = np.zeros(model.n_identities)
    return UserBlendshapes(identity, neutral_mm(model, identity), deltas_mm(model, identity))


def usual_rotation(fit: ModelFit) -> FloatArray:
    """Return the median rotation (4,) of the heads, against heads that face the camera."""
    rotations = matrix_from_quaternion(fit.rotations_wxyz)
    facing = [rotation_facing_camera(place) for place in fit.translations_mm]
    angles = [
        head_angles_from_matrix(straight.T @ turned)
        for straight, turned in zip(facing, rotations, strict=True)
    ]
    return quaternion_from_matrix(matrix_from_head_angles(*np.median(angles, axis=0)))


def spread_offsets(
    points_mm: FloatArray, landmark_vertices: I32, offsets_mm: FloatArray
) -> FloatArray:
    """Return a smooth displacement (V, 3) that follows the offsets of the landmarks.

    Gaussian process regression with noise as large as the offsets: neighbours that agree move
    the surface, one that disagrees does not, so that eyelids still meet and lips stay closed.

    Args:
        points_mm: (V, 3).
        landmark_vertices: (L,) vertices with offsets.
        offsets_mm: (L, 3).
    """
    landmarks = points_mm[landmark_vertices]
    gram = _closeness(landmarks, landmarks)
    weights = np.linalg.solve(gram + np.eye(len(landmarks)), offsets_mm)
    return _closeness(points_mm, landmarks) @ weights


def _closeness(a_mm: FloatArray, b_mm: FloatArray) -> FloatArray:
    squares = np.sum((a_mm[:, None] - b_mm[None]) ** 2, axis=-1)
    return np.asarray(np.exp(-0.5 * squares / REACH_MM**2))
