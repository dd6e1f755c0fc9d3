"""A hand that comes up from below, covers mouth, eye or nose for a while and goes away again.

Hand frame, mm: x along the fingers, y down, z from the back of the hand to the palm; origin in
the palm. It is the performer's right hand.
"""

import cv2
import numpy as np

from app.avatars.looks import Color
from app.performer.shapes import Solid, surface_of, tube
from app.render.scene import Material, placed
from core.geometry import matrix_from_rotation_vector
from core.records import U8, FloatArray

#: A finger each: joints (x, y, z) from the knuckle to the tip, then the radius at both ends.
_FINGERS = (
    ([(42, -29, 0), (83, -37, 2), (106, -40, 9), (124, -41, 18)], 10.0, 7.4),
    ([(46, -9, -2), (91, -12, 1), (118, -13, 9), (138, -12, 20)], 10.3, 7.7),
    ([(43, 11, -1), (85, 13, 2), (110, 15, 10), (129, 17, 19)], 9.8, 7.3),
    ([(34, 29, 2), (66, 36, 5), (84, 39, 11), (101, 42, 18)], 8.6, 6.4),
    # The thumb, laid along the cheek.
    ([(-34, -24, 8), (-4, -52, 9), (24, -68, 11), (44, -76, 15)], 12.5, 8.6),
)
#: From the wrist to each knuckle, and the roots of the thumb: what makes the palm.
_PALM = (
    ((-48, -14, 2), (40, -28, 1), 13.5, 11.0),
    ((-48, -5, 0), (44, -9, -1), 14.0, 11.5),
    ((-48, 5, 0), (41, 11, 0), 14.0, 11.0),
    ((-48, 14, 2), (32, 28, 3), 13.5, 10.0),
    ((-48, -10, 6), (-10, -40, 10), 14.0, 12.5),
)
#: The forearm falls off to the elbow.
_ELBOW = np.array([-235.0, 150.0, -30.0])
_ARM = (
    ((-50, -10, 2), tuple(_ELBOW + [0, -22, 0]), 17.0, 30.0),
    ((-50, 10, 2), tuple(_ELBOW + [0, 22, 0]), 17.0, 30.0),
)
_STEP_MM, _MELT_MM = 3.0, 5.0
_LOW, _HIGH = np.array([-180.0, -96.0, -40.0]), np.array([154.0, 150.0, 52.0])
#: Texture pixels per mm.
_SCALE = 1.5
#: Where the palm's origin is from the middle of the lips, head frame, when it covers them.
AT_LIPS_MM = np.array([-42.0, 18.0, -21.0])
#: From the right eye's centre, when only that one is covered.
AT_EYE_MM = np.array([-100.0, 22.0, -40.0])
#: From the lips, when it strokes nose and upper lip.
AT_NOSE_MM = np.array([-66.0, -22.0, -36.0])
#: Where it is when it is away, from there, camera frame.
_AWAY_MM = np.array([-70.0, 330.0, -40.0])
_TILT_RAD = np.deg2rad(-14.0)


def hand_solid() -> Solid:
    """Return the hand with the forearm as far as the sleeve."""
    axes = [np.arange(a, b, _STEP_MM) for a, b in zip(_LOW, _HIGH, strict=True)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    melted = np.zeros(places.shape[:3])
    for start, end, near_mm, far_mm in (*_PALM, *_ARM, *_bones()):
        away = _capsule(places, np.array(start, float), np.array(end, float), (near_mm, far_mm))
        melted += np.exp(-np.clip(away, -60, 60) / _MELT_MM)
    field = -_MELT_MM * np.log(melted)
    # The forearm is cut off inside the sleeve, and the grid's border is outside.
    field = np.maximum(field, -(places[..., 0] + 160.0))
    solid = surface_of(field, _LOW, _STEP_MM)
    uv = (solid.points_mm[:, :2] - _LOW[:2]) / (_HIGH - _LOW)[:2]
    return Solid(solid.points_mm, solid.triangles, uv)


def _bones() -> list[tuple[tuple[float, ...], tuple[float, ...], float, float]]:
    """Return the segments of all fingers: two ends, two radii."""
    out: list[tuple[tuple[float, ...], tuple[float, ...], float, float]] = []
    for joints, near_mm, far_mm in _FINGERS:
        radii = np.linspace(near_mm, far_mm, len(joints))
        for k in range(len(joints) - 1):
            out.append((joints[k], joints[k + 1], float(radii[k]), float(radii[k + 1])))
    return out


def _capsule(
    places: FloatArray, start: FloatArray, end: FloatArray, radii_mm: tuple[float, float]
) -> FloatArray:
    """Return the distance of places (..., 3) from a segment with a radius at either end."""
    way = end - start
    share = np.clip(((places - start) @ way) / float(way @ way), 0, 1)
    radius = radii_mm[0] + share * (radii_mm[1] - radii_mm[0])
    return np.asarray(np.linalg.norm(places - start - share[..., None] * way, axis=-1) - radius)


def hand_skin(color: Color, rng: np.random.Generator) -> Material:
    """Return skin, seen from the back of the hand: folds between fingers, joints, nails."""
    width, height = ((_HIGH - _LOW)[:2] * _SCALE).astype(int)
    x, y = np.meshgrid(np.arange(width) / _SCALE + _LOW[0], np.arange(height) / _SCALE + _LOW[1])
    ways = np.stack([x, y, 0 * x], axis=-1)
    fingers: list[FloatArray] = []
    red, nails = np.zeros(x.shape), np.zeros(x.shape)
    for joints, near_mm, far_mm in _FINGERS:
        flat = np.array(joints, float) * [1, 1, 0]
        radii = np.linspace(near_mm, far_mm, 4)
        parts = [_capsule(ways, flat[k], flat[k + 1], (0.0, 0.0)) / radii[k] for k in range(3)]
        fingers.append(np.min(parts, axis=0))
        for joint in flat[:3]:
            red += np.exp(-(((x - joint[0]) / 7) ** 2 + ((y - joint[1]) / 8) ** 2))
        nail = flat[3] + 0.1 * (flat[2] - flat[3])
        nails += np.exp(-((((x - nail[0]) / 7.5) ** 2 + ((y - nail[1]) / 5.5) ** 2) ** 3))
    edge = np.sort(np.array(fingers), axis=0)
    # Dark where two fingers are as near as each other: the fold between them.
    fold = np.exp(-(((edge[1] - edge[0]) / 0.22) ** 2)) * (edge[0] < 1.6) * (x > 30)
    mottle = cv2.GaussianBlur(rng.normal(size=x.shape), (0, 0), 4) * 4
    base = np.square(np.array(color, float) / 255)
    tint = base * (1 + 0.07 * mottle[..., None]) * (1 - 0.75 * fold[..., None])
    tint *= 1 + np.clip(red, 0, 1)[..., None] * [0.03, -0.16, -0.14]
    tint += np.clip(nails, 0, 1)[..., None] * 0.55 * (base * [1.1, 1.0, 1.0] - tint + 0.1)
    gloss = 0.25 + 0.35 * np.clip(nails, 0, 1)
    rgb = 255 * np.sqrt(np.clip(tint, 0, 1))
    picture = np.concatenate([rgb, 255 * gloss[..., None]], axis=-1)
    texture: U8 = np.clip(picture, 0, 255).astype(np.uint8)
    return Material("skin", texture)


def sleeve_solid() -> Solid:
    """Return the sleeve's end, which swallows the forearm."""
    start = np.array([-50.0, 0.0, 2.0])
    shares = np.linspace(0.4, 1.2, 12)
    path = start + shares[:, None] * (_ELBOW - start)
    sleeve = tube(path, 41.0, np.array([0.0, 0.0, 1.0]), sides=20)
    return Solid(sleeve.points_mm, sleeve.triangles, sleeve.uv * [6.0, 10.0])


def hand_to_camera(head_to_camera: FloatArray, place_mm: FloatArray, share: float) -> FloatArray:
    """Return where the hand is, (4, 4).

    Args:
        head_to_camera: (4, 4).
        place_mm: (3,) of the palm when it is there, model frame.
        share: How far it has come: 0 away, 1 there.
    """
    tilt = matrix_from_rotation_vector(np.array([0.0, 0.0, _TILT_RAD]))
    out = head_to_camera @ placed(tilt, place_mm)
    out[:3, 3] += (1 - share) * _AWAY_MM
    return np.asarray(out)
