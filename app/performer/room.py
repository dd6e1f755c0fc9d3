"""The room behind the performer, painted by procedure and out of focus."""

import cv2
import numpy as np

from core.records import F32, U8

#: The painting is larger than the picture so that a shaken camera still sees wall.
_PAINT_SIZE = (960, 720)


def paint_room(size_px: tuple[int, int], seed: int, blur_px: float = 3.0) -> U8:
    """Return (H, W, 3) a room: wall, window with daylight, shelf with books, picture, plant.

    Args:
        size_px: (width, height).
        seed: The same seed paints the same room.
        blur_px: Standard deviation of the defocus in the picture.
    """
    rng = np.random.default_rng([seed, 31])
    canvas = _wall(rng)
    mirrored = bool(rng.random() < 0.5)
    _window(canvas, rng)
    _shelf(canvas, rng)
    _picture(canvas, rng)
    _plant(canvas, rng)
    canvas = canvas[:, ::-1] if mirrored else canvas
    small = cv2.resize(np.ascontiguousarray(canvas), size_px, interpolation=cv2.INTER_AREA)
    blurred = cv2.GaussianBlur(small, (0, 0), blur_px)
    return np.asarray(np.clip(255 * blurred, 0, 255).astype(np.uint8))


def _wall(rng: np.random.Generator) -> F32:
    """Return (H, W, 3) a wall in [0, 1], darker towards one side and the floor, with mottle."""
    width, height = _PAINT_SIZE
    tint = np.array([0.68, 0.65, 0.6]) * rng.uniform(0.75, 1.05) + rng.normal(0, 0.02, 3)
    across = np.linspace(1.1, 0.72, width)[None, :, None]
    down = np.linspace(1.05, 0.85, height)[:, None, None]
    mottle = cv2.resize(rng.normal(0, 1, (12, 16)).astype(np.float32), _PAINT_SIZE)
    wall = tint * across * down * (1 + 0.02 * mottle[..., None])
    return np.asarray(np.clip(wall, 0, 1), np.float32)


def _window(canvas: F32, rng: np.random.Generator) -> None:
    """Paint a bright window with a frame, sky, far trees and a curtain into the canvas."""
    x0, y0 = int(rng.uniform(30, 90)), int(rng.uniform(40, 80))
    x1, y1 = x0 + int(rng.uniform(190, 240)), y0 + int(rng.uniform(300, 360))
    canvas[y0 - 14 : y1 + 14, x0 - 14 : x1 + 14] = (0.86, 0.85, 0.82)
    rows = np.linspace(0, 1, y1 - y0, dtype=np.float32)[:, None, None]
    sky = (1 - rows) * np.array([0.78, 0.88, 0.98]) + rows * np.array([0.97, 0.97, 0.94])
    pane = np.repeat(sky, x1 - x0, axis=1).astype(np.float32)
    for _ in range(26):
        center = (int(rng.integers(0, x1 - x0)), int((y1 - y0) * rng.uniform(0.72, 1.0)))
        leaf = np.array([0.42, 0.53, 0.33]) * rng.uniform(0.7, 1.2)
        cv2.circle(pane, center, int(rng.integers(14, 40)), leaf.tolist(), -1)
    canvas[y0:y1, x0:x1] = pane
    middle = (x0 + x1) // 2
    canvas[y0:y1, middle - 6 : middle + 6] = (0.82, 0.81, 0.79)
    folds = 0.8 + 0.12 * np.sin(np.linspace(0, 26, 70))
    curtain = folds[None, :, None] * np.array([0.75, 0.62, 0.5])
    canvas[y0 - 14 : y1 + 60, x1 + 4 : x1 + 74] = curtain


def _shelf(canvas: F32, rng: np.random.Generator) -> None:
    """Paint two boards with books into the canvas."""
    left, right = 640, 930
    for bottom in (250, 430):
        x = left + 8
        while x < right - 30:
            if rng.random() < 0.12:
                x += int(rng.integers(15, 45))
                continue
            thick, tall = int(rng.integers(12, 30)), int(rng.integers(80, 135))
            hue = np.array([[[rng.uniform(0, 360), rng.uniform(0.15, 0.6), 1.0]]], np.float32)
            color = cv2.cvtColor(hue, cv2.COLOR_HSV2RGB)[0, 0] * rng.uniform(0.25, 0.7)
            canvas[bottom - tall : bottom, x : x + thick] = color
            canvas[bottom - tall + 14 : bottom - tall + 20, x : x + thick] = color * 1.5
            x += thick + 1
        canvas[bottom : bottom + 14, left:right] = (0.42, 0.3, 0.2)
        canvas[bottom + 14 : bottom + 34, left:right] *= 0.75


def _picture(canvas: F32, rng: np.random.Generator) -> None:
    """Paint a framed picture between window and shelf into the canvas."""
    x, y = int(rng.uniform(430, 470)), int(rng.uniform(60, 100))
    canvas[y : y + 130, x : x + 110] = (0.15, 0.13, 0.12)
    small = rng.uniform(0.3, 0.8, (4, 3, 3)).astype(np.float32)
    canvas[y + 8 : y + 122, x + 8 : x + 102] = cv2.resize(small, (94, 114))


def _plant(canvas: F32, rng: np.random.Generator) -> None:
    """Paint a pot plant on the floor side into the canvas."""
    foot = np.array([int(rng.uniform(690, 880)), 640])
    for _ in range(40):
        tip = foot + np.array([rng.normal(0, 55), -rng.uniform(40, 190)])
        green = np.array([0.2, 0.36, 0.16]) * rng.uniform(0.6, 1.5)
        cv2.line(canvas, foot.tolist(), tip.astype(int).tolist(), green.tolist(), 7)
    x, y = foot
    canvas[y - 10 : y + 80, x - 40 : x + 40] = (0.55, 0.32, 0.22)
