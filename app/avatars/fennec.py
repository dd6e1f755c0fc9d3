"""Fennec: a fox-like creature with a muzzle, large ears, slit pupils and fur."""

from collections.abc import Sequence

import numpy as np

from app.avatars.build import Head, Worn
from app.avatars.characters import Character, carried, gradient_texture, sideless
from app.avatars.drawn_eyes import DrawnEye
from app.avatars.looks import Looks
from app.avatars.pieces import Clump, Piece, ball, clump, ear, joined, mirrored
from app.avatars.warp import EyeStyle, Lay, Push, Swell
from app.render.scene import Material
from core.arkit import EXPRESSION_NAMES
from core.geometry import matrix_from_rotation_vector
from core.landmarks import NAMES
from core.records import F32, U8, FloatArray

_STEPS = (
    Lay(64, 0.10, (22, 85), (60, 34)),
    Swell((0, -60, 75), (120, 70, 120), (1.10, 0.82, 1.0)),
    Push((0, 58, -32), (30, 34, 42), (0, -6, -28)),
    Push((0, 38, -74), (24, 20, 34), (0, 3, -19)),
    Push((0, 8, -32), (18, 20, 26), (0, 2, -10)),
    Swell((0, 38, -70), (30, 20, 40), (0.72, 0.9, 1.0)),
    Swell((0, 65, -58), (60, 15, 60), (1.0, 0.72, 1.0)),
    Push((24, 68, -40), (22, 18, 34), (4, -7, 2)),
    Push((70, 36, 30), (36, 34, 50), (16, 2, -6)),
    Swell((0, 112, 30), (90, 40, 90), (0.72, 0.86, 0.95)),
    Swell((0, 150, 95), (200, 48, 200), (0.72, 1.0, 0.78)),
)
_EYES = EyeStyle(size=1.26, shift=(8.0, 1.0, 4.0), tall=0.24, slant_rad=0.14, inner=1.2, outer=3.2)
#: Tufts of the subject's left cheek: they cover where an ear of the model was.
_CHEEK = (
    Clump(((66, 16, -9), (88, 8, -1), (108, -4, 7)), 40, 0.2),
    Clump(((60, 6, -9), (82, -4, 0), (104, -18, 11)), 44, 0.2),
    Clump(((54, -4, -9), (76, -14, 1), (97, -31, 15)), 46, 0.2),
    Clump(((49, -14, -9), (68, -24, 1), (87, -42, 16)), 44, 0.2),
    Clump(((45, -23, -9), (60, -34, 0), (74, -51, 12)), 38, 0.2),
)
#: How ears turn with some expressions: about the axis to the side (forward), and inwards, rad.
_EAR_MOVES = {
    "browInnerUp": (0.10, 0.10), "browOuterUp": (0.12, 0.06), "eyeWide": (0.10, 0.05),
    "browDown": (-0.22, -0.34), "noseSneer": (-0.14, -0.16), "eyeBlink": (-0.06, -0.04),
    "mouthFrown": (-0.10, -0.22), "mouthSmile": (0.0, -0.08), "jawOpen": (-0.06, -0.03),
}  # fmt: skip
#: Foot and tip of the left ear.
_FOOT_MM, _TIP_MM = np.array([44.0, -56.0, 58.0]), np.array([84.0, -150.0, 66.0])


def _worn(head: Head) -> tuple[Worn, ...]:
    """Return ears, nose and tufts."""
    skin = head.neutral_mm[np.unique(head.model.triangles[head.model.part_triangles("skin")])]
    left = ear(_FOOT_MM, _TIP_MM, 76.0, 15.0)
    ears = joined([mirrored(left), left])
    tip = head.neutral_mm[head.model.landmark_vertices[NAMES.index("nose_tip")]]
    nose = ball(tip + [0, -1, 1], np.array([11.5, 8.0, 8.0]), 0.35)
    cream = gradient_texture((220, 136, 66), (255, 244, 226), 0.10)
    return (
        Worn(Material("plain", _ear_texture()), ears, _ear_deltas(ears)),
        Worn(Material("wet", _nose_texture(), {"gloss": 0.5}), nose, _as_one(nose, head)),
        _tufts(_CHEEK, cream, head, skin),
    )


def _as_one(piece: Piece, head: Head) -> F32:
    """Return how a piece moves (46, n, 3) that keeps its shape."""
    middle = piece.points_mm.mean(axis=0, keepdims=True)
    return carried(middle, head, 12).repeat(len(piece.points_mm), axis=1)


def _tufts(shapes: Sequence[Clump], texture: U8, head: Head, skin: FloatArray) -> Worn:
    """Return clumps of both sides that move with the skin below them."""
    one = [clump(shape, skin) for shape in shapes]
    both = joined(one + [mirrored(piece) for piece in one])
    return Worn(Material("plain", texture), both, carried(both.points_mm, head))


def _ear_deltas(ears: Piece) -> F32:
    """Return how ears turn with the expressions, (46, n, 3): the right one's half comes first."""
    out = np.zeros((len(EXPRESSION_NAMES), len(ears.points_mm), 3), np.float32)
    half = len(ears.points_mm) // 2
    for index, name in enumerate(EXPRESSION_NAMES):
        kind = sideless(name)
        if kind not in _EAR_MOVES:
            continue
        forward, inward = _EAR_MOVES[kind]
        for side, rows in ((-1.0, slice(0, half)), (1.0, slice(half, None))):
            if name.endswith("Right" if side > 0 else "Left"):
                continue
            out[index, rows] = _turned(ears.points_mm[rows], side, forward, inward)
    return out


def _turned(points: FloatArray, side: float, forward: float, inward: float) -> FloatArray:
    foot = _FOOT_MM * [side, 1, 1]
    turn = matrix_from_rotation_vector(np.array([forward, 0.0, -side * inward]))
    return np.asarray((points - foot) @ turn.T + foot - points)


def _ear_texture() -> U8:
    """Return the ears' back on the left half, their inside on the right, (128, 128, 3)."""
    v, u = np.mgrid[0:128, 0:128].astype(np.float32) / 127
    rng = np.random.default_rng(4)
    hair = 1 + 0.06 * rng.normal(size=(1, 128, 1)).repeat(128, axis=0)
    back = np.array([214, 128, 60], np.float32) * np.ones((128, 128, 1), np.float32)
    tip = np.clip((0.32 - v) / 0.25, 0, 1)[..., None]
    back += tip * (np.array([92, 48, 30], np.float32) - back)
    rim = np.clip((np.abs(u - 0.75) * 4 - 0.55) / 0.4, 0, 1)[..., None]
    inside = np.array([244, 196, 176], np.float32) * (1 - rim) + rim * np.array([250, 228, 200])
    picture = np.where(u[..., None] < 0.5, back, inside) * hair
    return np.asarray(np.clip(picture, 0, 255).astype(np.uint8))


def _nose_texture() -> U8:
    return np.full((8, 8, 3), (44, 30, 32), np.uint8)


FENNEC = Character(
    likeness=0.0,
    person="nora",
    steps=_STEPS,
    eyes=_EYES,
    even=12,
    looks=Looks(lashes=0.0, hair_style="bald", shirt=(64, 96, 84)),
    eye=DrawnEye((214, 158, 40), iris_rad=0.62, pupil=0.62, slit=0.42, white=(226, 214, 196)),
    oily=0.05,
    worn=_worn,
    strengths={"mouthSmile": 1.2, "browInnerUp": 1.3, "browDown": 1.2, "mouthPucker": 1.2},
    extras={"mouthSmile": Push((25, 64, -42), (11, 13, 24), (4, -6, 3))},
)
