"""Draws contact sheets of the shipped face model to look at: python -m assets.build.face_sheet.

expressions.png shows all 46 expressions of one person, combinations.png usual mixtures,
identities.png twelve people, half.png the blink on its way; outsiders.png the people of
people.npz.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np

from assets.build.face_picture import Painter, View
from core.arkit import EXPRESSION_NAMES
from core.face_model import FaceModel, deltas_mm, load_face_model, neutral_mm

ASSETS = Path(__file__).resolve().parents[1]
TILE = (300, 360)
TURNED = View((0, 36, 0), 175, yaw_rad=-0.35)
WHOLE = View((0, 22, 0), 225, yaw_rad=-0.3)
EYE = View((31, 0, -10), 62, yaw_rad=-0.2)
#: Mixtures of daily life; a name without Left or Right means both.
MIXTURES: dict[str, dict[str, float]] = {
    "smile": {"mouthSmile": 0.8, "cheekSquint": 0.5},
    "laugh": {"mouthSmile": 0.9, "jawOpen": 0.45, "cheekSquint": 0.8, "eyeSquint": 0.4},
    "blink": {"eyeBlink": 1.0},
    "surprise": {"browInnerUp": 0.9, "browOuterUp": 0.9, "eyeWide": 0.8, "jawOpen": 0.5},
    "anger": {"browDown": 1.0, "noseSneer": 0.5, "mouthPress": 0.7, "eyeSquint": 0.5},
    "sadness": {"browInnerUp": 1.0, "mouthFrown": 0.8, "mouthShrugLower": 0.4},
    "disgust": {"noseSneer": 1.0, "mouthUpperUp": 0.5, "browDown": 0.5, "eyeSquint": 0.5},
    "closed lips, open jaw": {"jawOpen": 1.0, "mouthClose": 1.0},
    "aah": {"jawOpen": 0.7, "mouthLowerDown": 0.3},
    "oh": {"jawOpen": 0.45, "mouthFunnel": 0.8},
    "kiss": {"mouthPucker": 1.0},
    "ee": {"mouthSmile": 0.4, "mouthLowerDown": 0.6, "mouthUpperUp": 0.4, "mouthStretch": 0.3},
}


def weights_of(mixture: dict[str, float]) -> np.ndarray:
    """Return the (46,) coefficients of a mixture."""
    return np.array([
        mixture.get(name, mixture.get(name.removesuffix("Left").removesuffix("Right"), 0.0))
        for name in EXPRESSION_NAMES
    ])  # fmt: skip


def labelled(picture: np.ndarray, text: str) -> np.ndarray:
    """Return a picture with a caption."""
    return cv2.putText(picture, text, (6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (0, 0, 0), 1)


def sheet(tiles: list[np.ndarray], columns: int) -> np.ndarray:
    """Return pictures of one size side by side in rows."""
    tiles = tiles + [np.zeros_like(tiles[0])] * (-len(tiles) % columns)
    rows = [np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)]
    return np.vstack(rows)


def expression_tiles(
    painter: Painter, neutral: np.ndarray, deltas: np.ndarray, view: View
) -> list[np.ndarray]:
    """Return a picture of every expression of a face."""
    return [
        labelled(painter.draw(neutral + delta, view), name)
        for name, delta in zip(EXPRESSION_NAMES, deltas, strict=True)
    ]


def mixture_tiles(
    painter: Painter, neutral: np.ndarray, deltas: np.ndarray, view: View
) -> list[np.ndarray]:
    """Return a picture of every mixture on a face."""
    return [
        labelled(painter.draw(neutral + np.tensordot(weights_of(mix), deltas, 1), view), name)
        for name, mix in MIXTURES.items()
    ]


def identity_tiles(model: FaceModel, painter: Painter, count: int) -> list[np.ndarray]:
    """Return pictures of random people of the model."""
    rng = np.random.default_rng(12)
    faces = [neutral_mm(model, rng.normal(0, 1, model.n_identities)) for _ in range(count)]
    return [painter.draw(face, WHOLE) for face in faces]


def blink_tiles(model: FaceModel, painter: Painter) -> list[np.ndarray]:
    """Return pictures of blinks of several people at 0, 0.25, 0.5, 0.75 and 1."""
    rng, tiles = np.random.default_rng(4), []
    for _ in range(4):
        identity = rng.normal(0, 1, model.n_identities)
        neutral, blink = neutral_mm(model, identity), deltas_mm(model, identity)[0]
        tiles += [painter.draw(neutral + t * blink, EYE) for t in (0, 0.25, 0.5, 0.75, 1)]
    return tiles


def main() -> None:
    """Write the sheets into a folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("face_sheets"))
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    model = load_face_model(ASSETS / "face_model.npz")
    painter = Painter(model, TILE)
    identity = np.zeros(model.n_identities)
    neutral, deltas = neutral_mm(model, identity), deltas_mm(model, identity)
    with np.load(ASSETS / "people.npz") as people:
        outside = list(zip(people["neutral_mm"], people["deltas_mm"].astype(float), strict=True))
    sheets = {
        "expressions": sheet(expression_tiles(painter, neutral, deltas, TURNED), 8),
        "combinations": sheet(mixture_tiles(painter, neutral, deltas, TURNED), 6),
        "identities": sheet(identity_tiles(model, painter, 12), 6),
        "blinks": sheet(blink_tiles(model, painter), 5),
        "outsiders": sheet([t for n, d in outside for t in mixture_tiles(painter, n, d, WHOLE)], 6),
    }
    for name, picture in sheets.items():
        cv2.imwrite(str(folder / f"{name}.png"), picture[..., ::-1])
        print(folder / f"{name}.png")


if __name__ == "__main__":
    main()
