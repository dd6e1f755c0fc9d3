"""Blendshape morphing, normals and vertex buffers for drawing, by serial loops.

A GPU-less machine morphs a head here in well under a millisecond; in a vertex shader of a
software renderer the same takes tens.
"""

import numba

from core.records import F32, I32


@numba.njit(cache=True, nogil=True)
def add_sparse_deltas(
    weights: F32,  # (B,) shapes at 0 cost nothing
    starts: I32,  # (B + 1,) rows of each shape in `rows` and `deltas`
    rows: I32,  # (N,) vertex of each entry
    deltas: F32,  # (N, 3) mm at weight 1
    out: F32,  # (V, 3) mm, added to
) -> None:
    """Add every blendshape at its weight to the vertices `out`."""
    for b in range(weights.shape[0]):
        weight = weights[b]
        if weight == 0.0:
            continue
        for entry in range(starts[b], starts[b + 1]):
            row = rows[entry]
            out[row, 0] += weight * deltas[entry, 0]
            out[row, 1] += weight * deltas[entry, 1]
            out[row, 2] += weight * deltas[entry, 2]


@numba.njit(cache=True, nogil=True)
def vertex_normals(
    vertices: F32,  # (V, 3)
    triangles: I32,  # (T, 3) counter-clockwise seen from outside
    out: F32,  # (V, 3) unit normals, area-weighted; (0, 0, -1) where no triangle is
) -> None:
    """Write the smooth normal of every vertex, pointing outwards."""
    out[:, :] = 0.0
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax = vertices[j, 0] - vertices[i, 0]
        ay = vertices[j, 1] - vertices[i, 1]
        az = vertices[j, 2] - vertices[i, 2]
        bx = vertices[k, 0] - vertices[i, 0]
        by = vertices[k, 1] - vertices[i, 1]
        bz = vertices[k, 2] - vertices[i, 2]
        nx = ay * bz - az * by
        ny = az * bx - ax * bz
        nz = ax * by - ay * bx
        for v in (i, j, k):
            out[v, 0] += nx
            out[v, 1] += ny
            out[v, 2] += nz
    for v in range(out.shape[0]):
        square = out[v, 0] ** 2 + out[v, 1] ** 2 + out[v, 2] ** 2
        if square < 1e-20:
            out[v, 2] = -1.0
            continue
        scale = 1.0 / square**0.5
        for c in range(3):
            out[v, c] *= scale


@numba.njit(cache=True, nogil=True)
def interleave(
    vertices: F32,  # (V, 3)
    normals: F32,  # (V, 3)
    source: I32,  # (G,) vertex that each buffer row repeats
    out: F32,  # (G, 6) position, normal
) -> None:
    """Write the vertex buffer: texture seams need some vertices more than once."""
    for g in range(source.shape[0]):
        v = source[g]
        for c in range(3):
            out[g, c] = vertices[v, c]
            out[g, c + 3] = normals[v, c]
