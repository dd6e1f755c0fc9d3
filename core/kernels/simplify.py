"""Leaves out vertices of a mesh that hardly change its shape, for drivers that draw on the CPU.

Run once when a mesh is loaded, so its lists may grow while it runs.
"""

import heapq

import numba

from core.records import I32, U8, FloatArray

#: Most triangles around a vertex; a vertex that would get more is left alone.
MOST_AROUND = 24


@numba.njit(cache=True, nogil=True)
def _normal(points: FloatArray, a: int, b: int, c: int) -> tuple[float, float, float]:
    """Return the normal of a triangle, as long as twice its area."""
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    vx, vy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    uz, vz = points[b, 2] - points[a, 2], points[c, 2] - points[a, 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@numba.njit(cache=True, nogil=True)
def _add_plane(points: FloatArray, triangle: I32, quadrics: FloatArray, areas: FloatArray) -> None:
    """Add the squared distance from a triangle's plane to the quadrics of its corners."""
    i, j, k = triangle[0], triangle[1], triangle[2]
    nx, ny, nz = _normal(points, i, j, k)
    length = (nx * nx + ny * ny + nz * nz) ** 0.5
    if length < 1e-9:
        return
    nx, ny, nz = nx / length, ny / length, nz / length
    d = -(nx * points[i, 0] + ny * points[i, 1] + nz * points[i, 2])
    for c in range(3):
        v = triangle[c]
        areas[v] += length / 2
        plane = (nx, ny, nz, d)
        entry = 0
        for row in range(4):
            for column in range(row, 4):
                quadrics[v, entry] += length / 2 * plane[row] * plane[column]
                entry += 1


@numba.njit(cache=True, nogil=True)
def _error_mm(
    points: FloatArray, quadrics: FloatArray, areas: FloatArray, v: int, to: int
) -> float:
    """Return the mean distance of `to` from the planes that both vertices stand for."""
    x, y, z = points[to, 0], points[to, 1], points[to, 2]
    at = (x, y, z, 1.0)
    total, entry = 0.0, 0
    for row in range(4):
        for column in range(row, 4):
            twice = 1.0 if row == column else 2.0
            both = quadrics[v, entry] + quadrics[to, entry]
            total += twice * both * at[row] * at[column]
            entry += 1
    return (max(total, 0.0) / max(areas[v] + areas[to], 1e-9)) ** 0.5


@numba.njit(cache=True, nogil=True)
def _square(points: FloatArray, a: int, b: int) -> float:
    x, y, z = points[a, 0] - points[b, 0], points[a, 1] - points[b, 1], points[a, 2] - points[b, 2]
    return x * x + y * y + z * z


@numba.njit(cache=True, nogil=True)
def _offer(
    points: FloatArray,
    quadrics: FloatArray,
    areas: FloatArray,
    locked: U8,
    versions: I32,
    tolerance_mm: float,
    v: int,
    to: int,
    heap: list[tuple[float, int, int, int, int]],
) -> None:
    """Remember that `v` may move onto `to`, if that changes little."""
    if locked[v] == 0:
        error = _error_mm(points, quadrics, areas, v, to)
        if error < tolerance_mm:
            # numba's lists hold one type, and its `int` leaves an int32 as it is.
            entry = numba.int64(v), numba.int64(to), numba.int64(versions[v])
            heapq.heappush(heap, (error, *entry, numba.int64(versions[to])))


@numba.njit(cache=True, nogil=True)
def _may_collapse(
    points: FloatArray,
    triangles: I32,
    around: I32,
    n_around: I32,
    marks: I32,
    stamp: int,
    v: int,
    to: int,
    longest_mm: float,
    flattest: float,
) -> bool:
    """Return whether moving `v` onto `to` leaves a surface without folds and slivers."""
    if n_around[v] + n_around[to] > MOST_AROUND:
        return False
    shared = 0
    for n in range(n_around[to]):
        for c in range(3):
            marks[triangles[around[to, n], c]] = stamp
    common = 0
    for n in range(n_around[v]):
        t = around[v, n]
        has = False
        for c in range(3):
            has = has or triangles[t, c] == to
        shared += 1 if has else 0
        for c in range(3):
            other = triangles[t, c]
            if other != v and other != to and marks[other] == stamp:
                marks[other] = stamp - 1
                common += 1
        if has:
            continue
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        before = _normal(points, i, j, k)
        i, j, k = to if i == v else i, to if j == v else j, to if k == v else k
        after = _normal(points, i, j, k)
        area = (after[0] ** 2 + after[1] ** 2 + after[2] ** 2) ** 0.5
        was = (before[0] ** 2 + before[1] ** 2 + before[2] ** 2) ** 0.5
        along = after[0] * before[0] + after[1] * before[1] + after[2] * before[2]
        edge = max(_square(points, i, j), _square(points, j, k), _square(points, k, i))
        # A fold, a sliver, or a triangle too large to be lit at its corners.
        if along < 0.8 * area * was or area < flattest * edge or edge > longest_mm**2:
            return False
    return shared == 2 and common == 2


@numba.njit(cache=True, nogil=True)
def collapse_edges(
    points: FloatArray,  # (V, 3) mm
    triangles: I32,  # (T, 3) changed; those that vanish get -1
    locked: U8,  # (V,) 1 stays
    tolerance_mm: float,
    longest_mm: float,  # of an edge
    flattest: float,  # twice a triangle's area over its longest edge squared
    quadrics: FloatArray,  # (V, 10) zeros
    areas: FloatArray,  # (V,) zeros
    around: I32,  # (V, MOST_AROUND) scratch
    n_around: I32,  # (V,) zeros
    versions: I32,  # (V,) zeros
    marks: I32,  # (V,) zeros
) -> None:
    """Move vertices onto neighbours, least error first [Garland and Heckbert 1997].

    Unlike there, no new places are found: a vertex that is left keeps its shapes and colours.
    """
    for t in range(triangles.shape[0]):
        _add_plane(points, triangles[t], quadrics, areas)
        for c in range(3):
            v = triangles[t, c]
            if n_around[v] < MOST_AROUND:
                around[v, n_around[v]] = t
            else:
                locked[v] = 1
            n_around[v] += 1
    heap = [(0.0, 0, 0, 0, 0)]
    heap.pop()
    for t in range(triangles.shape[0]):
        for c in range(3):
            a, b = triangles[t, c], triangles[t, (c + 1) % 3]
            _offer(points, quadrics, areas, locked, versions, tolerance_mm, a, b, heap)
            _offer(points, quadrics, areas, locked, versions, tolerance_mm, b, a, heap)
    stamp = 0
    while len(heap) > 0:
        _, v, to, version, to_version = heapq.heappop(heap)
        if versions[v] != version or versions[to] != to_version:
            continue
        stamp += 2
        if not _may_collapse(
            points, triangles, around, n_around, marks, stamp, v, to, longest_mm, flattest
        ):
            continue
        kept = 0
        for n in range(n_around[to]):
            t = around[to, n]
            if triangles[t, 0] == v or triangles[t, 1] == v or triangles[t, 2] == v:
                continue
            around[to, kept] = t
            kept += 1
        n_around[to] = kept
        for n in range(n_around[v]):
            t = around[v, n]
            if triangles[t, 0] == to or triangles[t, 1] == to or triangles[t, 2] == to:
                for c in range(3):
                    other = triangles[t, c]
                    if other != v and other != to:
                        last = 0
                        for m in range(n_around[other]):
                            if around[other, m] != t:
                                around[other, last] = around[other, m]
                                last += 1
                        n_around[other] = last
                triangles[t, :] = -1
                continue
            for c in range(3):
                if triangles[t, c] == v:
                    triangles[t, c] = to
            around[to, n_around[to]] = t
            n_around[to] += 1
        n_around[v] = 0
        versions[v] = -1
        versions[to] += 1
        areas[to] += areas[v]
        for entry in range(10):
            quadrics[to, entry] += quadrics[v, entry]
        for n in range(n_around[to]):
            for c in range(3):
                other = triangles[around[to, n], c]
                if other != to:
                    _offer(points, quadrics, areas, locked, versions, tolerance_mm, other, to, heap)
                    _offer(points, quadrics, areas, locked, versions, tolerance_mm, to, other, heap)
