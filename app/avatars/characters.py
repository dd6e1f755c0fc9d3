"""Drawn characters: heads of other proportions that share nothing but the coefficients."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from scipy.spatial import cKDTree

from app.avatars.build import Costume, Head, Worn, dressed
from app.avatars.drawn_eyes import DrawnEye, drawn_eye_texture
from app.avatars.looks import Color, Looks, rgb
from app.avatars.wardrobe import AvatarFileError, Wardrobe
from app.avatars.warp import EyeStyle, Push, Step, Warp, evened
from app.render.avatar import Avatar
from app.render.scene import Material
from core.arkit import EXPRESSION_NAMES
from core.face_model import FaceModel, deltas_mm, eye_centers_mm, neutral_mm
from core.landmarks import NAMES
from core.records import F32, U8, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Character:
    """A drawn character.

    Attributes:
        likeness: Share of the identity weights of the built-in person whose head is bent.
        person: Who that is.
        steps: What bends the head, in the frame of the face model's mean head.
        eyes: What becomes of the eyes.
        even: Rounds of smoothing of the skin away from eyes, nose and lips.
        looks: Lashes, hair style and shirt.
        eye: How its eyes are drawn.
        oily: Strength of the skin's highlights in [0, 1].
        worn: Makes the pieces on the bent head.
        hair: Material of hair on the scalp.
        strengths: Size of some expressions, by name without side; 1 for the others.
        extras: What some expressions move beside that, by name without side, on the bent head.
    """

    likeness: float
    person: str
    steps: Sequence[Step]
    eyes: EyeStyle
    even: int
    looks: Looks
    eye: DrawnEye
    oily: float
    worn: Callable[[Head], tuple[Worn, ...]]
    hair: Callable[[], Material] | None = None
    strengths: Mapping[str, float] = field(default_factory=dict)
    extras: Mapping[str, Push] = field(default_factory=dict)


def drawn(
    character: Character, model: FaceModel, identity: FloatArray, wardrobe: Wardrobe,
    skin: Path, name: str,
) -> Avatar:  # fmt: skip
    """Return the avatar of a character.

    Args:
        character: Who.
        model: The shipped face model.
        identity: (I,) weights of the person whose head is bent.
        wardrobe: What all avatars share.
        skin: The picture of its skin.
        name: For people.

    Raises:
        AvatarFileError: The picture cannot be read.
    """
    head = bent_head(character, model, identity)
    costume = Costume(
        skin_picture(skin, character.oily),
        drawn_eye_texture(character.eye),
        character.hair() if character.hair else None,
        character.worn(head),
    )
    return dressed(head, character.looks, wardrobe, name, costume)


def bent_head(character: Character, model: FaceModel, identity: FloatArray) -> Head:
    """Return the head of a character and its 46 expressions."""
    weights = character.likeness * identity
    neutral, deltas = neutral_mm(model, weights), deltas_mm(model, weights)
    centers = eye_centers_mm(model, neutral)
    balls = neutral[model.eyeball_vertices_right] - centers[0]
    radius = float(np.linalg.norm(balls, axis=1).mean())
    warp = Warp(character.steps, character.eyes, centers, radius)
    bent, moves = warp.head(neutral, deltas)
    skin = model.triangles[model.part_triangles("skin")]
    bent = evened(bent, skin, _free_of_features(model, neutral), character.even)
    for index, name in enumerate(EXPRESSION_NAMES):
        kind = sideless(name)
        moves[index] *= np.float32(character.strengths.get(kind, 1.0))
        if kind in character.extras:
            extra = character.extras[kind]
            moves[index] += extra.on_left(bent) if name.endswith("Left") else extra.on_right(bent)
    return Head(model, bent, moves)


def sideless(name: str) -> str:
    """Return the name of an expression without its side."""
    return name.removesuffix("Left").removesuffix("Right")


def skin_picture(path: Path, oily: float) -> U8:
    """Return a skin's texture (S, S, 4) from its picture."""
    picture = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if picture is None:
        raise AvatarFileError(path, "no picture")
    alpha = np.full((*picture.shape[:2], 1), round(255 * oily), np.uint8)
    return np.concatenate([picture[..., ::-1], alpha], axis=2)


def carried(points_mm: FloatArray, head: Head, near: int = 6) -> F32:
    """Return how a head's expressions move points (n, 3) that lie on its skin, (46, n, 3)."""
    rows = np.unique(head.model.triangles[head.model.part_triangles("skin")])
    away, found = cKDTree(head.neutral_mm[rows]).query(points_mm, near)
    weight = 1 / (away + 1.0)
    weight /= weight.sum(axis=1, keepdims=True)
    moves = np.einsum("bnkc,nk->bnc", head.deltas_mm[:, rows[found]], weight)
    return np.asarray(moves, np.float32)


def gradient_texture(first: Color, last: Color, spread: float = 0.06) -> U8:
    """Return a texture (64, 64, 4) from one colour at v = 0 to another, with faint streaks."""
    # Fur and hair are light at their tips only.
    down = np.linspace(0, 1, 64, dtype=np.float32)[:, None, None] ** 2
    across = np.arange(64) * 2 * np.pi / 64
    streaks = 1 + spread * (np.sin(3 * across) + 0.7 * np.sin(7 * across + 1))[None, :, None]
    color = (rgb(*first) * (1 - down) + rgb(*last) * down) * streaks
    picture = np.concatenate([color, np.full((64, 64, 1), 255.0)], axis=2)
    return np.asarray(np.clip(picture, 0, 255).astype(np.uint8))


def _free_of_features(model: FaceModel, neutral: FloatArray) -> FloatArray:
    """Return (V,) 0 at eyes, nose, lips, ears and the neck's edge, 1 where skin may be evened."""
    marks = dict(zip(NAMES, neutral[model.landmark_vertices], strict=False))
    places = [marks[name] for name in marks if not name.startswith(("R_brow", "L_brow", "nose_b"))]
    away = np.linalg.norm(neutral[:, None] - np.array(places), axis=2).min(axis=1)
    free = np.clip((away - 7) / 14, 0, 1)
    ears = (np.abs(neutral[:, 0]) > 66) & (np.abs(neutral[:, 1] - 22) < 44)
    ears &= np.abs(neutral[:, 2] - 82) < 26
    free[ears] = 0
    return np.asarray(free * np.clip((150 - neutral[:, 1]) / 20, 0, 1))
