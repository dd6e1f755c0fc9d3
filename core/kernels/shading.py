"""A coarse picture of the normals of a face."""

import numba
import numpy as np

from core.records import F32, I32


@numba.njit(cache=True, nogil=True)
def _fill_triangle(
    places: F32,  # (Q, 2) px of the map
    normals: F32,  # (Q, 3)
    corners: I32,  # (3,)
    out: F32,  # (h, w, 3)
) -> None:
    """Interpolate the normals of three corners over one triangle, where they face the camera."""
    a, b, c = places[corners[0]], places[corners[1]], places[corners[2]]
    doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if doubled == 0:
        return
    left = max(int(np.ceil(min(a[0], b[0], c[0]))), 0)
    right = min(int(max(a[0], b[0], c[0])), out.shape[1] - 1)
    top = max(int(np.ceil(min(a[1], b[1], c[1]))), 0)
    bottom = min(int(max(a[1], b[1], c[1])), out.shape[0] - 1)
    for y in range(top, bottom + 1):
        for x in range(left, right + 1):
            v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / doubled
            w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / doubled
            if v < 0 or w < 0 or v + w > 1:
                continue
            u = 1 - v - w
            depth = u * normals[corners[0], 2] + v * normals[corners[1], 2]
            depth += w * normals[corners[2], 2]
            # Where triangles overlap the one that faces the camera more is the one in view.
            if depth < out[y, x, 2]:
                for k in range(3):
                    out[y, x, k] = (
                        u * normals[corners[0], k]
                        + v * normals[corners[1], k]
                        + w * normals[corners[2], k]
                    )


@numba.njit(cache=True, nogil=True)
def _spread_row(row: F32) -> None:
    """Carry the outermost normals of a row (w, 3) on to its ends."""
    width = row.shape[0]
    first = 0
    while first < width and row[first, 2] == 0:
        first += 1
    if first == width:
        return
    last = width - 1
    while row[last, 2] == 0:
        last -= 1
    row[:first] = row[first]
    row[last + 1 :] = row[last]


@numba.njit(cache=True, nogil=True, parallel=True)
def draw_normals(
    places: F32,  # (N, Q, 2) px of the map
    normals: F32,  # (N, Q, 3) unit, z negative towards the camera
    triangles: I32,  # (M, 3)
    out: F32,  # (N, h, w, 3) zero at the start
) -> None:
    """Draw the normals of every face, carried on beyond its rim to the whole map."""
    for n in numba.prange(places.shape[0]):
        for m in range(triangles.shape[0]):
            _fill_triangle(places[n], normals[n], triangles[m], out[n])
        height = out.shape[1]
        first, last = height, -1
        for y in range(height):
            _spread_row(out[n, y])
            if out[n, y, 0, 2] != 0:
                first, last = min(first, y), y
        for y in range(height):
            if last >= 0 and (y < first or y > last):
                out[n, y] = out[n, first if y < first else last]
