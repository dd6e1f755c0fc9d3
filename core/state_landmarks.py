"""The landmarks of a picture as a solved face says them, for a hand to put right."""

from dataclasses import replace

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.camera import project, seen_by
from core.face_model import FaceModel, eye_centers_mm
from core.geometry import matrix_from_quaternion
from core.landmark_edit import hidden
from core.landmark_refit import Refitter
from core.landmarks import N_INTERNAL, N_LANDMARKS
from core.records import Camera, FaceState, FloatArray, Landmarks2D, UserBlendshapes

#: Trust in a point that the user saw and left where it was.
SEEN = 0.8
#: The aligner's irises are believed from this confidence on, and so near to where the tracker has
#: them, in distances of the pupils.
OPEN, NEAR = 0.5, 0.2


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


def with_pupils(landmarks: Landmarks2D, seen: Landmarks2D) -> Landmarks2D:
    """Return a tracker's landmarks with the pupils where the aligner sees them, if it is near.

    Args:
        landmarks: The tracker's.
        seen: The aligner's, of the same picture.
    """
    apart = np.linalg.norm(seen.pupils_px - landmarks.pupils_px, axis=1)
    between = float(np.linalg.norm(np.diff(landmarks.pupils_px, axis=0)))
    near = (apart < NEAR * between) & (seen.pupil_confidence >= OPEN)
    return replace(
        landmarks,
        pupils_px=np.where(near[:, None], seen.pupils_px, landmarks.pupils_px),
        pupil_confidence=np.where(near, seen.pupil_confidence, landmarks.pupil_confidence),
    )


def with_outline(landmarks: Landmarks2D, refitter: Refitter) -> Landmarks2D:
    """Return a tracker's landmarks with those of the outline on the outline.

    What trackers have in their place are points that stay on the skin of the cheeks.
    """
    edited, confidence = landmarks.edited.copy(), landmarks.confidence.copy()
    edited[N_INTERNAL:], confidence[N_INTERNAL:] = True, 0.0
    unseen = replace(landmarks, edited=edited, confidence=confidence)
    points = landmarks.points_px.copy()
    points[N_INTERNAL:] = refitter.model_points(unseen, np.full(len(EXPRESSION_NAMES), np.nan))[
        N_INTERNAL:
    ]
    return replace(landmarks, points_px=points)


def confirmed(landmarks: Landmarks2D) -> Landmarks2D:
    """Return the landmarks with trust in all that the user has seen and not called hidden."""
    seen = np.maximum(landmarks.confidence, SEEN)
    return replace(landmarks, confidence=np.where(hidden(landmarks), landmarks.confidence, seen))
