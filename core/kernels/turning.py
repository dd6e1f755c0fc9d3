"""A picture drawn anew, triangle by triangle, with its corners in other places."""

import numba

from core.records import F32, I32, U8


@numba.njit(cache=True, nogil=True)
def _grey_level(
    picture: U8,  # (H, W)
    x: float,
    y: float,
) -> float:
    """Read the picture between its pixels; beyond the border the border pixel goes on."""
    x = min(max(x, 0.0), picture.shape[1] - 1.01)
    y = min(max(y, 0.0), picture.shape[0] - 1.01)
    column, row = int(x), int(y)
    right, down = x - column, y - row
    upper = picture[row, column] * (1 - right) + picture[row, column + 1] * right
    lower = picture[row + 1, column] * (1 - right) + picture[row + 1, column + 1] * right
    return upper * (1 - down) + lower * down


@numba.njit(cache=True, nogil=True)
def draw_moved(
    picture: U8,  # (H, W)
    source: F32,  # (Q, 2) px where the picture shows each corner
    target: F32,  # (Q, 2) px where it goes
    depth: F32,  # (Q,) of the target; what is nearer hides what is further away
    triangles: I32,  # (M, 3)
    nearest: F32,  # (H, W) scratch, infinite at the start
    out: U8,  # (H, W)
) -> None:
    """Draw all triangles of a picture at their target; elsewhere `out` stays as it is."""
    for m in range(triangles.shape[0]):
        i, j, k = triangles[m, 0], triangles[m, 1], triangles[m, 2]
        a, b, c = target[i], target[j], target[k]
        doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if doubled == 0:
            continue
        left = int(max(min(a[0], b[0], c[0]), 0.0))
        right = int(min(max(a[0], b[0], c[0]), out.shape[1] - 1.0))
        top = int(max(min(a[1], b[1], c[1]), 0.0))
        bottom = int(min(max(a[1], b[1], c[1]), out.shape[0] - 1.0))
        for y in range(top, bottom + 1):
            for x in range(left, right + 1):
                v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / doubled
                w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / doubled
                u = 1 - v - w
                if u < 0 or v < 0 or w < 0:
                    continue
                z = u * depth[i] + v * depth[j] + w * depth[k]
                if z < nearest[y, x]:
                    nearest[y, x] = z
                    at_x = u * source[i, 0] + v * source[j, 0] + w * source[k, 0]
                    at_y = u * source[i, 1] + v * source[j, 1] + w * source[k, 1]
                    out[y, x] = int(_grey_level(picture, at_x, at_y) + 0.5)
