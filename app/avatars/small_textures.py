"""Paints the small textures of one person: eyes, teeth and tongue, lashes, cloth."""

import cv2
import numpy as np

from app.avatars.looks import Color, linear, rgb
from app.render.eyeball import EDGE_RAD
from core.records import F32, U8


def eye_texture(
    iris: Color, iris_mm: float, radius_mm: float, rng: np.random.Generator, size_px: int = 512
) -> U8:
    """Return the front view of an eyeball, (S, S, 3) uint8: veined white, iris, pupil.

    Args:
        iris: Main colour of the iris.
        iris_mm: Radius of the iris.
        radius_mm: Radius of the eyeball.
        rng: Draws veins and fibres.
        size_px: S.
    """
    axis = (np.arange(size_px) + 0.5) / size_px * 2 - 1
    x, y = np.meshgrid(axis, axis)
    angle = np.hypot(x, y) * EDGE_RAD
    turn = np.arctan2(y, x)
    reach = angle / np.arcsin(iris_mm / radius_mm)  # 1 at the rim of the iris
    white = _sclera(angle, size_px, rng)
    colored = _iris(reach, turn, linear(iris), rng)
    rim = np.clip((1.03 - reach) / 0.07, 0, 1)[..., None]
    rim = rim * rim * (3 - 2 * rim)
    color = white * (1 - rim) + colored * rim
    return np.asarray((255 * np.sqrt(np.clip(color, 0, 1)) + 0.5).astype(np.uint8))


def _sclera(angle: F32, size_px: int, rng: np.random.Generator) -> F32:
    """Return linear colours of the white: warmer and redder away from the iris, with veins."""
    far = np.clip((angle - 0.35) / 0.9, 0, 1)[..., None]
    white = rgb(0.70, 0.67, 0.645) * (1 - far) + rgb(0.60, 0.42, 0.37) * far
    veins = np.zeros((size_px, size_px), np.uint8)
    for _ in range(90):
        start, heading = rng.uniform(0, 2 * np.pi), np.pi + rng.normal(0, 0.25)
        place = np.array([np.cos(start), np.sin(start)]) * rng.uniform(0.5, 0.95)
        points = [place]
        for _ in range(int(rng.integers(6, 22))):
            heading += rng.normal(0, 0.35)
            place = place + 0.022 * np.array([np.cos(start + heading), np.sin(start + heading)])
            if np.hypot(*place) < 0.25:
                break
            points.append(place)
        pixels = np.round((np.array(points) + 1) / 2 * size_px * 16).astype(np.int32)
        cv2.polylines(veins, [pixels], False, int(rng.integers(40, 150)), 1, cv2.LINE_AA, 4)
    red = cv2.GaussianBlur(veins, (0, 0), 0.8).astype(np.float32)[..., None] / 255
    return np.asarray(white * (1 - red * rgb(0.25, 0.62, 0.6)), np.float32)


def _iris(reach: F32, turn: F32, color: F32, rng: np.random.Generator) -> F32:
    """Return linear colours of iris and pupil: fibres, a warm collar, a dark rim."""
    fibres = np.zeros_like(turn)
    for waves, share in ((23, 0.3), (47, 0.35), (83, 0.35), (131, 0.3)):
        phase, twist = rng.uniform(0, 6.28), rng.normal(0, 1.2)
        fibres += share * np.cos(waves * turn + phase + twist * reach * 2)
    patches = sum(np.cos(k * turn + rng.uniform(0, 6.28)) for k in (2, 3, 5)) / 3
    # Fibres fade towards the rim; crypts between them are dark.
    bright = 0.86 + 0.34 * fibres * (1.1 - 0.6 * reach) + 0.10 * patches
    collar = np.exp(-(((reach - 0.47 - 0.03 * fibres) / 0.11) ** 2))[..., None]
    warm = rgb(0.24, 0.14, 0.05) + color * 0.55
    out = color * bright[..., None] * (1 - 0.6 * collar) + warm * 0.6 * collar
    rim = np.clip((reach - 0.74) / 0.26, 0, 1)[..., None]
    out = out * (1 - 0.88 * rim**1.5)
    pupil = np.clip((0.36 - reach) / 0.035 + 0.5, 0, 1)[..., None]
    return np.asarray(np.clip(out, 0, 1) * (1 - pupil) + 0.003 * pupil, np.float32)


def lash_texture(coverage: U8, strength: float) -> U8:
    """Return lashes, (S, S, 4) uint8, of the painted coverage (S, S) at a strength."""
    out = np.empty((*coverage.shape, 4), np.uint8)
    out[..., :3] = (20, 15, 13)
    out[..., 3] = np.clip(coverage * (0.35 + 0.8 * strength), 0, 255)
    return out


def cloth_texture(color: Color, rng: np.random.Generator) -> U8:
    """Return knitted cloth, (256, 256, 3) uint8, to be repeated."""
    y, x = np.mgrid[0:256, 0:256]
    knit = 0.93 + 0.05 * np.cos(x * 2 * np.pi / 4) * np.cos(y * 2 * np.pi / 4)
    grain = rng.normal(1, 0.025, (256, 256))
    picture = rgb(*color) * (knit * grain)[..., None]
    return np.asarray(np.clip(picture, 0, 255).astype(np.uint8))
