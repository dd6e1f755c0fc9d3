"""Colours of a user's skin, hair and eyes, and how the hair is cut."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from app.avatars.hairline import above_hairline_mm
from app.avatars.likeness.light import RoomLight
from app.avatars.likeness.views import Posed, scene_light
from app.avatars.looks import Color
from core.face_model import FaceModel, eye_centers_mm
from core.landmarks import NAMES
from core.records import F32, U8, BoolArray, Camera, FloatArray, Landmarks2D

#: Heights over the scalp at which hair is looked for, mm, and how far above the hairline.
_OVER_MM, _ABOVE_MM = (4.0, 9.0), (10.0, 60.0)
#: Beside the jaw, from the eyes, mm: long hair hangs there.
_BESIDE_MM = np.array([[x, y, 60.0] for x in (-86.0, 86.0) for y in (66.0, 78.0, 90.0)])
_IRIS_MM = 6.0
#: Landmarks round the right and the left eye.
_EYE_OUTLINES = [
    [NAMES.index(f"{side}_eye_{place}") for place in (
        "outer", "up_outer", "up_mid", "up_inner", "inner", "lo_inner", "lo_mid", "lo_outer",
    )]
    for side in "RL"
]  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Frontal:
    """The pictures that show a face from the front.

    Attributes:
        images: Pictures (H, W, 3), the most frontal first.
        heads: The user's head in each.
        landmarks: Of each.
        camera: Theirs.
    """

    images: Sequence[U8]
    heads: Sequence[Posed]
    landmarks: Sequence[Landmarks2D]
    camera: Camera


@dataclass(frozen=True, slots=True)
class Hair:
    """What is known of a user's hair.

    Attributes:
        color: In white light.
        style: Key of hair.CUTS, or "bald".
    """

    color: Color
    style: str


def as_color(albedo: FloatArray | F32) -> Color:
    """Return the displayed colour of an albedo (3,); our textures hold square roots."""
    red, green, blue = np.clip(np.round(255 * np.sqrt(np.clip(albedo, 0, 1))), 0, 255).astype(int)
    return int(red), int(green), int(blue)


def hair_of(seen: Frontal, room: RoomLight, model: FaceModel, skin: FloatArray) -> Hair:
    """Return the hair seen above the hairline and beside the jaw.

    Args:
        seen: The pictures.
        room: Their light; its first pictures are these.
        model: Topology.
        skin: (3,) albedo of the user's skin.
    """
    above = above_hairline_mm(model.mean_mm.astype(float))
    scalp = np.flatnonzero((above > _ABOVE_MM[0]) & (above < _ABOVE_MM[1]))
    found, beside = [], []
    for number, (rgb, head) in enumerate(zip(seen.images, seen.heads, strict=True)):
        toward = -head.points_mm[scalp] / np.linalg.norm(
            head.points_mm[scalp], axis=1, keepdims=True
        )
        rows = scalp[np.einsum("vc,vc->v", head.normals[scalp], toward) > 0.35]
        for over in _OVER_MM:
            points = head.points_mm[rows] + over * head.normals[rows]
            light, inside = looked_up(rgb, points, seen.camera)
            found.append(room.albedo(light, head.normals[rows], number)[inside])
        beside.append(_beside(rgb, head, seen.camera, model) / (room.gains[number] * room.white))
    albedo = np.concatenate(found)
    if len(albedo) < 30:
        return Hair(as_color(skin * 0.2), "short")
    level = albedo.mean(axis=1)
    # Gleam and gaps make hair brighter than it is.
    darker = albedo[level <= np.quantile(level, 0.6)]
    color = np.median(darker, axis=0)
    apart = np.abs(np.log(np.maximum(color, 1e-3) / skin)).max()
    if apart < 0.35:
        return Hair(as_color(color), "bald")
    return Hair(as_color(np.clip(color, 0.006, 0.6)), _style(np.stack(beside), color))


def _style(beside: FloatArray, hair: FloatArray) -> str:
    """Return the cut: long if most pictures show hair beside the jaw on both sides."""
    alike = np.abs(np.log(np.maximum(beside, 1e-3) / np.maximum(hair, 1e-3))).max(axis=-1) < 0.5
    sides = alike.reshape(len(beside), 2, -1).mean(axis=2)
    return "bob" if (sides > 0.6).all(axis=1).mean() > 0.6 else "short"


def _beside(rgb: U8, head: Posed, camera: Camera, model: FaceModel) -> FloatArray:
    """Return the light (6, 3) beside the jaw, NaN outside the picture."""
    centers = eye_centers_mm(model, head.points_mm)
    across = (centers[1] - centers[0]) / np.linalg.norm(centers[1] - centers[0])
    chin = head.points_mm[model.landmark_vertices].mean(axis=0) - centers.mean(axis=0)
    down = chin - across * (chin @ across)
    down /= np.linalg.norm(down)
    frame = np.stack([across, down, np.cross(across, down)])
    light, inside = looked_up(rgb, centers.mean(axis=0) + _BESIDE_MM @ frame, camera)
    return np.where(inside[:, None], light, np.nan)


def looked_up(rgb: U8, points_mm: FloatArray, camera: Camera) -> tuple[FloatArray, BoolArray]:
    """Return the light (n, 3) at the projections of points (n, 3), and which lie inside."""
    pixels = camera.focal_px * points_mm[:, :2] / points_mm[:, 2:] + camera.center_px
    columns, rows = np.round(pixels).astype(int).T
    height, width = rgb.shape[:2]
    inside = (columns >= 0) & (rows >= 0) & (columns < width) & (rows < height)
    found = rgb[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
    return scene_light(found).astype(float), np.asarray(inside)


def iris_of(seen: Frontal, model: FaceModel, white: FloatArray) -> Color | None:
    """Return the main colour of the irises, None where they are not seen.

    A ring below the middle is looked at: lids shade the upper half, lamps are mirrored in it.
    `white` (3,) is the light that a white surface sends.
    """
    found = []
    for rgb, head, marks in zip(seen.images, seen.heads, seen.landmarks, strict=True):
        depth = eye_centers_mm(model, head.points_mm)[:, 2]
        for eye in range(2):
            radius = _IRIS_MM * seen.camera.focal_px / depth[eye]
            if marks.pupil_confidence[eye] < 0.5 or radius < 2.5:
                continue
            found.append(_ring(rgb, marks.pupils_px[eye], radius))
    light = np.concatenate(found) if found else np.empty((0, 3))
    if len(light) < 24:
        return None
    level = light.mean(axis=1)
    middle = light[(level > np.quantile(level, 0.3)) & (level < np.quantile(level, 0.8))]
    color = np.median(middle, axis=0) / white
    # The cornea mirrors grey surroundings over it, and white and pupil blur into it; lids shade it.
    tint = color - 0.7 * color.min()
    color = tint * (1.25 * (color.mean() - 0.5 * color.min()) / max(tint.mean(), 1e-6))
    color = np.clip(color, 0.012, 0.5)
    return as_color(color)


def white_of_eyes(seen: Frontal, model: FaceModel) -> FloatArray | None:
    """Return the light (3,) that comes from the white of the eyes, None where it is not seen."""
    found = []
    for rgb, head, marks in zip(seen.images, seen.heads, seen.landmarks, strict=True):
        depth = eye_centers_mm(model, head.points_mm)[:, 2]
        for eye in range(2):
            if marks.pupil_confidence[eye] < 0.5:
                continue
            outline = marks.points_px[_EYE_OUTLINES[eye]]
            radius = 1.15 * _IRIS_MM * seen.camera.focal_px / depth[eye]
            found.append(_white(rgb, outline, marks.pupils_px[eye], radius))
    light = np.concatenate(found) if found else np.empty((0, 3))
    if len(light) < 16:
        return None
    level = light.mean(axis=1)
    # The lids shade most of it, and lamps are mirrored in some of it.
    kept = (level > np.quantile(level, 0.5)) & (level < np.quantile(level, 0.95))
    return np.asarray(np.median(light[kept], axis=0))


def _white(rgb: U8, outline_px: FloatArray, pupil_px: FloatArray, radius_px: float) -> FloatArray:
    """Return the light (n, 3) inside an eye's outline (8, 2) beside the iris."""
    middle = outline_px.mean(axis=0)
    inner = middle + 0.85 * (outline_px - middle)
    mask = np.zeros(rgb.shape[:2], np.uint8)
    cv2.fillPoly(mask, [np.round(inner * 16).astype(np.int32)], 1, shift=4)
    rows, columns = np.nonzero(mask)
    away = np.hypot(columns - pupil_px[0], rows - pupil_px[1])
    kept = away > radius_px
    return np.asarray(scene_light(rgb[rows[kept], columns[kept]]), float)


def _ring(rgb: U8, center_px: FloatArray, radius_px: float) -> FloatArray:
    """Return the light (n, 3) of the lower and side parts of an iris."""
    reach = int(np.ceil(radius_px))
    column, row = np.round(center_px).astype(int)
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    away = np.hypot(x, y) / radius_px
    kept = (away > 0.42) & (away < 0.85) & (y > -0.35 * radius_px)
    rows, columns = (y[kept] + row), (x[kept] + column)
    height, width = rgb.shape[:2]
    inside = (columns >= 0) & (rows >= 0) & (columns < width) & (rows < height)
    return np.asarray(scene_light(rgb[rows[inside], columns[inside]]), float)
