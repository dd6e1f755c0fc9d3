"""From the previous shape to the shapes that a frame's regression starts from."""

import numba
import numpy as np

from core.records import F32, I32, FloatArray


@numba.njit(cache=True, nogil=True)
def center_shape(
    shape: FloatArray,  # (Q, 3) mm
    center: FloatArray,  # (3,) out
    centred: FloatArray,  # (Q, 3) out
) -> None:
    """Split a shape into its centroid and what is left."""
    n_points = shape.shape[0]
    for c in range(3):
        total = 0.0
        for q in range(n_points):
            total += shape[q, c]
        center[c] = total / n_points
        for q in range(n_points):
            centred[q, c] = shape[q, c] - center[c]


@numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def squared_distances(
    centred: FloatArray,  # (Q, 3)
    shapes: FloatArray,  # (N, Q, 3)
    out: FloatArray,  # (N,) mm^2
) -> None:
    """Sum the squared distances of one shape to each of many, all centred."""
    mine = centred.reshape(centred.size)
    for n in range(shapes.shape[0]):
        other = shapes[n].reshape(mine.size)
        total = 0.0
        for k in range(mine.size):
            difference = other[k] - mine[k]
            total += difference * difference
        out[n] = total


@numba.njit(cache=True, nogil=True)
def _largest_eigenvector(
    matrix: FloatArray,  # (4, 4) symmetric, destroyed
    vectors: FloatArray,  # (4, 4) scratch
    out: FloatArray,  # (4,)
) -> None:
    """Write the unit eigenvector of the largest eigenvalue, by Jacobi's rotations."""
    for i in range(4):
        for j in range(4):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(12):
        for i in range(3):
            for j in range(i + 1, 4):
                if abs(matrix[i, j]) < 1e-100:
                    continue
                theta = (matrix[j, j] - matrix[i, i]) / (2 * matrix[i, j])
                sign = 1.0 if theta >= 0 else -1.0
                t = sign / (abs(theta) + np.sqrt(theta * theta + 1))
                c = 1 / np.sqrt(t * t + 1)
                s = t * c
                for k in range(4):
                    a, b = matrix[k, i], matrix[k, j]
                    matrix[k, i], matrix[k, j] = c * a - s * b, s * a + c * b
                for k in range(4):
                    a, b = matrix[i, k], matrix[j, k]
                    matrix[i, k], matrix[j, k] = c * a - s * b, s * a + c * b
                    a, b = vectors[k, i], vectors[k, j]
                    vectors[k, i], vectors[k, j] = c * a - s * b, s * a + c * b
    best = 0
    for i in range(1, 4):
        if matrix[i, i] > matrix[best, best]:
            best = i
    for i in range(4):
        out[i] = vectors[i, best]


@numba.njit(cache=True, nogil=True)
def align_rotation(
    source: FloatArray,  # (Q, 3) centred
    target: FloatArray,  # (Q, 3) centred
    scratch: FloatArray,  # (3, 4, 4)
    out: FloatArray,  # (3, 3)
) -> None:
    """Write the rotation that brings source nearest to target [Horn 1987]."""
    s, matrix, vectors = scratch[0], scratch[1], scratch[2]
    for i in range(3):
        for j in range(3):
            total = 0.0
            for q in range(source.shape[0]):
                total += source[q, i] * target[q, j]
            s[i, j] = total
    matrix[0, 0] = s[0, 0] + s[1, 1] + s[2, 2]
    matrix[1, 1] = s[0, 0] - s[1, 1] - s[2, 2]
    matrix[2, 2] = s[1, 1] - s[0, 0] - s[2, 2]
    matrix[3, 3] = s[2, 2] - s[0, 0] - s[1, 1]
    matrix[0, 1] = s[1, 2] - s[2, 1]
    matrix[0, 2] = s[2, 0] - s[0, 2]
    matrix[0, 3] = s[0, 1] - s[1, 0]
    matrix[1, 2] = s[0, 1] + s[1, 0]
    matrix[1, 3] = s[2, 0] + s[0, 2]
    matrix[2, 3] = s[1, 2] + s[2, 1]
    for i in range(4):
        for j in range(i):
            matrix[i, j] = matrix[j, i]
    quaternion = s[3]
    _largest_eigenvector(matrix, vectors, quaternion)
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    out[0, 0], out[0, 1], out[0, 2] = (
        1 - 2 * (y * y + z * z),
        2 * (x * y - w * z),
        2 * (x * z + w * y),
    )
    out[1, 0], out[1, 1], out[1, 2] = (
        2 * (x * y + w * z),
        1 - 2 * (x * x + z * z),
        2 * (y * z - w * x),
    )
    out[2, 0], out[2, 1], out[2, 2] = (
        2 * (x * z - w * y),
        2 * (y * z + w * x),
        1 - 2 * (x * x + y * y),
    )


@numba.njit(cache=True, nogil=True)
def turn_shape(
    centred: FloatArray,  # (Q, 3)
    rotation: FloatArray,  # (3, 3)
    out: FloatArray,  # (Q, 3)
) -> None:
    """Turn a centred shape."""
    for q in range(centred.shape[0]):
        for c in range(3):
            out[q, c] = (
                rotation[c, 0] * centred[q, 0]
                + rotation[c, 1] * centred[q, 1]
                + rotation[c, 2] * centred[q, 2]
            )


@numba.njit(cache=True, nogil=True)
def choose_starts(
    distances: FloatArray,  # (N,) mm^2 of the originals to the previous shape, centred
    steps: FloatArray,  # (m,) mm^2 that each translation adds
    chosen: I32,  # (L, 2) original and translation, nearest first; out
    best: FloatArray,  # (L,) scratch
) -> None:
    """Choose the nearest of all N * m shapes of the shape space."""
    n_runs = chosen.shape[0]
    for r in range(n_runs):
        best[r] = np.inf
        chosen[r, 0], chosen[r, 1] = 0, 0
    for n in range(distances.shape[0]):
        for m in range(steps.shape[0]):
            distance = distances[n] + steps[m]
            r = n_runs
            while r > 0 and best[r - 1] > distance:
                r -= 1
            if r == n_runs:
                continue
            for k in range(n_runs - 1, r, -1):
                best[k] = best[k - 1]
                chosen[k, 0], chosen[k, 1] = chosen[k - 1, 0], chosen[k - 1, 1]
            best[r] = distance
            chosen[r, 0], chosen[r, 1] = n, m


@numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def turned_distances(
    centred: FloatArray,  # (Q, 3)
    shapes: FloatArray,  # (N, Q, 3) centred
    rotations: FloatArray,  # (N, 3, 3) turns each shape first
    out: FloatArray,  # (N,) mm^2
) -> None:
    """Sum the squared distances of one shape to each of many, each turned by its rotation."""
    for n in range(shapes.shape[0]):
        turn = rotations[n]
        total = 0.0
        for q in range(shapes.shape[1]):
            x, y, z = shapes[n, q, 0], shapes[n, q, 1], shapes[n, q, 2]
            for c in range(3):
                placed = turn[c, 0] * x + turn[c, 1] * y + turn[c, 2] * z
                difference = placed - centred[q, c]
                total += difference * difference
        out[n] = total


@numba.njit(cache=True, nogil=True)
def place_starts(
    shapes: FloatArray,  # (N, Q, 3) centred
    rotations: FloatArray,  # (N, 3, 3) turns each shape first
    translations: FloatArray,  # (m, 3) mm
    chosen: I32,  # (L, 2)
    out: F32,  # (R, Q, 3) R >= L; the runs beyond L repeat the last start
) -> None:
    """Lay out the chosen starts, around the origin of the shape space."""
    for r in range(out.shape[0]):
        k = min(r, chosen.shape[0] - 1)
        shape, turn = shapes[chosen[k, 0]], rotations[chosen[k, 0]]
        translation = translations[chosen[k, 1]]
        for q in range(out.shape[1]):
            x, y, z = shape[q, 0], shape[q, 1], shape[q, 2]
            for c in range(3):
                placed = turn[c, 0] * x + turn[c, 1] * y + turn[c, 2] * z
                out[r, q, c] = placed + translation[c]


@numba.njit(cache=True, nogil=True)
def combine_runs(
    shapes: F32,  # (R, Q, 3)
    n_runs: int,  # L <= R
    use_median: bool,
    values: FloatArray,  # (L,) scratch
    out: FloatArray,  # (Q, 3)
) -> float:
    """Write the mean or median of the runs; return their RMS distance across the view in mm.

    Along the view (c = 2) runs differ more without being wrong: a picture hardly shows depth.
    """
    spread = 0.0
    for q in range(shapes.shape[1]):
        for c in range(3):
            total = 0.0
            for r in range(n_runs):
                value = shapes[r, q, c]
                total += value
                k = r
                while use_median and k > 0 and values[k - 1] > value:
                    values[k] = values[k - 1]
                    k -= 1
                values[k] = value
            mean = total / n_runs
            for r in range(n_runs):
                spread += (values[r] - mean) ** 2 if c < 2 else 0.0
            if use_median:
                mean = 0.5 * (values[n_runs // 2] + values[(n_runs - 1) // 2])
            out[q, c] = mean
    return np.sqrt(spread / (n_runs * shapes.shape[1]))
