"""The shapes of a setup, seen apart from where the head was and how it was turned."""

import numpy as np
from numpy.typing import NDArray

from core.records import FloatArray

IndexArray = NDArray[np.intp]


def pairwise_rotations(shapes_mm: FloatArray) -> FloatArray:
    """Return the rotations (N, N, 3, 3) that bring shape j nearest to shape i, both centred.

    Args:
        shapes_mm: (N, Q, 3).
    """
    centred = shapes_mm - shapes_mm.mean(axis=1, keepdims=True)
    u, _, vt = np.linalg.svd(np.einsum("iqa,jqb->ijab", centred, centred, optimize=True))
    # Without the sign a reflection could fit better than any rotation.
    u[..., 2] *= np.sign(np.linalg.det(u) * np.linalg.det(vt))[..., None]
    return np.asarray(u @ vt)


def distinct(shapes_mm: FloatArray, rotations: FloatArray, apart_mm: float = 1e-3) -> IndexArray:
    """Return which shapes are not an earlier one turned, in rising order.

    Args:
        shapes_mm: (N, Q, 3), each around its centroid.
        rotations: (N, N, 3, 3) that bring shape j to shape i.
        apart_mm: RMS distance from which shapes differ.
    """
    kept: list[int] = []
    for n, shape in enumerate(shapes_mm):
        turned = np.einsum("kij,kqj->kqi", rotations[n, kept], shapes_mm[kept])
        squares = np.mean(np.sum((turned - shape) ** 2, axis=2), axis=1)
        if not np.any(squares < apart_mm**2):
            kept.append(n)
    return np.array(kept, dtype=np.intp)
