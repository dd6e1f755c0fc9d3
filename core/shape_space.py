"""The shapes of a setup, seen apart from where the head was and how it was turned."""

import numpy as np

from core.records import FloatArray


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
