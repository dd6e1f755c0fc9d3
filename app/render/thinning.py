"""Makes parts cheaper to draw: fewer triangles, and in an order that a software driver likes."""

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee

from app.render.avatar import Part
from core.kernels.simplify import MOST_AROUND, collapse_edges
from core.records import F32, I32, BoolArray, FloatArray

#: Limits of `simplified` by material: skin is lit at its vertices, and moves with them.
_LIMITS = {"skin": (0.15, 12.0, 0.12)}
_OTHERS = (0.6, 40.0, 0.05)
#: How far a texture may be shifted, in its pixels, and the shade of folds changed.
_SHIFTED_PX, _SHADED = 4.0, 0.06
#: Triangles are drawn in layers of this depth, the front first.
_LAYER_MM = 15.0


def thinned(part: Part, neutral_mm: F32) -> Part:
    """Return a part with fewer triangles and the same look at the size of a usual picture.

    Triangles of a few pixels cost a software driver more for their edges than for their inside.

    Args:
        part: To draw.
        neutral_mm: (V, 3) the avatar's vertices.
    """
    material = part.material
    points = neutral_mm[part.rows]
    triangles = part.triangles
    # What lies inside the mouth comes to the light in other shapes; lashes are thin by nature.
    if not (material.in_mouth or material.blended):
        limits = _LIMITS.get(material.shader, _OTHERS)
        height, width = material.texture.shape[:2]
        drawn = np.column_stack([part.uv * [width, height] / _SHIFTED_PX, part.extra / _SHADED])
        fixed = bends(points, triangles, drawn) > 1
        triangles = simplified(points, triangles, *limits, fixed)
    return _in_order(replace(part, triangles=triangles), points)


def bends(points_mm: F32, triangles: I32, values: FloatArray) -> FloatArray:
    """Return how far from straight values run around each vertex, (V,).

    Where they are no straight function of the place, leaving out the vertex would change what is
    drawn: bend strands of hair, take the shade out of a fold.

    Args:
        points_mm: (V, 3).
        triangles: (T, 3).
        values: (V, K), such as places in a texture.
    """
    a, b = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).T
    a, b = np.concatenate([a, b]), np.concatenate([b, a])
    way, change = points_mm[b].astype(float) - points_mm[a], values[b] - values[a]
    around = coo_matrix((np.ones(len(a)), (a, np.arange(len(a)))), (len(points_mm), len(a))).tocsr()
    grams = _summed(around, np.einsum("ei,ej->eij", way, way))
    mixed = _summed(around, np.einsum("ei,ek->eik", way, change))
    # The best straight function by least squares; the small term is for sheets, which are flat.
    straight = np.linalg.solve(grams + 0.05 * np.eye(3), mixed)
    left = change - np.einsum("ei,eik->ek", way, straight[a])
    out = np.zeros(len(points_mm))
    np.maximum.at(out, a, np.abs(left).max(axis=1))
    return out


def _summed(around: csr_matrix, matrices: FloatArray) -> FloatArray:
    """Return the sums (V, m, n) of the matrices (E, m, n) of the edges around vertices (V, E)."""
    sums = around @ matrices.reshape(len(matrices), -1)
    return np.asarray(sums.reshape(-1, *matrices.shape[1:]))


def simplified(
    points_mm: F32,
    triangles: I32,
    tolerance_mm: float,
    longest_mm: float,
    flattest: float,
    fixed: BoolArray | None = None,
) -> I32:
    """Return fewer triangles (T', 3) of the same vertices.

    Args:
        points_mm: (V, 3).
        triangles: (T, 3).
        tolerance_mm: How far the surface may move.
        longest_mm: No edge becomes longer.
        flattest: No triangle's doubled area becomes less than this share of its longest edge
            squared.
        fixed: (V,) vertices that stay; None for no more than those at borders.
    """
    count = len(points_mm)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    # Numbers are sorted much faster than pairs of them.
    unique, uses = np.unique(edges[:, 0].astype(np.int64) * count + edges[:, 1], return_counts=True)
    locked = np.zeros(count, np.uint8)
    # At borders and at seams of the texture nothing moves, or gaps would open.
    locked[np.concatenate(np.divmod(unique[uses != 2], count))] = 1
    if fixed is not None:
        locked[fixed] = 1
    left = triangles.copy()
    collapse_edges(
        np.ascontiguousarray(points_mm, np.float64), left, locked,
        tolerance_mm, longest_mm, flattest,
        np.zeros((count, 10)), np.zeros(count), np.zeros((count, MOST_AROUND), np.int32),
        np.zeros(count, np.int32), np.zeros(count, np.int32), np.zeros(count, np.int32),
    )  # fmt: skip
    return left[left[:, 0] >= 0]


def _in_order(part: Part, points_mm: F32) -> Part:
    """Return a part without unused vertices, in an order that draws little twice.

    Neighbours come soon after each other, so that a driver finds their corners ready; what is in
    front comes first and hides the rest before that is coloured.
    """
    count, triangles = len(points_mm), part.triangles
    pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), (count, count)).tocsr()
    place = np.empty(count, np.int64)
    place[reverse_cuthill_mckee(graph + graph.T, symmetric_mode=True)] = np.arange(count)
    layer = np.floor(points_mm[triangles, 2].mean(axis=1) / _LAYER_MM)
    ranks = place[triangles]
    triangles = triangles[np.lexsort((ranks.max(axis=1), ranks.min(axis=1), layer))]
    used, first = np.unique(triangles, return_index=True)
    kept = used[np.argsort(first)]
    number = np.zeros(count, np.int32)
    number[kept] = np.arange(len(kept))
    return Part(part.material, part.rows[kept], part.uv[kept], part.extra[kept], number[triangles])
