"""A cup that is brought to the mouth and drunk from."""

import numpy as np

from app.performer.shapes import Solid, joined, tube, turned
from app.render.scene import Material, placed
from core.geometry import matrix_from_rotation_vector
from core.records import U8, FloatArray

_RADIUS_MM, _HEIGHT_MM = 41.0, 92.0
#: Its rim's middle from the middle of the lips, head frame, when it is drunk from.
_AT_LIPS_MM = np.array([0.0, 2.0, -46.0])
#: Where it is when it is away, from there, camera frame, and how it is tilted up there.
_AWAY_MM = np.array([60.0, 320.0, -60.0])
_TILT_RAD = -0.9


def cup_solid() -> Solid:
    """Return the cup, the origin in the middle of its rim, y down."""
    r, h = _RADIUS_MM, _HEIGHT_MM
    body = turned(
        np.array([[r - 4, 1.0], [r, 0.999], [r, 2.0], [r, h - 6], [r - 6, h], [0.1, h + 0.1]])[1:]
    )
    turn = np.linspace(-1.4, 1.4, 12)
    path = np.stack([r + 22 * np.cos(turn), h / 2 + 26 * np.sin(turn), 0 * turn], axis=1)
    return joined(body, tube(path, 5.0, np.array([0.0, 0.0, 1.0])))


def cup_material() -> Material:
    """Return glazed blue china."""
    texture: U8 = np.full((4, 4, 3), (52, 84, 150), np.uint8)
    return Material("wet", texture, {"gloss": 0.3, "roughness2": 0.08}, two_sided=True)


def cup_to_camera(head_to_camera: FloatArray, lips_mm: FloatArray, share: float) -> FloatArray:
    """Return where the cup is, (4, 4).

    Args:
        head_to_camera: (4, 4).
        lips_mm: (3,) middle of the person's lips, model frame.
        share: How far it has come: 0 away, 1 at the lips.
    """
    tilt = matrix_from_rotation_vector(np.array([_TILT_RAD * share, 0.0, 0.0]))
    out = head_to_camera @ placed(tilt, lips_mm + _AT_LIPS_MM)
    out[:3, 3] += (1 - share) * _AWAY_MM
    return np.asarray(out)
