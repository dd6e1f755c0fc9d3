"""Inner loops of landmark flow: how a face moves as a whole, and which points stray from it."""

import numba
import numpy as np

from core.records import BoolArray, FloatArray

#: Share of the points' spread added to the normal equations: where they do not tell, it stays.
_RIDGE = 1e-3
#: Weight of a point at this distance from the common motion, in parts of the face, is halved.
_STRAY = 0.02
#: Rounds in which straying points lose weight.
_ROUNDS = 3


@numba.njit(cache=True, nogil=True)
def fit_camera(
    points: FloatArray,  # (P, 3) picture and depth before
    after: FloatArray,  # (P, 2)
    weights: FloatArray,  # (P,)
    out: FloatArray,  # (2, 4)
) -> None:
    """Write the affine camera that takes points best to others: nearly a shift if they don't tell.

    It is the rest R of `after = points + R points + shift` that is kept small.
    """
    center, target = np.zeros(3), np.zeros(2)
    square, mixed = np.zeros((3, 3)), np.zeros((2, 3))
    total = 1e-12
    for p in range(points.shape[0]):
        total += weights[p]
        for d in range(3):
            center[d] += weights[p] * points[p, d]
        for e in range(2):
            target[e] += weights[p] * after[p, e]
    center /= total
    target /= total
    for p in range(points.shape[0]):
        share = weights[p] / total
        for d in range(3):
            away = share * (points[p, d] - center[d])
            for e in range(3):
                square[d, e] += away * (points[p, e] - center[e])
            for e in range(2):
                rest = (after[p, e] - target[e]) - (points[p, e] - center[e])
                mixed[e, d] += away * rest
    ridge = _RIDGE * (square[0, 0] + square[1, 1] + square[2, 2]) + 1e-9
    for d in range(3):
        square[d, d] += ridge
    _solve3(square, mixed, out)
    for e in range(2):
        out[e, e] += 1.0
        out[e, 3] = target[e]
        for d in range(3):
            out[e, 3] -= out[e, d] * center[d]


@numba.njit(cache=True, nogil=True)
def _solve3(
    square: FloatArray,  # (3, 3) positive definite
    right: FloatArray,  # (2, 3)
    out: FloatArray,  # (2, >= 3), its first three columns
) -> None:
    """Write the solutions of both rows by Cramer's rule."""
    a, b, c = square[0, 0], square[0, 1], square[0, 2]
    d, e, f = square[1, 1], square[1, 2], square[2, 2]
    minors = (d * f - e * e, c * e - b * f, b * e - c * d)
    determinant = a * minors[0] + b * minors[1] + c * minors[2]
    for k in range(2):
        u, v, w = right[k, 0], right[k, 1], right[k, 2]
        out[k, 0] = (minors[0] * u + minors[1] * v + minors[2] * w) / determinant
        out[k, 1] = (minors[1] * u + (a * f - c * c) * v + (b * c - a * e) * w) / determinant
        out[k, 2] = (minors[2] * u + (b * c - a * e) * v + (a * d - b * b) * w) / determinant


@numba.njit(cache=True, nogil=True)
def agree(
    points: FloatArray,  # (P, 3) picture and depth before
    related: BoolArray,  # (P, P) which points move like each other
    limits: FloatArray,  # (4,) face's size in px; reach, odd motion, both in parts of it; calm
    camera: FloatArray,  # (2, 4) written: how the face as a whole moved
    moved: FloatArray,  # (P, 2) by flow; replaced by what the neighbours do as far as it strays
    trust: FloatArray,  # (P,) in flow, lowered where it strays
) -> None:
    """Replace the motion of points that stray from their neighbours on the same feature."""
    n, size = points.shape[0], limits[0]
    weights = trust.copy()
    rest = np.empty((n, 2))
    for _ in range(_ROUNDS):
        fit_camera(points, moved, weights, camera)
        for p in range(n):
            for e in range(2):
                rest[p, e] = moved[p, e] - _carried(camera, points, p, e)
            square = rest[p, 0] ** 2 + rest[p, 1] ** 2
            weights[p] = trust[p] / (1 + square / (_STRAY * size) ** 2)
    # The neighbours' trust is that before any was lowered: the order must not matter.
    for p in range(n):
        weights[p] = trust[p]
    reach = 2 * (limits[1] * size) ** 2
    for p in range(n):
        total, x, y = limits[3], 0.0, 0.0
        for q in range(n):
            if related[p, q]:
                square = (points[p, 0] - points[q, 0]) ** 2 + (points[p, 1] - points[q, 1]) ** 2
                weight = weights[q] * np.exp(-square / reach)
                total += weight
                x += weight * rest[q, 0]
                y += weight * rest[q, 1]
        x /= total
        y /= total
        odd = ((rest[p, 0] - x) ** 2 + (rest[p, 1] - y) ** 2) / (limits[2] * size) ** 2
        trust[p] /= 1 + odd
        moved[p, 0] = _carried(camera, points, p, 0) + x + trust[p] * (rest[p, 0] - x)
        moved[p, 1] = _carried(camera, points, p, 1) + y + trust[p] * (rest[p, 1] - y)


@numba.njit(cache=True, nogil=True)
def _carried(camera: FloatArray, points: FloatArray, p: int, e: int) -> float:
    """Return one coordinate of a point carried by the camera."""
    return (
        camera[e, 0] * points[p, 0]
        + camera[e, 1] * points[p, 1]
        + camera[e, 2] * points[p, 2]
        + camera[e, 3]
    )
