"""The landmarks of a picture as a solved face says them, for a hand to put right."""

import numpy as np

from core.camera import project, seen_by
from core.face_model import FaceModel, eye_centers_mm
from core.geometry import matrix_from_quaternion
from core.landmarks import N_LANDMARKS
from core.records import Camera, FaceState, FloatArray, Landmarks2D, UserBlendshapes


def landmarks_of_state(
    model: FaceModel, user: UserBlendshapes, camera: Camera, state: FaceState,
    size_px: tuple[int, int],
) -> Landmarks2D:  # fmt: skip
    """Return landmarks and pupils where a tracker had them, none of them placed by hand.

    Args:
        model: The face model of the user's profile.
        user: Whose face it is.
        camera: Of the profile.
        state: The solved face.
        size_px: (width, height) of the picture.
    """
    sure = float(np.clip(state.confidence, 0.0, 1.0))
    pupils_px = project(seen_by(camera, size_px), pupils_of_state(model, user, state))
    return Landmarks2D(
        state.landmarks_px,
        np.zeros(N_LANDMARKS, bool),
        np.full(N_LANDMARKS, sure),
        pupils_px,
        np.full(2, sure),
    )


def pupils_of_state(model: FaceModel, user: UserBlendshapes, state: FaceState) -> FloatArray:
    """Return both pupils (2, 3) in the camera frame: on the eyeballs, where the eyes look."""
    yaw, pitch = state.gaze_rad[:, 0], state.gaze_rad[:, 1]
    looks = np.stack(
        [np.sin(yaw) * np.cos(pitch), -np.sin(pitch), -np.cos(yaw) * np.cos(pitch)], axis=-1
    )
    centers = eye_centers_mm(model, user.neutral_mm)
    in_head = centers + float(model.eyeball_radius_mm) * looks
    rotation = matrix_from_quaternion(state.rotation_wxyz)
    return np.asarray(in_head @ rotation.T + state.translation_mm)
