"""Glasses that sit on a person's nose: two rims, a bridge, temples to the ears, lenses."""

import cv2
import numpy as np

from app.performer.shapes import Solid, grid_triangles, joined, tube
from app.render.scene import Material, Uniforms
from core.face_model import FaceModel, eye_centers_mm
from core.records import U8, FloatArray

#: Half a lens: width, height; how angular it is; its middle below the eye.
_HALF_WIDTH_MM, _HALF_HEIGHT_MM, _POWER, _DROP_MM = 25.0, 19.0, 2.9, 3.5
#: Outwards from the eye's centre to the lens's, and from the eye's centre forwards to the lens.
_OUTWARDS_MM, _BEFORE_MM = 3.5, 25.0
#: Half the thickness of rims and temples; space between rims and skin.
_RIM_MM, _TEMPLE_MM, _CLEAR_MM = 1.7, 2.0, 2.6
#: How much the front bends back towards the temples, mm per mm squared.
_BEND = 0.0028
#: Where the temples end: down from the eyes and behind them.
_EAR_Y_MM, _EAR_Z_MM = 2.0, 82.0
#: Sign of x on the right, then on the left side.
_SIDES = (-1, 1)


def frame_and_lenses(model: FaceModel, head_mm: FloatArray) -> tuple[Solid, Solid]:
    """Return the frame and both lenses on a head (V, 3), model frame."""
    eyes = eye_centers_mm(model, head_mm)
    skin = head_mm[np.unique(model.triangles[model.part_triangles("skin")])]
    outlines = [_outline(eyes[e], sign) for e, sign in enumerate(_SIDES)]
    forward = _forward_mm(np.concatenate(outlines), skin)
    outlines = [outline - [0, 0, forward] for outline in outlines]
    front = np.array([0.0, 0.0, 1.0])
    rims = [tube(outline, _RIM_MM, front, closed=True) for outline in outlines]
    bridge = _bridge(outlines, _before_skin(skin, 0.0))
    temples = [_temple(o, skin, sign) for o, sign in zip(outlines, _SIDES, strict=True)]
    return joined(*rims, bridge, *temples), joined(*(_lens(outline) for outline in outlines))


def _outline(eye_mm: FloatArray, sign: int) -> FloatArray:
    """Return the middle line (48, 3) of a rim about an eye, sign = -1 for the right one."""
    turn = np.arange(48) * 2 * np.pi / 48
    x, y = np.cos(turn), np.sin(turn)
    round_ = (np.abs(x) ** _POWER + np.abs(y) ** _POWER) ** (-1 / _POWER)
    x, y = _HALF_WIDTH_MM * x * round_, _HALF_HEIGHT_MM * y * round_
    # Lenses are lower towards the nose, where cheeks and nose need room.
    y = y * (1 - 0.12 * np.clip(-sign * x / _HALF_WIDTH_MM, 0, 1) * (y > 0))
    x = eye_mm[0] + sign * _OUTWARDS_MM + x
    z = eye_mm[2] - _BEFORE_MM + _BEND * x * x
    return np.stack([x, eye_mm[1] + _DROP_MM + y, z], axis=1)


def _forward_mm(rims_mm: FloatArray, skin_mm: FloatArray) -> float:
    """Return how far the rims must come forward to be clear of the skin."""
    need = [0.0]
    for point in rims_mm:
        near = skin_mm[np.linalg.norm(skin_mm[:, :2] - point[:2], axis=1) < 5]
        if len(near):
            need.append(float(point[2] - near[:, 2].min() + _RIM_MM + _CLEAR_MM))
    # Pads and brows give way a little, or a strong brow would hold the glasses far off.
    return min(max(need), 9.0)


def _before_skin(skin_mm: FloatArray, y_mm: float) -> float:
    """Return z just before the bridge of the nose at a height."""
    near = skin_mm[(np.abs(skin_mm[:, 0]) < 6) & (np.abs(skin_mm[:, 1] - y_mm) < 5)]
    return float(near[:, 2].min()) - _CLEAR_MM


def _bridge(outlines: list[FloatArray], before_mm: float) -> Solid:
    """Return the arc over the nose between the rims (48, 3) each."""
    right = outlines[0][np.argmax(outlines[0][:, 0] - 0.4 * outlines[0][:, 1])]
    left = outlines[1][np.argmin(outlines[1][:, 0] + 0.4 * outlines[1][:, 1])]
    share = np.linspace(0, 1, 9)[:, None]
    path = right + share * (left - right)
    arch = np.sin(np.pi * share[:, 0])
    path[:, 1] -= 3.0 * arch
    path[:, 2] = np.minimum(path[:, 2], before_mm * arch + path[:, 2] * (1 - arch))
    return tube(path, _RIM_MM, np.array([0.0, 1.0, 0.3]))


def _temple(outline: FloatArray, skin_mm: FloatArray, sign: int) -> Solid:
    """Return the bar from a rim to the ear, just off the side of the head."""
    hinge = outline[np.argmax(sign * outline[:, 0] - 0.5 * outline[:, 1])]
    share = np.linspace(0, 1, 14)
    z = hinge[2] + share * (_EAR_Z_MM - hinge[2])
    y = hinge[1] + share * (_EAR_Y_MM - hinge[1])
    side = []
    for height, depth in zip(y, z, strict=True):
        level = skin_mm[(np.abs(skin_mm[:, 1] - height) < 8) & (np.abs(skin_mm[:, 2] - depth) < 10)]
        # An ear stands off the head; the bar runs between the two.
        wide = np.sort(sign * level[:, 0])
        side.append(min(float(wide[-1]) if len(wide) else 0.0, 76.0) + 2.5)
    widest = np.maximum.accumulate(np.maximum(side, sign * hinge[0]))
    smooth = np.convolve(np.pad(widest, 2, mode="edge"), np.ones(5) / 5, mode="valid")
    smooth[0] = sign * hinge[0]
    path = np.stack([sign * smooth, y, z], axis=1)
    return tube(path, _TEMPLE_MM, np.array([0.0, 1.0, 0.0]), sides=6)


def _lens(outline: FloatArray) -> Solid:
    """Return the glass inside a rim."""
    center = outline.mean(axis=0)
    shares = np.linspace(1.0, 0.02, 6)
    rings = center + shares[:, None, None] * (outline - center)
    points = rings.reshape(-1, 3)
    # The middle is nearer to the viewer than the rim's mean: glass bulges.
    points[:, 2] -= np.repeat(1.6 * (1 - shares**2), len(outline))
    low, high = outline.min(axis=0)[:2], outline.max(axis=0)[:2]
    uv = (points[:, :2] - low) / (high - low)
    triangles = grid_triangles(len(shares), len(outline), around=True)[:, ::-1]
    return Solid(points, triangles, uv)


def frame_material() -> Material:
    """Return dark, shiny plastic."""
    texture = np.full((4, 4, 3), (38, 30, 28), np.uint8)
    return Material("wet", texture, {"gloss": 0.5, "roughness2": 0.06}, two_sided=True)


def lens_material() -> Material:
    """Return glass: almost clear, with the pale streaks of a window mirrored in it."""
    x, y = np.meshgrid(np.linspace(0, 1, 96), np.linspace(0, 1, 96))
    across = x + 0.55 * y
    streaks = 0.9 * np.exp(-(((across - 0.42) / 0.09) ** 4)) + 0.5 * np.exp(
        -(((across - 0.66) / 0.035) ** 4)
    )
    streaks *= np.clip(1.25 - 1.3 * y, 0, 1)
    alpha = cv2.GaussianBlur(0.07 + 0.36 * streaks, (0, 0), 1.5)
    picture = np.empty((96, 96, 4), np.uint8)
    picture[..., :3] = (205, 214, 222)
    texture: U8 = picture
    texture[..., 3] = np.clip(255 * alpha, 0, 255)
    values: Uniforms = {"cutoff": 0.0, "shine": 0.0, "whorl": np.zeros(3)}
    return Material("hair", texture, values, two_sided=True, blended=True)
