"""A canvas in texture space that knows where on the head every pixel lies.

Everything is painted as a function of the place on the mean head in mm, so that islands of the
texture meet without a seam.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from core.face_model import FaceModel


@dataclass(frozen=True)
class Canvas:
    """Pixels of the skin's texture.

    Attributes:
        points_mm: (S, S, 3) place on the mean head, in the gutters that of the nearest pixel.
        inside: (S, S) where the texture is used.
        scale: Pixels per unit of uv.
    """

    points_mm: np.ndarray
    inside: np.ndarray
    scale: int

    def near(self, centre_mm: np.ndarray, radii_mm: np.ndarray | float) -> np.ndarray:
        """Return a soft spot (S, S) in [0, 1] around a place, by distance over radius."""
        offset = (self.points_mm - np.asarray(centre_mm, np.float32)) / np.asarray(
            radii_mm, np.float32
        )
        return np.exp(-np.einsum("yxc,yxc->yx", offset, offset))

    def noise(self, wavelength_mm: float, rng: np.random.Generator) -> np.ndarray:
        """Return smooth noise (S, S), mean 0, deviation 1, that knows no seams."""
        return lattice_noise(self.points_mm, wavelength_mm, rng)


def canvas_of(model: FaceModel, size_px: int) -> Canvas:
    """Return the canvas of the model's skin and mouth."""
    mine = np.flatnonzero(np.isin(model.part, [0, 1]))
    corners = model.uv[mine] * size_px - 0.5
    points = model.mean_mm[model.triangles[mine]]
    out = np.zeros((size_px, size_px, 3), np.float32)
    inside = np.zeros((size_px, size_px), bool)
    for corner, point in zip(corners.astype(float), points, strict=True):
        fill_triangle(out, inside, corner, point)
    nearest = distance_transform_edt(~inside, return_distances=False, return_indices=True)
    return Canvas(out[nearest[0], nearest[1]], inside, size_px)


def fill_triangle(
    out: np.ndarray, inside: np.ndarray, corner: np.ndarray, value: np.ndarray
) -> None:
    """Interpolate corner values (3, C) over a triangle (3, 2) px, a pixel's breadth beyond."""
    low = np.maximum(np.floor(corner.min(axis=0)).astype(int), 0)
    high = np.minimum(np.ceil(corner.max(axis=0)).astype(int) + 1, out.shape[0])
    x, y = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
    edges = np.array([corner[1] - corner[0], corner[2] - corner[0]]).T
    if abs(np.linalg.det(edges)) < 1e-9 or x.size == 0:
        return
    offset = np.stack([x - corner[0, 0], y - corner[0, 1]], axis=-1)
    bc = offset @ np.linalg.inv(edges).T
    weight = np.concatenate([1 - bc.sum(axis=-1, keepdims=True), bc], axis=-1)
    hit = weight.min(axis=-1) > -1e-4
    out[y[hit], x[hit]] = weight[hit] @ value
    inside[y[hit], x[hit]] = True


def lattice_noise(points: np.ndarray, wavelength_mm: float, rng: np.random.Generator) -> np.ndarray:
    """Return value noise at points (..., 3) from a random lattice, smoothly interpolated."""
    cells = 64
    lattice = rng.normal(0, 1, (cells, cells, cells)).astype(np.float32)
    place = points / wavelength_mm
    base = np.floor(place).astype(np.int32)
    part = (place - base).astype(np.float32)
    part = part * part * (3 - 2 * part)
    total = np.zeros(points.shape[:-1], np.float32)
    for corner in range(8):
        bits = [(corner >> axis) & 1 for axis in range(3)]
        weight = np.ones_like(total)
        for axis in range(3):
            weight *= part[..., axis] if bits[axis] else 1 - part[..., axis]
        total += weight * lattice[tuple((base[..., a] + bits[a]) % cells for a in range(3))]
    return total * 1.7


def uv_of(model: FaceModel, size_px: int) -> tuple[cKDTree, np.ndarray]:
    """Return a tree of mean-head points of the face's skin and their pixels (n, 2)."""
    mine = model.part_triangles("skin")
    vertices = model.triangles[mine].reshape(-1)
    pixels = model.uv[mine].reshape(-1, 2) * size_px - 0.5
    first = np.unique(vertices, return_index=True)[1]
    return cKDTree(model.mean_mm[vertices[first]]), pixels[first]


def stroke(canvas: np.ndarray, line_px: np.ndarray, width_px: float, strength: float) -> None:
    """Draw an antialiased polyline (n, 2), tapering to its end, into a float canvas, by max."""
    fixed = np.round(line_px * 16).astype(np.int32)
    low = np.maximum(line_px.min(axis=0).astype(int) - 4, 0)
    high = line_px.max(axis=0).astype(int) + 5
    patch = np.zeros((high[1] - low[1], high[0] - low[0]), np.uint8)
    if width_px >= 1.5:
        cv2.polylines(patch, [fixed - low * 16], False, 255, round(width_px), cv2.LINE_AA, 4)
    else:
        cv2.polylines(patch, [fixed - low * 16], False, round(255 * width_px / 1.5), 1,
                      cv2.LINE_AA, 4)  # fmt: skip
    view = canvas[low[1] : high[1], low[0] : high[0]]
    np.maximum(view, strength * patch[: view.shape[0], : view.shape[1]] / 255.0, out=view)
