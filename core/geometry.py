"""Rotations, rigid transforms and registrations.

Rotations are unit quaternions (w, x, y, z) or 3x3 matrices that act on column vectors; points
are rows. Head angles: yaw is positive when the head turns to the subject's left, pitch when it
looks up, roll when it tilts towards the subject's left shoulder. A face with the identity
rotation looks straight into the camera.
"""

import numpy as np

from core.records import FloatArray


def matrix_from_quaternion(rotation_wxyz: FloatArray) -> FloatArray:
    """Return rotation matrices (..., 3, 3) of quaternions (..., 4) of any length but zero."""
    q = np.asarray(rotation_wxyz, float)
    w, x, y, z = np.moveaxis(q / np.linalg.norm(q, axis=-1, keepdims=True), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def quaternion_from_matrix(matrix: FloatArray) -> FloatArray:
    """Return the unit quaternion (4,), w >= 0, of a rotation matrix (3, 3)."""
    m = np.asarray(matrix, float)
    trace = float(np.trace(m))
    # The largest of the four squared components is divided by; never near zero.
    squares = np.array([trace, m[0, 0], m[1, 1], m[2, 2]])
    q = np.empty(4)
    if squares.argmax() == 0:
        q[0] = 1 + trace
        q[1:] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    else:
        i = int(squares.argmax()) - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        q[0] = m[k, j] - m[j, k]
        q[1 + i] = 1 + m[i, i] - m[j, j] - m[k, k]
        q[1 + j] = m[j, i] + m[i, j]
        q[1 + k] = m[k, i] + m[i, k]
    q /= np.linalg.norm(q)
    return q if q[0] >= 0 else -q


def multiply_quaternions(a_wxyz: FloatArray, b_wxyz: FloatArray) -> FloatArray:
    """Return the quaternion (4,) of the rotation b followed by a."""
    w, v = a_wxyz[0], np.asarray(a_wxyz[1:])
    s, u = b_wxyz[0], np.asarray(b_wxyz[1:])
    return np.concatenate([[w * s - v @ u], w * u + s * v + np.cross(v, u)])


def matrix_from_rotation_vector(rotation_rad: FloatArray) -> FloatArray:
    """Return the matrix (3, 3) of a rotation vector (3,) (axis times angle)."""
    angle = float(np.linalg.norm(rotation_rad))
    half = 0.5 * angle
    scale = 0.5 if angle < 1e-9 else np.sin(half) / angle
    return matrix_from_quaternion(
        np.concatenate([[np.cos(half)], scale * np.asarray(rotation_rad)])
    )


def rotation_vector_from_matrix(matrix: FloatArray) -> FloatArray:
    """Return the rotation vector (3,) of a rotation matrix, its angle in [0, pi]."""
    q = quaternion_from_matrix(matrix)
    sine = float(np.linalg.norm(q[1:]))
    return 2 * q[1:] if sine < 1e-9 else (2 * np.arctan2(sine, q[0]) / sine) * q[1:]


def matrix_from_head_angles(yaw_rad: float, pitch_rad: float, roll_rad: float) -> FloatArray:
    """Return the model-to-camera rotation of a head: roll first, then pitch, then yaw."""
    cy, sy = np.cos(yaw_rad), np.sin(yaw_rad)
    cp, sp = np.cos(pitch_rad), np.sin(pitch_rad)
    cr, sr = np.cos(roll_rad), np.sin(roll_rad)
    about_y = np.array([[cy, 0, -sy], [0, 1, 0], [sy, 0, cy]])
    about_x = np.array([[1, 0, 0], [0, cp, sp], [0, -sp, cp]])
    about_z = np.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]])
    return np.asarray(about_y @ about_x @ about_z)


def head_angles_from_matrix(matrix: FloatArray) -> FloatArray:
    """Return (yaw, pitch, roll) in rad of a model-to-camera rotation."""
    m = np.asarray(matrix, float)
    pitch = np.arcsin(np.clip(m[1, 2], -1, 1))
    return np.array([np.arctan2(-m[0, 2], m[2, 2]), pitch, np.arctan2(m[1, 0], m[1, 1])])


def rotation_facing_camera(translation_mm: FloatArray) -> FloatArray:
    """Return the rotation (3, 3) of a head at (3,) in the camera frame that faces the camera."""
    x, y, z = np.asarray(translation_mm, float)
    if z < 1e-6:
        return np.eye(3)
    yaw, pitch = np.arctan2(x, z), np.arctan2(y, np.hypot(x, z))
    cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_x = np.array([[1, 0, 0], [0, cp, sp], [0, -sp, cp]])
    return np.asarray(about_y @ about_x)


def rotation_angle_rad(a_wxyz: FloatArray, b_wxyz: FloatArray) -> FloatArray:
    """Return the angle between rotations given as unit quaternions (..., 4)."""
    dot = np.abs(np.sum(np.asarray(a_wxyz) * np.asarray(b_wxyz), axis=-1))
    return np.asarray(2 * np.arccos(np.clip(dot, 0, 1)))


def register_rigid(source: FloatArray, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return rotation (3, 3) and translation (3,) that bring source points nearest to target.

    Least squares by the singular value decomposition of the cross-covariance [Cao13, face
    tracking; Besl and McKay 1992].

    Args:
        source: (P, 3).
        target: (P, 3), the same points elsewhere.
    """
    source_mean, target_mean = source.mean(axis=0), target.mean(axis=0)
    u, _, vt = np.linalg.svd((target - target_mean).T @ (source - source_mean))
    # Without the sign a reflection could fit better than any rotation.
    sign = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    rotation = (u * sign) @ vt
    return rotation, target_mean - rotation @ source_mean


def procrustes(source: FloatArray, target: FloatArray) -> tuple[float, FloatArray, FloatArray]:
    """Return scale, rotation (3, 3) and translation (3,) of the similarity source -> target."""
    rotation, _ = register_rigid(source, target)
    centred = source - source.mean(axis=0)
    turned = centred @ rotation.T
    scale = float(np.sum(turned * (target - target.mean(axis=0))) / np.sum(centred**2))
    return scale, rotation, target.mean(axis=0) - scale * rotation @ source.mean(axis=0)
