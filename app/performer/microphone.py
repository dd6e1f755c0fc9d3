"""A microphone on an arm, before the chin of whoever speaks into it."""

import numpy as np

from app.performer.shapes import Solid, joined, tube, turned
from app.render.scene import Material
from core.geometry import matrix_from_rotation_vector
from core.records import U8, FloatArray

#: Its head's middle from the middle of the lips, and how it leans, model frame at rest.
_FROM_LIPS_MM = np.array([9.0, 24.0, -64.0])
_LEAN_RAD = np.array([-0.55, 0.0, 0.12])
_BALL_MM = 24.0


def microphone(lips_mm: FloatArray) -> tuple[Solid, Solid]:
    """Return the grille and the rest of a microphone before lips (3,), model frame."""
    height = np.linspace(-1, 1, 13)
    radius = _BALL_MM * np.sqrt(np.clip(1 - height**2, 1e-4, 1))
    grille = turned(np.stack([radius, 1.12 * _BALL_MM * height], axis=1))
    body = turned(np.array([
        [14.0, 19.0], [22.5, 20.0], [23.0, 27.0], [19.0, 31.0], [16.5, 44.0], [13.0, 150.0],
        [0.1, 151.0],
    ]))  # fmt: skip
    arm_path = np.array([[0, 140, 0], [4, 190, -6], [25, 260, -10], [70, 420, 0]], float)
    arm = tube(arm_path, 6.0, np.array([0.0, 0.0, 1.0]), sides=10)
    lean, place = matrix_from_rotation_vector(_LEAN_RAD), lips_mm + _FROM_LIPS_MM
    return _placed(grille, lean, place), _placed(joined(body, arm), lean, place)


def _placed(solid: Solid, rotation: FloatArray, place_mm: FloatArray) -> Solid:
    return Solid(solid.points_mm @ rotation.T + place_mm, solid.triangles, solid.uv)


def grille_material() -> Material:
    """Return woven wire."""
    y, x = np.mgrid[0:64, 0:64]
    weave = 0.5 + 0.5 * np.sin(x * np.pi / 4) * np.sin(y * np.pi / 4)
    texture: U8 = (np.array([128, 130, 134]) * (0.45 + 0.55 * weave[..., None])).astype(np.uint8)
    return Material("wet", texture, {"gloss": 0.35, "roughness2": 0.2}, repeated=True)


def body_material() -> Material:
    """Return black paint."""
    texture = np.full((4, 4, 3), (34, 34, 37), np.uint8)
    return Material("wet", texture, {"gloss": 0.5, "roughness2": 0.08}, two_sided=True)
