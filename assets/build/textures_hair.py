"""Hair painted on the skin: brows, the shadow of a beard, the scalp."""

import cv2
import numpy as np

from app.avatars.hairline import above_hairline_mm
from assets.build.textures_canvas import Canvas, stroke
from assets.build.textures_lines import curve, face_pixels, to_pixels
from core.face_model import FaceModel
from core.landmarks import NAMES


def scalp(canvas: Canvas, rng: np.random.Generator) -> np.ndarray:
    """Return where hair grows on the head, thinning out at the hairline."""
    above = above_hairline_mm(canvas.points_mm) + 1.0 * canvas.noise(12.0, rng)
    out = np.clip((above + 1) / 12.0, 0, 1)
    grain = cv2.GaussianBlur(rng.normal(0, 1, out.shape).astype(np.float32), (0, 0), 1.2)
    # Ruled by chance only where the hair thins out.
    out = np.clip(out + 1.6 * out * (1 - out) * grain / grain.std(), 0, 1)
    out[int(0.56 * canvas.scale) :] = 0
    return np.asarray(out, np.float32)


def stubble(
    canvas: Canvas, spots: dict[str, np.ndarray], lips: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Return the density of beard hair: upper lip, chin, jaw and sideburns, in fine dots."""
    x, y, z = np.moveaxis(canvas.points_mm, -1, 0)
    mouth_y, nose_y = spots["lip_up_mid"][1], spots["subnasale"][1]
    # The upper edge runs from under the nose along the cheek up to the ear.
    edge = nose_y + 3 + 6 * np.exp(-((x / 7.0) ** 2)) * 0
    edge = (
        edge + np.clip((np.abs(x) - 18) / 12, 0, 1) * 24 - np.clip((np.abs(x) - 50) / 22, 0, 1) * 55
    )
    field = 1 / (1 + np.exp(-(y - edge) / 2.6))
    field *= 1 / (1 + np.exp((y - 118) / 7)) / (1 + np.exp((z - 62) / 6))
    field *= 1 - np.clip(1.6 * lips, 0, 1)
    field *= 1 - 0.75 * canvas.near([0, mouth_y + 23, -25], (9, 4, 30))
    dots = np.clip(0.55 + 0.33 * rng.normal(0, 1, x.shape), 0, 1)
    field[int(0.56 * canvas.scale) :] = 0
    return np.asarray(field * dots, np.float32)


def brows(canvas: Canvas, model: FaceModel, rng: np.random.Generator) -> np.ndarray:
    """Return both brows, hair by hair: upright at the nose, lying down towards the temple."""
    tree, pixels = face_pixels(canvas)
    spots = dict(zip(NAMES, model.mean_mm[model.landmark_vertices].astype(float), strict=False))
    out = np.zeros(canvas.inside.shape, np.float32)
    shade = np.zeros_like(out)
    for side in "RL":
        top = np.array([spots[f"{side}_brow_{k}"] for k in (5, 4, 3, 2, 1)])
        middle = top + np.array([[0, 3.2, 0], [0, 3.0, 0], [0, 2.6, 0], [0, 1.6, 0], [0, 0.2, 0]])
        line_px = to_pixels(tree, pixels, curve(middle, 200))
        frame = np.gradient(line_px, axis=0)
        for k in range(0, 190, 4):
            stroke(shade, line_px[k : k + 6], 1.7 * half_width_px(k / 199), 1.0)
        for _ in range(620):
            add_brow_hair(out, line_px, frame, rng)
    shade = cv2.GaussianBlur(shade, (0, 0), 3.5)
    return np.clip(out * 0.9 + 0.38 * shade, 0, 1)


def half_width_px(at: float) -> float:
    """Return half the width of a brow, `at` from its inner (0) to its outer end (1)."""
    return 9.5 * min(1.0, 0.6 + 2.6 * at) * (1 - at) ** 0.6 + 0.6


def add_brow_hair(
    out: np.ndarray, line_px: np.ndarray, frame: np.ndarray, rng: np.random.Generator
) -> None:
    """Draw one hair at a random place of the brow's middle line (n, 2), inner end first."""
    at = rng.beta(1.1, 1.3)
    index = int(at * (len(line_px) - 1))
    along = frame[index] / (np.linalg.norm(frame[index]) + 1e-9)
    up = np.array([along[1], -along[0]])
    up = up if up[1] < 0 else -up
    half = half_width_px(at)
    offset = rng.uniform(-1, 1) * half
    # Hairs at the upper edge lie flatter and sink towards the ridge; lower ones rise to it.
    rise = 1.3 * (1 - at) ** 2.2 + 0.12 - 0.4 * min(2 * at, 1) * offset / half
    direction = along + rise * up
    direction /= np.linalg.norm(direction)
    length = rng.uniform(10, 17) * (0.7 + 0.5 * (1 - at))
    start = line_px[index] + up * offset - 0.45 * length * direction
    bend = along * rng.uniform(0, 0.2) * length
    steps = np.linspace(0, 1, 6)[:, None]
    line = start + steps * length * direction + steps**2 * bend
    stroke(out, line, rng.uniform(0.8, 1.4), rng.uniform(0.45, 0.95))
