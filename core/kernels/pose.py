"""Inner loop of the pose filter."""

import numba
import numpy as np

from core.records import FloatArray


@numba.njit(cache=True, nogil=True)
def low_pass(
    innovation: FloatArray,  # (D,) new value minus filtered value; in: raw, out: to be added
    speed: FloatArray,  # (D,) low-passed speed, changed
    settings: FloatArray,  # (3,) cutoff_hz, cutoff_per_speed, speed_cutoff_hz
    step_s: float,
) -> None:
    """Scale an innovation to what a speed-adaptive first-order low-pass lets through."""
    share = 1.0 - np.exp(-2.0 * np.pi * settings[2] * step_s)
    square = 0.0
    for d in range(innovation.shape[0]):
        speed[d] += share * (innovation[d] / step_s - speed[d])
        square += speed[d] * speed[d]
    cutoff_hz = settings[0] + settings[1] * np.sqrt(square)
    passed = 1.0 - np.exp(-2.0 * np.pi * cutoff_hz * step_s)
    for d in range(innovation.shape[0]):
        innovation[d] *= passed


@numba.njit(cache=True, nogil=True)
def rotation_between(
    start: FloatArray,  # (4,) wxyz
    end: FloatArray,  # (4,) wxyz
    out: FloatArray,  # (3,) rad
) -> None:
    """Write the rotation vector that turns `start` into `end`, applied from the left."""
    w0, x0, y0, z0 = start[0], -start[1], -start[2], -start[3]
    w1, x1, y1, z1 = end[0], end[1], end[2], end[3]
    w = w1 * w0 - x1 * x0 - y1 * y0 - z1 * z0
    x = w1 * x0 + x1 * w0 + y1 * z0 - z1 * y0
    y = w1 * y0 - x1 * z0 + y1 * w0 + z1 * x0
    z = w1 * z0 + x1 * y0 - y1 * x0 + z1 * w0
    # A quaternion and its negative are one rotation: take the short way.
    sign = -1.0 if w < 0.0 else 1.0
    sine = np.sqrt(x * x + y * y + z * z)
    scale = sign * (2.0 if sine < 1e-12 else 2.0 * np.arctan2(sine, sign * w) / sine)
    out[0], out[1], out[2] = scale * x, scale * y, scale * z


@numba.njit(cache=True, nogil=True)
def rotate_by(
    rotation: FloatArray,  # (4,) wxyz, changed, kept at unit length
    vector: FloatArray,  # (3,) rad
) -> None:
    """Turn a rotation by a rotation vector, applied from the left."""
    angle = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    scale = 0.5 if angle < 1e-12 else np.sin(0.5 * angle) / angle
    w1, x1, y1, z1 = np.cos(0.5 * angle), scale * vector[0], scale * vector[1], scale * vector[2]
    w0, x0, y0, z0 = rotation[0], rotation[1], rotation[2], rotation[3]
    rotation[0] = w1 * w0 - x1 * x0 - y1 * y0 - z1 * z0
    rotation[1] = w1 * x0 + x1 * w0 + y1 * z0 - z1 * y0
    rotation[2] = w1 * y0 - x1 * z0 + y1 * w0 + z1 * x0
    rotation[3] = w1 * z0 + x1 * y0 - y1 * x0 + z1 * w0
    length = np.sqrt(np.sum(rotation * rotation))
    for i in range(4):
        rotation[i] /= length


@numba.njit(cache=True, nogil=True)
def filter_pose(
    rotation: FloatArray,  # (4,) wxyz of the new frame
    translation: FloatArray,  # (3,) of the new frame
    step_s: float,
    settings: FloatArray,  # (3, 3) of rotation, across, along
    speeds: FloatArray,  # (2, 3) of rotation and translation, changed
    work: FloatArray,  # (3,)
    held_rotation: FloatArray,  # (4,) filtered, changed
    held_translation: FloatArray,  # (3,) filtered, changed
) -> None:
    """Move the filtered pose towards a new one."""
    rotation_between(held_rotation, rotation, work)
    low_pass(work, speeds[0], settings[0], step_s)
    rotate_by(held_rotation, work)
    for d in range(3):
        work[d] = translation[d] - held_translation[d]
    low_pass(work[:2], speeds[1, :2], settings[1], step_s)
    low_pass(work[2:], speeds[1, 2:], settings[2], step_s)
    for d in range(3):
        held_translation[d] += work[d]
