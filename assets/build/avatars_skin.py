"""Paints the skins of the drawn characters: assets/avatars/juno.jpg and fennec.jpg.

`python -m assets.build.avatars_skin`. Everything is a function of the place on the mean head, so
that islands of the texture meet without a seam; lips and mouth come from the skin's own maps.
"""

from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np

from assets.build.textures_canvas import Canvas, canvas_of
from core.face_model import FaceModel, load_face_model
from core.landmarks import NAMES

ASSETS = Path(__file__).resolve().parents[1]
OUT = ASSETS / "avatars"
SIZE = 1024
#: Upper edge of a brow from its outer to its inner end.
BROW = ("brow_1", "brow_2", "brow_3", "brow_4", "brow_5")


def main() -> None:
    """Paint and write both skins."""
    model = load_face_model(ASSETS / "face_model.npz")
    canvas = canvas_of(model, SIZE)
    for name, paint in (("juno", juno), ("fennec", fennec)):
        picture = np.clip(np.round(paint(canvas, model)), 0, 255).astype(np.uint8)
        path = OUT / f"{name}.jpg"
        cv2.imwrite(str(path), picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 86])
        print(f"{path.name}: {path.stat().st_size // 1000} KB")


def juno(canvas: Canvas, model: FaceModel) -> np.ndarray:
    """Return smooth skin with round red cheeks and brows drawn in one stroke, (S, S, 3)."""
    spots = landmark_points(model)
    out = flat(244, 200, 172)
    cheek = [spots[f"{s}_eye_lo_mid"] * [1.25, 1, 1] + [0, 30, 2] for s in "RL"]
    blush = sum(canvas.near(place, (21, 17, 30)) for place in cheek)
    over(out, (238, 128, 112), 0.62 * blush)
    over(out, (240, 150, 128), 0.5 * canvas.near(spots["nose_tip"], (10, 9, 14)))
    over(out, (236, 184, 162), 0.25 * painted("lids"))
    for s in "RL":
        # Against the shade under large eyes.
        below = canvas.near(spots[f"{s}_eye_lo_mid"] + [0, 8, 0], (14, 7, 22))
        over(out, (255, 226, 204), 0.75 * below)
    over(out, (206, 92, 92), 0.85 * painted("lips"))
    over(out, (120, 44, 50), painted("flesh"))
    for side in "RL":
        over(out, (38, 62, 74), brow(canvas, spots, side))
    over(out, (34, 26, 30), np.clip(1.3 * painted("lashline"), 0, 1))
    over(out, (30, 74, 88), painted("scalp") ** 1.5)
    return out


def fennec(canvas: Canvas, model: FaceModel) -> np.ndarray:
    """Return fur: sand and orange above, cream below, dark round the eyes, (S, S, 3)."""
    spots = landmark_points(model)
    x, y, z = np.moveaxis(canvas.points_mm, -1, 0)
    side = np.abs(x)
    wander = 3.0 * canvas.noise(14, np.random.default_rng(3))
    out = flat(224, 138, 66)
    over(out, (176, 88, 36), 0.75 * canvas.near((0, -100, 70), (30, 90, 120)))
    over(out, (190, 104, 48), 0.5 * canvas.near((0, -6, -24), (7, 34, 20)))
    # Cream from beside the nose over the cheeks, and all below.
    edge = 34 + 0.34 * np.abs(side - 30) - 0.16 * np.minimum(side, 30) + 0.10 * z + wander
    cream = smooth((y - edge) / 7)
    cream *= np.maximum(smooth((side - 9) / 5), smooth((y - 50) / 5))
    over(out, (250, 232, 206), cream)
    for s in "RL":
        over(
            out, (252, 226, 190), 0.85 * canvas.near(spots[f"{s}_brow_4"] + [0, -4, 0], (9, 7, 14))
        )
        over(out, (92, 46, 26), 0.35 * canvas.near(spots[f"{s}_eye_inner"] + [0, 7, 0], (4, 7, 14)))
    over(out, (120, 66, 36), 0.5 * painted("lids"))
    over(out, (38, 22, 20), np.clip(1.6 * painted("lashline"), 0, 1))
    out *= fur(canvas, spots["nose_tip"])[..., None]
    line = smooth((painted("lips") - 0.3) / 0.4) * smooth((5.0 - np.abs(y - 71)) / 3)
    over(out, (70, 40, 36), line)
    over(out, (110, 40, 44), painted("flesh"))
    over(out, (46, 26, 24), canvas.near(spots["nose_tip"] + [0, 2, 0], (9, 6, 12)))
    return out


def fur(canvas: Canvas, nose_mm: np.ndarray) -> np.ndarray:
    """Return brightness (S, S) around 1 of hairs that run away from the nose."""
    reach = np.linalg.norm((canvas.points_mm - nose_mm) * [1, 1, 0.8], axis=-1)
    reach += 4 * canvas.noise(30, np.random.default_rng(5))
    dy, dx = np.gradient(cv2.GaussianBlur(reach.astype(np.float32), (0, 0), 3))
    length = np.maximum(np.hypot(dx, dy), 1e-3)
    dx, dy = (dx / length).astype(np.float32), (dy / length).astype(np.float32)
    rng = np.random.default_rng(9)
    grain = cv2.GaussianBlur(rng.normal(0, 1, dx.shape).astype(np.float32), (0, 0), 0.6)
    columns, rows = np.meshgrid(*[np.arange(len(dx), dtype=np.float32)] * 2)
    total = np.zeros_like(dx)
    for step in np.linspace(-6, 6, 13):
        total += cv2.remap(
            grain, columns + np.float32(step) * dx, rows + np.float32(step) * dy, cv2.INTER_LINEAR
        )
    locks = canvas.noise(5, rng)
    return 1 + 0.075 * np.clip(total / total.std(), -2.2, 2.2) + 0.035 * locks


def brow(canvas: Canvas, spots: dict[str, np.ndarray], side: str) -> np.ndarray:
    """Return (S, S) where one stroke lies along a brow, thin at its outer end."""
    line = [spots[f"{side}_{name}"] + [0, 0.5, 0] for name in BROW]
    widths = np.array([0.8, 2.2, 3.2, 3.6, 2.9])
    out = np.zeros(canvas.inside.shape, np.float32)
    for (a, b), (thin, thick) in zip(pairwise(line), pairwise(widths), strict=True):
        along = np.clip((canvas.points_mm - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        away = np.linalg.norm(canvas.points_mm - a - along[..., None] * (b - a), axis=-1)
        out = np.maximum(out, smooth(0.5 + (thin + along * (thick - thin) - away) / 0.9))
    return out


def flat(*color: int) -> np.ndarray:
    """Return a canvas of one colour, (S, S, 3)."""
    return np.ones((SIZE, SIZE, 3), np.float32) * np.array(color, np.float32)


def over(out: np.ndarray, color: tuple[int, int, int], share: np.ndarray) -> None:
    """Paint a colour over a picture (S, S, 3) by a share (S, S)."""
    out += np.clip(share, 0, 1)[..., None] * (np.array(color, np.float32) - out)


def painted(name: str) -> np.ndarray:
    """Return one of the skin's maps, (S, S) in [0, 1]."""
    path = ASSETS / "textures" / "skin" / f"{name}.jpg"
    picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE).astype(np.float32) / 255
    return cv2.resize(picture, (SIZE, SIZE), interpolation=cv2.INTER_AREA)


def smooth(value: np.ndarray) -> np.ndarray:
    """Return 0 below 0, 1 above 1, and a smooth step between."""
    value = np.clip(value, 0, 1)
    return value * value * (3 - 2 * value)


def landmark_points(model: FaceModel) -> dict[str, np.ndarray]:
    """Return the mean face's 60 internal landmarks in mm by name."""
    return dict(zip(NAMES, model.mean_mm[model.landmark_vertices], strict=False))


if __name__ == "__main__":
    main()
