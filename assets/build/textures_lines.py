"""Lines in the skin: wrinkles and the dark roots of the lashes."""

import cv2
import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from assets.build.textures_canvas import Canvas, stroke
from core.face_model import FaceModel
from core.landmarks import NAMES


def face_pixels(canvas: Canvas) -> tuple[cKDTree, np.ndarray]:
    """Return a tree of places on the mean face's front and their pixels (x, y)."""
    rows, columns = np.nonzero(canvas.inside)
    face = (rows < 0.56 * canvas.scale) & (rows % 2 == 0) & (columns % 2 == 0)
    face &= canvas.points_mm[rows, columns, 2] < 90
    rows, columns = rows[face], columns[face]
    return cKDTree(canvas.points_mm[rows, columns]), np.stack([columns, rows], axis=1)


def curve(points: np.ndarray, n: int = 40) -> np.ndarray:
    """Return n points of a smooth curve through points (k, 3)."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    at = np.concatenate([[0], steps.cumsum()])
    return CubicSpline(at, points)(np.linspace(0, at[-1], n))


def to_pixels(tree: cKDTree, pixels: np.ndarray, line_mm: np.ndarray) -> np.ndarray:
    """Return where a line (n, 3) near the face lies in the texture, smoothed, (n, 2) px."""
    _, near = tree.query(line_mm)
    found = pixels[near].astype(float)
    padded = np.concatenate([found[:1], found[:1], found, found[-1:], found[-1:]])
    return sum(padded[k : k + len(found)] for k in range(5)) / 5


def wrinkles(canvas: Canvas, model: FaceModel, rng: np.random.Generator) -> np.ndarray:
    """Return the furrows of an old face, 0.5 where none is, darker in, lighter beside them."""
    tree, pixels = face_pixels(canvas)
    spots = dict(zip(NAMES, model.mean_mm[model.landmark_vertices].astype(float), strict=False))
    deep = np.zeros(canvas.inside.shape, np.float32)
    for line, width, strength in furrows(spots, rng):
        stroke(deep, to_pixels(tree, pixels, line), width, strength)
    furrow = cv2.GaussianBlur(deep, (0, 0), 1.6)
    ridge = np.roll(cv2.GaussianBlur(deep, (0, 0), 4.0), -5, axis=0)
    return np.clip(0.5 - 0.75 * furrow + 0.35 * ridge, 0, 1)


def furrows(
    spots: dict[str, np.ndarray], rng: np.random.Generator
) -> list[tuple[np.ndarray, float, float]]:
    """Return lines (n, 3) in mm with a width in px and a strength."""
    out = []
    for height in (-40.0, -48.0, -56.0):
        x = np.linspace(-34, 34, 9) + rng.normal(0, 2, 9)
        y = height - 3 * np.cos(x / 34 * np.pi) + rng.normal(0, 0.8, 9)
        out.append((curve(np.column_stack([np.sort(x), y, np.full(9, -30.0)])), 2, 0.5))
    for side in "RL":
        sign = np.sign(spots[f"{side}_eye_outer"][0])
        corner = spots[f"{side}_eye_outer"]
        for rise in (-9.0, -3.0, 3.0, 9.0):
            end = corner + [sign * 17, rise * 1.5, 12]
            middle = corner + [sign * 9, rise * 0.8 + 1.0, 5]
            start = corner + [sign * 4.5, rise * 0.4, 2]
            out.append((curve(np.array([start, middle, end])), 1, 0.55))
        ala, mouth = spots[f"{side}_ala"], spots[f"{side}_mouth_corner"]
        fold = [ala + [sign * 3, -3, 3], 0.5 * (ala + mouth) + [sign * 8, -1, 2]]
        fold += [mouth + [sign * 8, 0, 2], mouth + [sign * 8, 13, 4]]
        out.append((curve(np.array(fold)), 3, 0.75))
        low, inner = spots[f"{side}_eye_lo_mid"], spots[f"{side}_eye_inner"]
        bag = [inner + [0, 5, 0], low + [-sign * 4, 8, 0], low + [sign * 9, 8, 2]]
        out.append((curve(np.array(bag)), 2, 0.6))
        frown = spots["nose_bridge_1"] + [sign * 5.5, -6, 0]
        out.append((curve(np.array([frown, frown + [sign, -7, 0], frown + [0, -14, 0]])), 2, 0.4))
    return out


def lash_line(canvas: Canvas, model: FaceModel) -> np.ndarray:
    """Return the dark rim of the lids, where the lashes grow: strong above, weak below."""
    size = canvas.scale
    holes = (~canvas.inside).astype(np.uint8)
    holes[int(0.56 * size) :] = 0
    count, labels, stats, _ = cv2.connectedComponentsWithStats(holes)
    out = np.zeros(canvas.inside.shape, np.float32)
    centers = [model.mean_mm[v] for v in model.eye_center_vertices]
    for label in range(1, count):
        place = canvas.points_mm[labels == label].mean(axis=0)
        if stats[label, cv2.CC_STAT_AREA] > 0.02 * size**2:
            continue
        if min(np.linalg.norm(place[:2] - c[:2]) for c in centers) > 14:
            continue
        away = cv2.distanceTransform((labels != label).astype(np.uint8), cv2.DIST_L2, 5)
        rows = np.arange(size)[:, None] - stats[label, 1] - 0.5 * stats[label, 3]
        upper = 1 / (1 + np.exp(rows / 4.0))
        width = 2.2 + 2.2 * upper
        out = np.maximum(out, (0.35 + 0.65 * upper) * np.exp(-((away / width) ** 2)))
    return out
