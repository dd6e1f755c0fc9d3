"""Where head and body are in front of the camera."""

from dataclasses import dataclass

import numpy as np

from app.performer.takes import Moment
from app.render.scene import placed
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.records import FloatArray

#: Model frame: where the skull turns on the neck, and where the body turns.
SKULL_JOINT_MM = np.array([0.0, 72.0, 88.0])
BODY_JOINT_MM = np.array([0.0, 190.0, 100.0])
#: Shares of the head's yaw, pitch and roll that the body makes, and how far a neck can turn.
_FOLLOW = np.array([0.12, 0.1, 0.15])
_NECK_YAW_RAD = np.deg2rad(58.0)


@dataclass(frozen=True, slots=True, eq=False)
class Posture:
    """Poses of head and body.

    Attributes:
        rotation_wxyz: (4,) model to camera.
        translation_mm: (3,) model to camera.
        head_to_camera: (4, 4) the same as a matrix.
        body_to_camera: (4, 4) for what the body holds.
    """

    rotation_wxyz: FloatArray
    translation_mm: FloatArray
    head_to_camera: FloatArray
    body_to_camera: FloatArray


def posture_of(moment: Moment, seat_mm: FloatArray) -> Posture:
    """Return the poses of head and body at a moment.

    The head turns about the joint under the skull and the body about one between the shoulders,
    so a turn also moves the face, as in life.

    Args:
        moment: Head angles and shift.
        seat_mm: (3,) camera frame, where the eyes' midpoint is when nothing moves.
    """
    angles = moment.head_rad
    beyond = np.sign(angles[0]) * max(0.0, abs(angles[0]) - _NECK_YAW_RAD)
    body_angles = _FOLLOW * angles + np.array([0.9 * beyond, 0.0, 0.0])
    body, head = matrix_from_head_angles(*body_angles), matrix_from_head_angles(*angles)
    place = np.asarray(seat_mm) + moment.shift_mm
    body_mm = place + BODY_JOINT_MM - body @ BODY_JOINT_MM
    head_mm = body_mm + body @ SKULL_JOINT_MM - head @ SKULL_JOINT_MM
    return Posture(
        quaternion_from_matrix(head), head_mm, placed(head, head_mm), placed(body, body_mm)
    )
