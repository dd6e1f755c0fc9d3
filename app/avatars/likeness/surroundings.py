"""Smooth functions on the head's mesh, which knows no seams of the texture."""

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, diags
from scipy.sparse.linalg import splu

from app.avatars.likeness.atlas import Atlas
from core.face_model import FaceModel
from core.records import F32, FloatArray

#: Pull of what is far from everything known towards the mean of what is known.
_SCREEN = 2e-4


class Surroundings:
    """The skin of a head as a net of neighbours."""

    def __init__(self, model: FaceModel) -> None:
        triangles = model.triangles[model.part_triangles("skin")]
        pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        pairs = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
        n = len(model.mean_mm)
        links = coo_matrix((np.ones(len(pairs)), pairs.T), (n, n)).tocsr()
        self._degree = np.asarray(links.sum(axis=1)).ravel()
        self._laplacian: csr_matrix = diags(self._degree) - links
        self._mean: csr_matrix = diags(1 / np.maximum(self._degree, 1)) @ links

    def extended(self, values: FloatArray, trust: FloatArray) -> FloatArray:
        """Return values (V, C) that keep to given ones where trusted and go on smoothly beyond.

        Args:
            values: (V, C).
            trust: (V,) 0 where a value says nothing.
        """
        total = max(float(trust.sum()), 1e-9)
        mean = (trust @ values) / total
        matrix = self._laplacian + diags(trust + _SCREEN + 1e-9)
        right = trust[:, None] * (values - mean)
        return np.asarray(splu(matrix.tocsc()).solve(right) + mean)

    def softened(self, values: FloatArray, rounds: int) -> FloatArray:
        """Return values (V,) averaged with their neighbours' some times."""
        out = np.asarray(values, float)
        for _ in range(rounds):
            out = 0.5 * out + 0.5 * (self._mean @ out)
        return out


def at_vertices(atlas: Atlas, values: F32, weight: F32) -> tuple[FloatArray, FloatArray]:
    """Return weighted means (V, C) of texels' values (X, C) around the vertices, and the weights.

    The weight (V,) is the mean weight of the texels there, 0 where there are none.
    """
    flat, count = atlas.corners.reshape(-1), atlas.n_vertices
    share = atlas.shares.reshape(-1).astype(float)
    each = share * np.repeat(weight, 3)
    area = np.bincount(flat, share, count)
    total = np.bincount(flat, each, count)
    sums = [np.bincount(flat, each * np.repeat(values[:, c], 3), count)
            for c in range(values.shape[1])]  # fmt: skip
    mean = np.stack(sums, axis=1) / np.maximum(total, 1e-9)[:, None]
    return mean, total / np.maximum(area, 1e-9)
