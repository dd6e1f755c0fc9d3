"""Reads the colour of skin at points of a face: means of small squares, as logarithms."""

import numba
import numpy as np

from core.records import U8, FloatArray

#: Grey levels added before the logarithm: noise in the dark must not count much.
_DARK = 10.0


@numba.njit(cache=True, nogil=True)
def read_skin(
    rgb: U8,  # (H, W, 3)
    points: FloatArray,  # (P, 2) px
    half: int,  # px, a square has 2 half + 1 on a side
    out: FloatArray,  # (P, 3) brightness, red to green, blue to green, all logarithms
    inside: FloatArray,  # (P,) 1 where the point lies in the picture, else 0
) -> None:
    """Write the mean colour about each point; points outside are read at the border."""
    height, width = rgb.shape[0], rgb.shape[1]
    for p in range(points.shape[0]):
        x, y = int(np.floor(points[p, 0] + 0.5)), int(np.floor(points[p, 1] + 0.5))
        inside[p] = 1.0 if 0 <= x < width and 0 <= y < height else 0.0
        x, y = min(max(x, 0), width - 1), min(max(y, 0), height - 1)
        red, green, blue, count = 0, 0, 0, 0
        for j in range(max(y - half, 0), min(y + half + 1, height)):
            for i in range(max(x - half, 0), min(x + half + 1, width)):
                red += rgb[j, i, 0]
                green += rgb[j, i, 1]
                blue += rgb[j, i, 2]
                count += 1
        r = np.log(red / count + _DARK)
        g = np.log(green / count + _DARK)
        b = np.log(blue / count + _DARK)
        out[p, 0], out[p, 1], out[p, 2] = (r + g + b) / 3.0, r - g, b - g


@numba.njit(cache=True, nogil=True)
def change_of_light(
    away: FloatArray,  # (P, C) deviations from what was expected
    seen: FloatArray,  # (P,) 1 where a point counts, else 0
    spread: FloatArray,  # (P, C) usual squares of deviations
    basis: FloatArray,  # (P, 4) 1 and the skin's normal
    ridge: FloatArray,  # (4,) added to the diagonal
    rounds: int,
    light: FloatArray,  # (P, C) start in, result out: the part that a change of light explains
) -> None:
    """Fit a change of light robustly: what is covered deviates in its own way and has no say."""
    n_points, n_colors = away.shape
    normal, right = np.empty((4, 4)), np.empty((4, n_colors))
    for _ in range(rounds):
        normal[:] = 0.0
        right[:] = 0.0
        for p in range(n_points):
            if seen[p] == 0.0:
                continue
            square = 0.0
            for c in range(n_colors):
                square += (away[p, c] - light[p, c]) ** 2 / spread[p, c]
            trust = 1.0 / (1.0 + square / (2.0 * n_colors)) ** 2
            for i in range(4):
                weighted = trust * basis[p, i]
                for j in range(4):
                    normal[i, j] += weighted * basis[p, j]
                for c in range(n_colors):
                    right[i, c] += weighted * away[p, c]
        for i in range(4):
            normal[i, i] += ridge[i]
        # Gaussian elimination: the matrix is positive definite.
        for i in range(4):
            for k in range(i + 1, 4):
                ratio = normal[k, i] / normal[i, i]
                for j in range(i, 4):
                    normal[k, j] -= ratio * normal[i, j]
                for c in range(n_colors):
                    right[k, c] -= ratio * right[i, c]
        for i in range(3, -1, -1):
            for c in range(n_colors):
                total = right[i, c]
                for j in range(i + 1, 4):
                    total -= normal[i, j] * right[j, c]
                right[i, c] = total / normal[i, i]
        for p in range(n_points):
            for c in range(n_colors):
                total = 0.0
                for i in range(4):
                    total += basis[p, i] * right[i, c]
                light[p, c] = total
