"""Which triangle covers each pixel of a picture, by serial loops."""

import numba

from core.records import F32, I32


@numba.njit(cache=True, nogil=True)
def cover(
    points: F32,  # (V, 3) column, row in px and depth; smaller depths are nearer
    triangles: I32,  # (T, 3); the sense of rotation does not matter
    depth: F32,  # (H, W) written where a triangle is nearer than what is there
    index: I32,  # (H, W) number of that triangle
) -> None:
    """Draw triangles into a depth buffer and a buffer of triangle numbers."""
    height, width = depth.shape
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, bx, by = points[i, 0], points[i, 1], points[j, 0], points[j, 1]
        cx, cy = points[k, 0], points[k, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(area) < 1e-9:
            continue
        left, right = max(int(min(ax, bx, cx)), 0), min(int(max(ax, bx, cx)) + 1, width - 1)
        top, bottom = max(int(min(ay, by, cy)), 0), min(int(max(ay, by, cy)) + 1, height - 1)
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                u = ((column - ax) * (cy - ay) - (row - ay) * (cx - ax)) / area
                v = ((bx - ax) * (row - ay) - (by - ay) * (column - ax)) / area
                if u < -1e-4 or v < -1e-4 or u + v > 1.0001:
                    continue
                here = points[i, 2] + u * (points[j, 2] - points[i, 2])
                here += v * (points[k, 2] - points[i, 2])
                if here < depth[row, column]:
                    depth[row, column] = here
                    index[row, column] = t
