"""Draws the points whose grey levels a stage reads."""

from dataclasses import dataclass

import numpy as np

from core.appearance import AppearancePoints
from core.geometry import register_rigid
from core.records import I32, FloatArray


@dataclass(frozen=True, slots=True)
class PointSettings:
    """How appearance points are drawn.

    Attributes:
        n_points: P, points per stage [Cao13: 400].
        spread: Standard deviation of their distance from a landmark, in face radii.
        reach: Farthest distance of points outside the triangles from the nearest landmark, in
            face radii: beyond lie hair and walls.
        barycentric: Carry each point by the three corners of a triangle of the face, so that it
            turns and stretches with the shape. False: the paper's offset from one landmark.
        n_cells: Cells in which the local contrast is measured.
        cell_size: Points that a cell is measured on.
        softening: Grey levels added to the contrast, which keeps noise of flat skin small;
            0: raw grey levels, as in the paper.
    """

    n_points: int = 300
    spread: float = 0.4
    reach: float = 0.5
    barycentric: bool = True
    n_cells: int = 40
    cell_size: int = 40
    softening: float = 6.0


def mean_shape(shapes_mm: FloatArray) -> FloatArray:
    """Return the mean (Q, 3) of shapes (N, Q, 3), each turned to lie on the middle one first."""
    centred = shapes_mm - shapes_mm.mean(axis=1, keepdims=True)
    middle = np.sum((centred - centred.mean(axis=0)) ** 2, axis=(1, 2)).argmin()
    turned = [shape @ register_rigid(shape, centred[middle])[0].T for shape in centred]
    return np.asarray(np.mean(turned, axis=0))


def draw_points(
    shape_mm: FloatArray, triangles: I32, rng: np.random.Generator, settings: PointSettings
) -> AppearancePoints:
    """Draw appearance points around the landmarks of a mean shape.

    Args:
        shape_mm: (Q, 3) mean shape.
        triangles: (M, 3) a triangulation of its points over the front of the face.
        rng: Source of the draw.
        settings: How to draw.
    """
    radius = np.sqrt(np.mean(np.sum((shape_mm - shape_mm.mean(axis=0)) ** 2, axis=1)))
    wanted, reach = settings.n_points, settings.reach * radius
    near = rng.integers(0, len(shape_mm), 8 * wanted)
    drawn = shape_mm[near] + rng.normal(0, settings.spread * radius, (len(near), 3))
    corners, weights = _carry(shape_mm, triangles, drawn)
    places = np.einsum("pc,pcd->pd", weights, shape_mm[corners])
    squared = ((places[:, None] - shape_mm) ** 2).sum(axis=2)
    kept = np.flatnonzero((weights.min(axis=1) >= 0) | (squared.min(axis=1) < reach**2))[:wanted]
    corners, weights, places = corners[kept], weights[kept], places[kept]
    offsets = np.zeros_like(places)
    if not settings.barycentric:
        nearest, places = squared[kept].argmin(axis=1), drawn[kept]
        corners = np.repeat(nearest[:, None], 3, axis=1).astype(np.int32)
        weights = np.tile([1.0, 0.0, 0.0], (len(kept), 1))
        offsets = places - shape_mm[nearest]
    members, cell = _cells(places, settings)
    return AppearancePoints(corners, weights, offsets, members, cell)  # type: ignore[arg-type]


def _carry(shape_mm: FloatArray, triangles: I32, points_mm: FloatArray) -> tuple[I32, FloatArray]:
    """Return corners (P, 3) and barycentric weights (P, 3) of the triangle nearest each point.

    Seen along the shape's flattest direction, the triangle is the one that contains the point,
    or else the one that is left least far; triangles too thin to extrapolate are passed over.
    """
    plane = np.linalg.svd(shape_mm - shape_mm.mean(axis=0), full_matrices=False)[2][:2]
    flat, points = shape_mm @ plane.T, points_mm @ plane.T
    a, b, c = (flat[triangles[:, k]] for k in range(3))
    doubled = _cross(b - a, c - a)
    longest = np.max([np.sum(e * e, axis=1) for e in (b - a, c - b, a - c)], axis=0)
    thick = np.abs(doubled) > 0.2 * longest
    a, b, c, doubled = a[thick], b[thick], c[thick], doubled[thick]
    p = points[:, None]
    weights = np.stack([_cross(b - p, c - p), _cross(c - p, a - p), _cross(a - p, b - p)], axis=2)
    weights /= doubled[:, None]
    nearest = weights.min(axis=2).argmax(axis=1)
    chosen = np.clip(weights[np.arange(len(points)), nearest], -2.0, 3.0)
    return triangles[thick][nearest], chosen / chosen.sum(axis=1, keepdims=True)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross products (...) of plane vectors (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _cells(places_mm: FloatArray, settings: PointSettings) -> tuple[I32, I32]:
    """Return the members of evenly spread cells and the cell of each point."""
    n_cells = min(settings.n_cells, len(places_mm))
    centers = [0]
    gap = ((places_mm - places_mm[0]) ** 2).sum(axis=1)
    while len(centers) < n_cells:
        centers.append(int(gap.argmax()))
        gap = np.minimum(gap, ((places_mm - places_mm[centers[-1]]) ** 2).sum(axis=1))
    squared = ((places_mm[:, None] - places_mm[centers]) ** 2).sum(axis=2)
    size = min(settings.cell_size, len(places_mm))
    members = np.argsort(squared, axis=0, kind="stable")[:size].T
    return members.astype(np.int32), squared.argmin(axis=1).astype(np.int32)
