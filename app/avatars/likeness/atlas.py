"""Where on the head each texel of the skin's texture lies."""

from dataclasses import dataclass

import numpy as np

from core.face_model import FaceModel
from core.kernels.raster import cover
from core.records import F32, I32, U8, BoolArray, FloatArray

#: Lower edge of the face's island, as a share of the texture's height.
_FACE_ENDS = 0.57


@dataclass(frozen=True, slots=True, eq=False)
class Atlas:
    """The texels of the skin's outside, in a list.

    Attributes:
        size_px: S; the texture has (S, S) texels.
        n_vertices: V of the face model.
        rows: (X,) row of each texel.
        columns: (X,) its column.
        corners: (X, 3) vertices of the triangle that it lies in.
        shares: (X, 3) weights of these vertices; they sum to 1.
    """

    size_px: int
    n_vertices: int
    rows: I32
    columns: I32
    corners: I32
    shares: F32

    def at_texels(self, values: FloatArray | F32) -> F32:
        """Return values (V, ...) of the vertices interpolated at the texels, (X, ...)."""
        values = np.asarray(values, np.float32)
        out = np.zeros((len(self.rows), *values.shape[1:]), np.float32)
        for corner in range(3):
            share = self.shares[:, corner].reshape(-1, *([1] * (values.ndim - 1)))
            out += share * values[self.corners[:, corner]]
        return out

    def spread(self, values: F32) -> F32:
        """Return values of the texels (X, ...) as a picture (S, S, ...), 0 elsewhere."""
        out = np.zeros((self.size_px, self.size_px, *values.shape[1:]), np.float32)
        out[self.rows, self.columns] = values
        return out

    def gathered(self, picture: F32 | U8) -> F32:
        """Return the values (X, ...) of a picture (S, S, ...) at the texels."""
        return np.asarray(picture[self.rows, self.columns], np.float32)


def make_atlas(model: FaceModel, size_px: int, shown: BoolArray | None = None) -> Atlas:
    """Return the atlas of the model's skin for a texture of a size.

    Args:
        model: Its topology and texture coordinates.
        size_px: S.
        shown: (V,) take only triangles of the face with such a vertex; None takes all.
    """
    mine = model.part_triangles("skin")
    if shown is not None:
        # Throat and eye sockets are islands below the face.
        face = model.uv[mine][..., 1].max(axis=1) < _FACE_ENDS
        mine = mine[face & shown[model.triangles[mine]].any(axis=1)]
    corner_uv = model.uv[mine].reshape(-1, 2) * size_px - 0.5
    points = np.zeros((len(corner_uv), 3), np.float32)
    points[:, :2] = corner_uv
    own = np.arange(len(corner_uv), dtype=np.int32).reshape(-1, 3)
    depth = np.full((size_px, size_px), np.inf, np.float32)
    index = np.full((size_px, size_px), -1, np.int32)
    cover(points, own, depth, index)
    rows, columns = np.nonzero(index >= 0)
    which = index[rows, columns]
    shares = barycentric(
        corner_uv[own[which]], np.stack([columns, rows], axis=1).astype(np.float64)
    )
    corners = model.triangles[mine][which]
    count = len(model.mean_mm)
    return Atlas(size_px, count, rows.astype(np.int32), columns.astype(np.int32), corners, shares)


def barycentric(corners: F32, points: FloatArray) -> F32:
    """Return the weights (n, 3) of triangles' corners (n, 3, 2) at points (n, 2)."""
    a, b, c = np.moveaxis(corners.astype(np.float64), 1, 0)
    ab, ac, ap = b - a, c - a, points - a
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    area = np.where(np.abs(area) < 1e-12, 1e-12, area)
    u = (ap[:, 0] * ac[:, 1] - ap[:, 1] * ac[:, 0]) / area
    v = (ab[:, 0] * ap[:, 1] - ab[:, 1] * ap[:, 0]) / area
    out = np.clip(np.stack([1 - u - v, u, v], axis=1), 0, 1)
    return np.asarray(out / out.sum(axis=1, keepdims=True), np.float32)
