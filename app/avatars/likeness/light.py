"""The light of the setup pictures, and how it is divided out.

Spherical harmonics of second order describe nearly all of the light that comes back from a dull
surface (Ramamoorthi and Hanrahan 2001). The camera and the room stay while the head turns, so one
light explains all pictures, up to a gain of each: cameras change their exposure.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.avatars.likeness.views import View
from app.render.scene import Lights
from core.records import F32, I32, BoolArray, FloatArray

#: Texels looked at in each picture; strength of the pull towards light without a direction.
_SAMPLES, _PULL = 4000, np.array([0.0, 1, 1, 1, 4, 4, 4, 4, 4]) * 0.01
_ROUNDS = 6
#: Light is never taken to be less or more than this, relative to its mean.
LEAST, MOST = 0.45, 1.9


@dataclass(frozen=True, slots=True, eq=False)
class RoomLight:
    """The light of a session, scaled so that it is 1 on average on the skin looked at.

    Attributes:
        harmonics: (9, 3) weights by colour.
        gains: (N, 3) brightness of each picture.
        skin: (3,) mean light of the skin: albedo times the session's brightness.
        white: (3,) light that a white surface sends in the session's mean light.
    """

    harmonics: FloatArray
    gains: FloatArray
    skin: FloatArray
    white: FloatArray

    def albedo(self, light: F32 | FloatArray, normals: F32, picture: int) -> F32:
        """Return the albedo (X, 3) of what sends light (X, 3) in one picture."""
        sent = (self.gains[picture] * self.white).astype(np.float32)
        return np.asarray(light / (self.shade(normals) * sent), np.float32)

    def shade(self, normals: F32) -> F32:
        """Return the light (X, 3) on surfaces with normals (X, 3), 1 on average."""
        return np.clip(basis(normals) @ self.harmonics.astype(np.float32), LEAST, MOST)


def basis(normals: F32) -> F32:
    """Return the harmonics (X, 9) at unit normals (X, 3), up to constant factors."""
    x, y, z = normals.T
    return np.stack([np.ones_like(x), x, y, z, x * y, x * z, y * z, x * x - y * y,
                     3 * z * z - 1], axis=1)  # fmt: skip


def room_light(views: Sequence[View], plain: BoolArray) -> RoomLight:
    """Return the light that explains the pictures best, robustly.

    Args:
        views: What the pictures show.
        plain: (X,) texels of skin without lips, brows, lids and hair.
    """
    numbered, light, turned, base = _samples(views, plain)
    skin = np.median(light, axis=0)
    gains = np.ones((len(views), 3))
    harmonics = np.zeros((9, 3))
    robust = base.copy()
    for _ in range(_ROUNDS):
        aim = light / (skin * gains[numbered])
        left = (turned * robust[:, None]).T @ turned / robust.sum() + np.diag(_PULL)
        harmonics = np.linalg.solve(left, turned.T @ (robust[:, None] * aim) / robust.sum())
        shade = np.clip(turned @ harmonics, LEAST, MOST)
        gains = _gains(light / (skin * shade), numbered, robust, len(views))
        # Hair, shadows and highlights are no light on dull skin.
        off = (light / (skin * shade * gains[numbered]) - 1).mean(axis=1) / 0.16
        robust = base / (1 + off**2) ** 2
    mean = np.average(shade, axis=0, weights=robust)
    return RoomLight(harmonics / mean, gains, skin * mean, np.ones(3))


def _samples(
    views: Sequence[View], plain: BoolArray
) -> tuple[I32, FloatArray, FloatArray, FloatArray]:
    """Return picture (n,), light (n, 3), harmonics (n, 9) and weight (n,) of some texels."""
    rng = np.random.default_rng(1)
    numbers, lights, bases, weights = [], [], [], []
    for number, view in enumerate(views):
        good = np.flatnonzero(plain & (view.weight > 0.3))
        if len(good) > _SAMPLES:
            good = rng.choice(good, _SAMPLES, replace=False)
        numbers.append(np.full(len(good), number, np.int32))
        lights.append(view.light[good])
        bases.append(basis(view.normals[good]))
        weights.append(view.weight[good])
    numbered = np.concatenate(numbers)
    light = np.concatenate(lights).astype(float)
    turned = np.concatenate(bases).astype(float)
    base = np.concatenate(weights).astype(float)
    return numbered, light, turned, base


def _gains(ratio: FloatArray, number: I32, weight: FloatArray, count: int) -> FloatArray:
    """Return each picture's brightness (N, 3), 1 on average; colours differ less than levels."""
    out = np.ones((count, 3))
    for picture in range(count):
        mine = number == picture
        if mine.any():
            out[picture] = np.average(ratio[mine], axis=0, weights=weight[mine] + 1e-9)
    return np.clip(out / np.median(out, axis=0), 0.5, 2.0)


def mean_light(lights: Lights, normals: F32, wrap: FloatArray) -> FloatArray:
    """Return the light (3,) of the avatars' shaders, averaged over normals (n, 3)."""
    up = 0.5 + 0.5 * normals[:, 1:2]
    total = lights.ambient_above * (1 - up) + lights.ambient_below * up
    for direction, color in zip(lights.directions, lights.colors, strict=True):
        cosine = normals @ (direction / np.linalg.norm(direction))
        wrapped = np.clip((cosine[:, None] + wrap) / (1 + wrap), 0, 1)
        total = total + color * wrapped**2
    return np.asarray(total.mean(axis=0))
