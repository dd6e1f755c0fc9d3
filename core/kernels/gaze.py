"""Inner loops of the gaze: a pupil's direction, and the adaptive filter."""

import numba
import numpy as np

from core.records import FloatArray


@numba.njit(cache=True, nogil=True)
def pupil_direction(
    pupil: FloatArray,  # (3,) camera frame
    pose: FloatArray,  # (4, 3) rotation matrix, then translation
    center: FloatArray,  # (3,) head frame
    radius: float,
    work: FloatArray,  # (2, 3)
    out: FloatArray,  # (2,) yaw and pitch
) -> None:
    """Write where an eyeball looks whose pupil is seen in the direction of `pupil`."""
    ray, away = work[0], work[1]
    square, along, miss = 0.0, 0.0, 0.0
    for d in range(3):
        ray[d] = pose[0, d] * pupil[0] + pose[1, d] * pupil[1] + pose[2, d] * pupil[2]
        away[d] = center[d]
        for e in range(3):
            away[d] += pose[e, d] * pose[3, e]
        square += ray[d] * ray[d]
    for d in range(3):
        ray[d] /= np.sqrt(square)
        along += ray[d] * away[d]
        miss += away[d] * away[d]
    # A ray beside the eyeball is noise: its nearest point stands in for the rim.
    depth = np.sqrt(max(radius * radius - (miss - along * along), 0.0))
    for d in range(3):
        ray[d] = (along - depth) * ray[d] - away[d]
    out[0] = np.arctan2(ray[0], -ray[2])
    out[1] = np.arctan2(-ray[1], np.hypot(ray[0], ray[2]))


@numba.njit(cache=True, nogil=True)
def join_eyes(
    directions: FloatArray,  # (2, 2) yaw and pitch of the right, then the left eye
    openness: FloatArray,  # (2,) in [0, 1], not both 0
    vergence: float,
    limit: float,
    out: FloatArray,  # (2, 2)
) -> None:
    """Write both eyes' directions: what they have in common, each turned in by the vergence."""
    total = openness[0] + openness[1]
    for axis in range(2):
        # Eyes converge but do not look up and down apart; the right one turns in to the left.
        inward = vergence if axis == 0 else 0.0
        common = openness[0] * (directions[0, axis] - inward)
        common += openness[1] * (directions[1, axis] + inward)
        common /= total
        for eye in range(2):
            angle = common + (inward if eye == 0 else -inward)
            out[eye, axis] = min(max(angle, -limit), limit)


@numba.njit(cache=True, nogil=True)
def move_gaze(
    wanted: FloatArray,  # (2, 2)
    step_s: float,
    cutoffs: FloatArray,  # (2,) cutoff_hz, cutoff_per_speed; both scaled by the openness
    tremble: float,  # rad/s that noise alone makes
    gaze: FloatArray,  # (2, 2) filtered, changed
    speed: FloatArray,  # (2, 2) changed
) -> None:
    """Move the filtered gaze towards the wanted one, faster in a saccade."""
    fastest = 0.0
    for eye in range(2):
        square = 0.0
        for axis in range(2):
            ahead = (wanted[eye, axis] - gaze[eye, axis]) / step_s
            speed[eye, axis] += 0.5 * (ahead - speed[eye, axis])
            square += speed[eye, axis] ** 2
        fastest = max(fastest, np.sqrt(square))
    share = 1.0 - np.exp(
        -2.0 * np.pi * (cutoffs[0] + cutoffs[1] * max(fastest - tremble, 0.0)) * step_s
    )
    for eye in range(2):
        for axis in range(2):
            gaze[eye, axis] += share * (wanted[eye, axis] - gaze[eye, axis])
