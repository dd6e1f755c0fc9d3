"""Eyes of drawn characters: clean white, a large even iris, a round or a slit pupil."""

from dataclasses import dataclass

import numpy as np

from app.avatars.looks import Color, linear, rgb
from app.render.eyeball import EDGE_RAD
from core.records import F32, U8


@dataclass(frozen=True, slots=True)
class DrawnEye:
    """How an eye is drawn.

    Attributes:
        iris: Its main colour.
        iris_rad: Angle from the pupil to the rim of the iris.
        pupil: Radius of the pupil as a share of the iris's.
        slit: Width of the pupil as a share of its height.
        white: Colour of the white.
    """

    iris: Color
    iris_rad: float = 0.5
    pupil: float = 0.5
    slit: float = 1.0
    white: Color = (236, 234, 230)


def drawn_eye_texture(eye: DrawnEye, size_px: int = 256) -> U8:
    """Return the front view of an eyeball, (S, S, 3) uint8."""
    axis = (np.arange(size_px, dtype=np.float32) + 0.5) / size_px * 2 - 1
    x, y = np.meshgrid(axis, axis)
    angle = np.hypot(x, y) * np.float32(EDGE_RAD)
    reach = angle / np.float32(eye.iris_rad)
    soft = float(4.4 * EDGE_RAD / size_px / eye.iris_rad)
    color = np.ones((size_px, size_px, 3), np.float32) * 0.82 * linear(eye.white)
    color *= 1 - 0.45 * np.clip((angle - 0.7) / 0.9, 0, 1)[..., None] * rgb(0.3, 0.8, 0.8)
    # Lighter below, as if light from above went through the iris.
    glow = np.clip(0.62 + 0.55 * y * np.float32(EDGE_RAD / eye.iris_rad), 0.3, 1.25)
    rays = 1 + 0.06 * np.cos(26 * np.arctan2(y, x)) * np.clip(reach, 0, 1)
    iris = linear(eye.iris) * (glow * rays)[..., None]
    iris *= 1 - 0.75 * _step(reach, 0.86, 0.08)[..., None]
    color = _over(color, iris, 1 - _step(reach, 1.0, soft))
    across = np.hypot(x / eye.slit, y) * np.float32(EDGE_RAD / eye.iris_rad / eye.pupil)
    pupil = 1 - _step(across, 1.0, soft / eye.pupil / eye.slit)
    color = _over(color, np.zeros_like(color) + 0.004, pupil)
    return np.asarray((255 * np.sqrt(np.clip(color, 0, 1)) + 0.5).astype(np.uint8))


def _step(value: F32, at: float, width: float) -> F32:
    return np.asarray(np.clip((value - at) / width + 0.5, 0, 1), np.float32)


def _over(color: F32, other: F32, share: F32) -> F32:
    return np.asarray(color + share[..., None] * (other - color), np.float32)
