"""Meshes of things from outlines: tubes along paths, turned profiles, surfaces of fields.

Everything is in mm; triangles run counter-clockwise seen from outside.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from app.render.scene import Mesh
from core.kernels.morph import vertex_normals
from core.records import F32, I32, FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A shape without its looks.

    Attributes:
        points_mm: (n, 3).
        triangles: (T, 3).
        uv: (n, 2).
    """

    points_mm: FloatArray
    triangles: I32
    uv: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            points_mm=(np.float64, ("n", 3)),
            triangles=(np.int32, ("T", 3)),
            uv=(np.float64, ("n", 2)),
        )


def mesh_of(
    solid: Solid, coverage: FloatArray | None = None, open_to_light: FloatArray | None = None
) -> Mesh:
    """Return the mesh of a solid with smooth normals, that moves as one.

    Args:
        solid: The shape.
        coverage: (n,) of hair; 1 everywhere without it.
        open_to_light: (n,) in [0, 1]; 1 everywhere without it.
    """
    points = np.ascontiguousarray(solid.points_mm, np.float32)
    normals: F32 = np.empty_like(points)
    vertex_normals(points, solid.triangles, normals)
    ones = np.ones(len(points))
    extra = np.stack(
        [
            0 * ones,
            ones if open_to_light is None else open_to_light,
            ones if coverage is None else coverage,
            0 * ones,
        ],
        axis=1,
    )
    return Mesh(
        points, normals, solid.uv.astype(np.float32), extra.astype(np.float32), solid.triangles
    )


def joined(*solids: Solid) -> Solid:
    """Return several solids as one."""
    starts = np.cumsum([0, *(len(solid.points_mm) for solid in solids)])
    return Solid(
        np.concatenate([solid.points_mm for solid in solids]),
        np.concatenate([s.triangles + at for s, at in zip(solids, starts, strict=False)]),
        np.concatenate([solid.uv for solid in solids]),
    )


def grid_triangles(rows: int, columns: int, around: bool = False) -> I32:
    """Return the triangles of a grid of points, row by row.

    Seen from outside, rows run on to the right of the direction in which columns do.

    Args:
        rows: Number of rows.
        columns: Points in each.
        around: The last column joins the first.
    """
    last = columns if around else columns - 1
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(last), indexing="ij")
    after = (column + 1) % columns
    a, b = (row * columns + column).reshape(-1), (row * columns + after).reshape(-1)
    c, d = b + columns, a + columns
    return np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)


def tube(
    path_mm: FloatArray, radius_mm: float, away: FloatArray, closed: bool = False, sides: int = 8
) -> Solid:
    """Return a tube along a path (K, 3).

    Args:
        path_mm: Its middle line.
        radius_mm: Half its thickness.
        away: (3,) any direction that the path never takes.
        closed: The path's end joins its start.
        sides: Of the cross-section.
    """
    path = np.concatenate([path_mm, path_mm[:1]]) if closed else np.asarray(path_mm)
    ahead, behind = np.roll(path, -1, axis=0), np.roll(path, 1, axis=0)
    if closed:
        ahead[-1], behind[0] = path[1], path[-2]
    else:
        ahead[-1], behind[0] = path[-1], path[0]
    along = _unit(ahead - behind)
    across = _unit(np.cross(along, away))
    other = np.cross(along, across)
    turn = np.arange(sides) * 2 * np.pi / sides
    ring = (
        np.cos(turn)[None, :, None] * across[:, None]
        + np.sin(turn)[None, :, None] * (other[:, None])
    )
    points = (path[:, None] + radius_mm * ring).reshape(-1, 3)
    u, v = np.meshgrid(np.linspace(0, 1, sides), np.linspace(0, 1, len(path)))
    uv = np.stack([u, v], axis=-1).reshape(-1, 2)
    return Solid(points, grid_triangles(len(path), sides, around=True), uv)


def turned(profile_mm: FloatArray, sides: int = 24) -> Solid:
    """Return a body of revolution about the y axis.

    Args:
        profile_mm: (K, 2) radius and y; y grows from point to point.
        sides: Of the cross-section.
    """
    turn = np.arange(sides) * 2 * np.pi / sides
    radius, y = np.asarray(profile_mm, float).T
    x, z = radius[:, None] * np.cos(turn), radius[:, None] * np.sin(turn)
    points = np.stack([x, np.broadcast_to(y[:, None], x.shape), z], axis=-1).reshape(-1, 3)
    uv = np.stack(np.meshgrid(turn / (2 * np.pi), y / 40.0), axis=-1).reshape(-1, 2)
    return Solid(points, grid_triangles(len(y), sides, around=True)[:, ::-1], uv)


def surface_of(field: FloatArray, corner_mm: FloatArray, step_mm: float) -> Solid:
    """Return the surface where a field on a grid is zero, by surface nets [Gibson 1998].

    Each cell that the surface passes gets one point, the mean of where it cuts the cell's
    edges; each edge that is cut gets a quad of its four cells' points.

    Args:
        field: (X, Y, Z) negative inside; the surface must not reach the border of the grid.
        corner_mm: (3,) where the grid begins.
        step_mm: Between its points.
    """
    shape = np.array(field.shape) - 1
    total, count = np.zeros((*shape, 3)), np.zeros(tuple(shape))
    quads = []
    number = np.arange(int(np.prod(shape))).reshape(shape)
    for axis in range(3):
        low = field.take(range(field.shape[axis] - 1), axis)
        high = field.take(range(1, field.shape[axis]), axis)
        where = np.argwhere((low < 0) != (high < 0))
        at, after = low[tuple(where.T)], high[tuple(where.T)]
        places = where.astype(float)
        places[:, axis] += at / (at - after)
        ways = [a for a in range(3) if a != axis]
        cells = []
        for back in product((0, 1), repeat=2):
            cell = where.copy()
            cell[:, ways] -= back
            np.add.at(total, tuple(cell.T), places)
            np.add.at(count, tuple(cell.T), 1)
            cells.append(number[tuple(cell.T)])
        # Which way round depends on the axis (its two others are not always in cyclic order)
        # and on which end of the edge lies inside.
        a, b, c, d = cells[0], cells[1], cells[3], cells[2]
        turn = (at < 0) ^ (axis == 1)
        b, d = np.where(turn, d, b), np.where(turn, b, d)
        quads.append(np.stack([a, b, c, d], axis=1))
    used, flat = np.unique(np.concatenate(quads), return_inverse=True)
    quad = flat.reshape(-1, 4)
    points = total.reshape(-1, 3)[used] / count.reshape(-1, 1)[used] * step_mm + corner_mm
    triangles = np.concatenate([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]])
    return Solid(points, triangles.astype(np.int32), points[:, :2])


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
