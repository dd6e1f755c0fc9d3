"""Inner loops of the drive: filters by group, and the head's movement from its centre."""

import numba
import numpy as np

from core.records import I32, FloatArray


@numba.njit(cache=True, nogil=True)
def follow_groups(
    new: FloatArray,  # (D,) tracked
    order: I32,  # (D,) values sorted by group
    starts: I32,  # (G+1,) first of each group in `order`
    noise: FloatArray,  # (D,) size of the noise of each value
    settings: FloatArray,  # (G, 4) cutoff_hz, cutoff_per_speed, quiet_speed, speed_cutoff_hz
    step_s: float,
    speed: FloatArray,  # (D,) low-passed speed in noise / s, changed
    held: FloatArray,  # (D,) filtered, changed
) -> None:
    """Move filtered values towards new ones, all of a group by one share of their way."""
    for g in range(starts.shape[0] - 1):
        share = 1.0 - np.exp(-2.0 * np.pi * settings[g, 3] * step_s)
        fastest = 0.0
        for i in range(starts[g], starts[g + 1]):
            d = order[i]
            ahead = (new[d] - held[d]) / (noise[d] * step_s)
            speed[d] += share * (ahead - speed[d])
            fastest = max(fastest, abs(speed[d]))
        cutoff_hz = settings[g, 0] + settings[g, 1] * max(fastest - settings[g, 2], 0.0)
        passed = 1.0 - np.exp(-2.0 * np.pi * cutoff_hz * step_s)
        for i in range(starts[g], starts[g + 1]):
            d = order[i]
            held[d] += passed * (new[d] - held[d])


@numba.njit(cache=True, nogil=True)
def times(
    a: FloatArray,  # (4,) wxyz
    b: FloatArray,  # (4,) wxyz
    out: FloatArray,  # (4,) neither a nor b
) -> None:
    """Write the rotation b followed by a."""
    out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3]
    out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2]
    out[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1]
    out[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]


@numba.njit(cache=True, nogil=True)
def times_back(
    a: FloatArray,  # (4,) wxyz
    b: FloatArray,  # (4,) wxyz
    out: FloatArray,  # (4,) neither a nor b
) -> None:
    """Write the inverse of the rotation b followed by a."""
    out[0] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
    out[1] = -a[0] * b[1] + a[1] * b[0] - a[2] * b[3] + a[3] * b[2]
    out[2] = -a[0] * b[2] + a[1] * b[3] + a[2] * b[0] - a[3] * b[1]
    out[3] = -a[0] * b[3] - a[1] * b[2] + a[2] * b[1] + a[3] * b[0]


@numba.njit(cache=True, nogil=True)
def facing(
    place: FloatArray,  # (3,) mm in the camera frame
    out: FloatArray,  # (4,) wxyz
) -> None:
    """Write the rotation of a head that faces the camera; see geometry.rotation_facing_camera."""
    if place[2] < 1e-6:
        out[0], out[1], out[2], out[3] = 1.0, 0.0, 0.0, 0.0
        return
    yaw = 0.5 * np.arctan2(place[0], place[2])
    pitch = -0.5 * np.arctan2(place[1], np.hypot(place[0], place[2]))
    cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    out[0], out[1], out[2], out[3] = cy * cp, cy * sp, sy * cp, -sy * sp


@numba.njit(cache=True, nogil=True)
def angles_of(
    q: FloatArray,  # (4,) wxyz, unit length
    out: FloatArray,  # (3,) yaw, pitch, roll
) -> None:
    """Write the head angles of a rotation; see geometry.head_angles_from_matrix."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    sine = 2.0 * (y * z - w * x)
    out[0] = np.arctan2(-2.0 * (x * z + w * y), 1.0 - 2.0 * (x * x + y * y))
    out[1] = np.arcsin(min(max(sine, -1.0), 1.0))
    out[2] = np.arctan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z))


@numba.njit(cache=True, nogil=True)
def from_angles(
    angles: FloatArray,  # (3,) yaw, pitch, roll
    out: FloatArray,  # (4,) wxyz
) -> None:
    """Write the rotation of head angles; see geometry.matrix_from_head_angles."""
    cy, sy = np.cos(-0.5 * angles[0]), np.sin(-0.5 * angles[0])
    cp, sp = np.cos(-0.5 * angles[1]), np.sin(-0.5 * angles[1])
    cr, sr = np.cos(0.5 * angles[2]), np.sin(0.5 * angles[2])
    w, x, y, z = cy * cp, cy * sp, sy * cp, -sy * sp
    out[0], out[1] = w * cr - z * sr, x * cr + y * sr
    out[2], out[3] = y * cr - x * sr, z * cr + w * sr


@numba.njit(cache=True, nogil=True)
def deviation(
    rotation: FloatArray,  # (4,) model to camera
    place: FloatArray,  # (3,) mm
    centre: FloatArray,  # (7,) rotation against the line of sight, place
    work: FloatArray,  # (3, 4)
    out: FloatArray,  # (6,) yaw, pitch, roll, x, y, z from the centre
) -> None:
    """Write how far a head is from its centre, as seen from the camera."""
    facing(place, work[0])
    # Inverse of the line of sight, then the head: the head's rotation against it.
    for i in range(1, 4):
        work[0, i] = -work[0, i]
    times(work[0], rotation, work[1])
    times_back(work[1], centre[:4], work[2])
    angles_of(work[2], out[:3])
    for d in range(3):
        out[3 + d] = place[d] - centre[4 + d]


@numba.njit(cache=True, nogil=True)
def placed_head(
    away: FloatArray,  # (6,) yaw, pitch, roll, x, y, z from the centre
    rest: FloatArray,  # (7,) rotation against the line of sight, place
    work: FloatArray,  # (3, 4)
    rotation: FloatArray,  # (4,) written
    place: FloatArray,  # (3,) written
) -> None:
    """Write where a head is that deviates so far from rest; undoes `deviation`."""
    for d in range(3):
        place[d] = rest[4 + d] + away[3 + d]
    from_angles(away[:3], work[0])
    times(work[0], rest[:4], work[1])
    facing(place, work[2])
    times(work[2], work[1], rotation)
    length = np.sqrt(np.sum(rotation * rotation))
    # Like all rotations here, one with w >= 0.
    scale = (1.0 if rotation[0] >= 0.0 else -1.0) / length
    for i in range(4):
        rotation[i] *= scale
