"""What one setup picture shows of the user's head, texel by texel."""

from dataclasses import dataclass

import cv2
import numpy as np

from app.avatars.likeness.atlas import Atlas
from core.camera import project
from core.face_model import FaceModel
from core.geometry import matrix_from_quaternion
from core.kernels.morph import vertex_normals
from core.kernels.raster import cover
from core.records import (
    F32,
    U8,
    BoolArray,
    Camera,
    FloatArray,
    Landmarks2D,
    SetupShapes,
    UserBlendshapes,
)

#: Reach over the face of the distance between a landmark and its vertex, and its noise.
_REACH_MM, _NOISE = 16.0, 0.12
#: A texel this much behind the nearest surface is hidden.
_BEHIND_MM = 3.0
#: Surfaces that turn away further than this are not looked at: cosine to the view, and the
#: width over which they fade.
_LEAST_FACING, _FADE = 0.22, 0.45


@dataclass(frozen=True, slots=True, eq=False)
class Posed:
    """The user's head as it is in one picture.

    Attributes:
        points_mm: (V, 3) camera frame.
        normals: (V, 3) outwards, camera frame.
        pixels: (V, 2) where each vertex is in the picture, moved so that landmarks fit.
    """

    points_mm: FloatArray
    normals: F32
    pixels: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What one picture shows.

    Attributes:
        light: (X, 3) linear light that comes from each texel.
        normals: (X, 3) of the texels, camera frame.
        weight: (X,) how well each texel is seen, in [0, 1]; 0 where it is not.
    """

    light: F32
    normals: F32
    weight: F32


def posed(
    model: FaceModel, user: UserBlendshapes, shapes: SetupShapes, landmarks: Landmarks2D,
    camera: Camera, row: int,
) -> Posed:  # fmt: skip
    """Return the user's head in the picture of a row of the setup shapes."""
    turn = matrix_from_quaternion(shapes.rotations_wxyz[row])
    face = user.neutral_mm + np.tensordot(shapes.coefficients[row], user.deltas_mm, axes=1)
    points = face @ turn.T + shapes.translations_mm[row]
    normals = np.empty((len(points), 3), np.float32)
    vertex_normals(np.ascontiguousarray(points, np.float32), model.triangles, normals)
    pixels = project(camera, points)
    known = model.landmark_vertices
    apart = landmarks.points_px[: len(known)] - pixels[known]
    trust = landmarks.confidence[: len(known)]
    return Posed(points, normals, pixels + _smooth(face, face[known], apart, trust))


def _smooth(
    points_mm: FloatArray, places_mm: FloatArray, shifts_px: FloatArray, trust: FloatArray
) -> FloatArray:
    """Return a smooth field (V, 2) that follows shifts (L, 2) at places as far as trusted."""
    noise = np.diag(_NOISE + 4.0 * (1 - np.clip(trust, 0, 1)) ** 2)
    weights = np.linalg.solve(_near(places_mm, places_mm) + noise, shifts_px)
    return np.asarray(_near(points_mm, places_mm) @ weights)


def _near(a_mm: FloatArray, b_mm: FloatArray) -> FloatArray:
    squares = np.sum((a_mm[:, None] - b_mm[None]) ** 2, axis=-1)
    return np.asarray(np.exp(-0.5 * squares / _REACH_MM**2))


def view_of(rgb: U8, head: Posed, camera: Camera, atlas: Atlas, model: FaceModel) -> View:
    """Return what a picture (H, W, 3) shows of a posed head."""
    pixels = atlas.at_texels(head.pixels)
    normals = atlas.at_texels(head.normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-6)
    points = atlas.at_texels(head.points_mm)
    toward = -points / np.linalg.norm(points, axis=1, keepdims=True)
    facing = np.einsum("xc,xc->x", normals, toward)
    weight = np.clip((facing - _LEAST_FACING) / _FADE, 0, 1)
    # A slanted surface is deeper at the next pixel.
    step_mm = 2 * points[:, 2] / camera.focal_px
    slope = np.sqrt(np.maximum(1 - facing**2, 0)) / np.maximum(facing, 0.1)
    deepest = points[:, 2] - _BEHIND_MM - step_mm * slope
    weight *= _seen(rgb.shape[:2], head, model, pixels, deepest)
    found = _looked_up(rgb, pixels)
    # What the camera clipped has no colour.
    weight = weight * np.clip((252 - found.max(axis=1).astype(np.float32)) / 10, 0, 1)
    return View(scene_light(found), normals, weight.astype(np.float32))


def _looked_up(rgb: U8, pixels: F32) -> U8:
    """Return the colours (X, 3) of a picture at places (X, 2)."""
    # OpenCV wants pictures, none of them longer than 32767.
    padded = np.pad(pixels, ((0, -len(pixels) % 1024), (0, 0)), mode="edge")
    columns, rows = np.ascontiguousarray(padded.T.reshape(2, -1, 1024))
    found = cv2.remap(rgb, columns, rows, cv2.INTER_CUBIC, borderValue=0)
    return np.asarray(found.reshape(-1, 3)[: len(pixels)], np.uint8)


def _seen(
    shape: tuple[int, ...], head: Posed, model: FaceModel, pixels: F32, depth_mm: F32
) -> BoolArray:
    """Return (X,) which texels at depths (X,) nothing hides and no nearer edge is beside."""
    depth = np.full(shape, np.inf, np.float32)
    index = np.full(shape, -1, np.int32)
    flat = np.column_stack([head.pixels, head.points_mm[:, 2]]).astype(np.float32)
    cover(flat, model.triangles, depth, index)
    # The nearest within two pixels: beside an edge, colours of what is before it leak in.
    nearest = -cv2.dilate(-depth, np.ones((3, 3), np.uint8))
    columns, rows = np.round(pixels).astype(np.int32).T
    height, width = shape
    inside = (columns >= 2) & (rows >= 2) & (columns < width - 2) & (rows < height - 2)
    at = nearest[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
    return np.asarray(inside & (depth_mm < at))


def scene_light(color: U8 | F32) -> F32:
    """Return the linear light that a displayed colour (..., in 0..255) stands for.

    The inverse of what the avatars' shaders end with: the same light then looks the same.
    """
    squared = np.square(np.asarray(color, np.float32) / 255)
    half = 0.5 * (1 - squared)
    return np.asarray((np.sqrt(half**2 + 0.22 * 0.72 * squared) - half) / 0.22, np.float32)


def displayed(light: F32) -> F32:
    """Return the displayed colour in 0..255 of linear light: the inverse of `scene_light`."""
    light = np.maximum(light, 0)
    return np.asarray(255 * np.sqrt(light * (1 + 0.22 * light) / (0.72 + light)), np.float32)
