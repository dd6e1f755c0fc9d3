"""Hair that hangs to the jaw: a curtain from temple to temple round the back of the head."""

import numpy as np

from core.records import F32, I32, FloatArray

#: The curtain's edges at the face, in degrees from straight ahead; its rows and columns.
_OPEN_DEG, _ROWS, _COLUMNS = 47.0, 15, 68
#: The axis that it hangs around (z), and its heights, mm down from the eyes.
_AXIS_Z_MM, _TOP_MM, _END_MM = 78.0, -62.0, 86.0


def curtain(hair_mm: FloatArray, head_mm: FloatArray) -> tuple[FloatArray, I32, F32, F32]:
    """Return points (n, 3), triangles (T, 3), uv (T, 3, 2) and coverage (n,) for a head.

    Args:
        hair_mm: (S, 3) surface of the hair on the scalp, which the curtain goes on from.
        head_mm: (V, 3) neutral face of the person.
    """
    turn = np.deg2rad(np.linspace(_OPEN_DEG, 360 - _OPEN_DEG, _COLUMNS))
    down = np.linspace(0, 1, _ROWS)
    heights = _TOP_MM + (_END_MM - _TOP_MM) * down
    skin = head_mm[(head_mm[:, 2] > 5) & (np.abs(head_mm[:, 0]) > 25)]
    solid = np.concatenate([hair_mm, skin])
    radius = np.stack([_radius_mm(solid, turn, height) for height in heights])
    # What hangs is as wide as the head at its widest, and turns in at the ends.
    hanging = np.maximum.accumulate(radius, axis=0)
    edge = np.minimum(np.arange(_COLUMNS), np.arange(_COLUMNS)[::-1]) / 7.0
    face = np.exp(-(edge**2))
    locks = np.sin(29 * turn) + 0.7 * np.sin(47 * turn + 1)
    swell = np.sin(np.pi * down)[:, None]
    reach = hanging - 3 + 7 * swell - 13 * down[:, None] ** 3 + 1.2 * swell * locks
    reach -= 10.0 * face * down[:, None]
    back = np.clip(-np.cos(turn), 0, 1)
    y = heights[:, None] - 10 * down[:, None] * back + 2 * down[:, None] ** 2 * locks
    x, z = reach * np.sin(turn), _AXIS_Z_MM - reach * np.cos(turn)
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    ends = np.clip((1 - down) / 0.12, 0, 1) * np.clip(0.4 + down / 0.15, 0, 1)
    coverage = np.outer(ends, np.clip(0.42 + 2.2 * edge, 0, 1)).reshape(-1)
    uv = np.stack(np.meshgrid(np.linspace(0, 4, _COLUMNS), down * 0.8), axis=-1).reshape(-1, 2)
    triangles = _grid_triangles()
    return points, triangles, uv[triangles].astype(np.float32), coverage.astype(np.float32)


def _radius_mm(solid_mm: FloatArray, turn: FloatArray, height_mm: float) -> FloatArray:
    """Return how far hair and head reach from the axis at each angle, near one height."""
    level = solid_mm[np.abs(solid_mm[:, 1] - height_mm) < 9]
    x, z = level[:, 0], _AXIS_Z_MM - level[:, 2]
    angle, away = np.arctan2(x, z) % (2 * np.pi), np.hypot(x, z)
    near = np.abs(angle[None] - turn[:, None]) < 0.16
    far = np.where(near, away[None], 0).max(axis=1, initial=0)
    smooth = np.convolve(np.pad(far, 2, mode="edge"), np.ones(5) / 5, mode="valid")
    return np.asarray(0.5 * (smooth + smooth[::-1]))


def _grid_triangles() -> I32:
    row, column = np.meshgrid(np.arange(_ROWS - 1), np.arange(_COLUMNS - 1), indexing="ij")
    a = (row * _COLUMNS + column).reshape(-1)
    b, c, d = a + 1, a + _COLUMNS + 1, a + _COLUMNS
    # Seen from outside: angles grow from the subject's left over the back to the right.
    return np.concatenate([np.stack([a, c, b], 1), np.stack([a, d, c], 1)]).astype(np.int32)
