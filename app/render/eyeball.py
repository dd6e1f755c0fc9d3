"""The eyeball's mesh: a sphere whose texture is a front view, distance = angle from the pupil."""

import numpy as np

from core.records import F32, I32, FloatArray

#: Angle from the pupil that the edge of the eye texture shows.
EDGE_RAD = np.deg2rad(110.0)
_RINGS, _SECTORS = 10, 22


def eyeball() -> tuple[F32, F32, I32]:
    """Return directions (G, 3) from the centre, uv (G, 2) and triangles of a unit eyeball.

    It looks to -z, at the viewer. Only what the texture shows is made; the rest lies in the head.
    """
    angle = np.concatenate([[0.0], np.linspace(0.12, EDGE_RAD, _RINGS)])
    turn = np.arange(_SECTORS) * 2 * np.pi / _SECTORS
    side = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    rings = [np.array([[0.0, 0.0, -1.0]])] + [
        np.column_stack([np.sin(a) * side, np.full(_SECTORS, -np.cos(a))]) for a in angle[1:]
    ]
    uv = [np.array([[0.5, 0.5]])] + [0.5 + 0.5 * a / EDGE_RAD * side for a in angle[1:]]
    now = np.arange(_SECTORS)
    after = (now + 1) % _SECTORS
    fan = np.stack([np.zeros_like(now), 1 + after, 1 + now], axis=1)
    bands = [fan]
    for ring in range(_RINGS - 1):
        inner, outer = 1 + ring * _SECTORS, 1 + (ring + 1) * _SECTORS
        bands.append(np.stack([inner + now, inner + after, outer + now], axis=1))
        bands.append(np.stack([inner + after, outer + after, outer + now], axis=1))
    triangles = np.concatenate(bands).astype(np.int32)
    return (
        np.concatenate(rings).astype(np.float32),
        np.concatenate(uv).astype(np.float32),
        triangles,
    )


def gaze_matrix(yaw_rad: float, pitch_rad: float) -> FloatArray:
    """Return the rotation (3, 3) in the head frame that turns the straight look by a gaze.

    Yaw is positive to the subject's left (+x), pitch positive up (-y).
    """
    cy, sy = np.cos(yaw_rad), np.sin(yaw_rad)
    cp, sp = np.cos(pitch_rad), np.sin(pitch_rad)
    about_y = np.array([[cy, 0, -sy], [0, 1, 0], [sy, 0, cy]])
    about_x = np.array([[1, 0, 0], [0, cp, sp], [0, -sp, cp]])
    return np.asarray(about_y @ about_x)
