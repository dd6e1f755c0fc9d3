"""Mixes the painted maps into the skin's texture of one person."""

from pathlib import Path

import cv2
import numpy as np

from app.avatars.looks import Color, Looks
from core.records import F32, U8

#: Oiliness of plain skin, and of lips and lid rims, in the texture's alpha.
_SKIN_GLOSS, _WET_GLOSS = 0.42, 0.75


def skin_texture(folder: Path, looks: Looks, size_px: int = 2048) -> U8:
    """Return the skin's texture, (S, S, 4) uint8: colour and oiliness.

    Args:
        folder: assets/textures/skin.
        looks: Of the person.
        size_px: S.
    """
    maps = {path.stem: _grey(path, size_px) for path in sorted(folder.glob("*.jpg"))}
    color = np.empty((size_px, size_px, 3), np.float32)
    color[:] = _linear(looks.skin)
    _tint(color, maps, looks)
    lips = maps["lips"] * 0.92
    _mix(color, _linear(looks.lips), lips)
    # The lips keep some of the skin's texture, in their own colour.
    color *= (1 + 0.5 * (maps["mottle"] - 0.5) + 0.16 * (maps["pores"] - 0.5) * 2)[..., None]
    color *= (1 + 1.1 * looks.age * (maps["wrinkles"] - 0.5) * 1.1)[..., None]
    _paint_hair(color, maps, looks)
    gloss = _SKIN_GLOSS + 0.2 * maps["blush"] + (_WET_GLOSS - _SKIN_GLOSS) * maps["lips"]
    gloss *= (1 - 0.5 * maps["scalp"]) * (1 - 0.6 * maps["brows"])
    gloss *= 0.8 + 0.8 * (maps["pores"] - 0.25)
    out = np.concatenate([np.sqrt(np.clip(color, 0, 1)), gloss[..., None]], axis=-1)
    return np.asarray(np.clip(255 * out + 0.5, 0, 255).astype(np.uint8))


def _tint(color: F32, maps: dict[str, F32], looks: Looks) -> None:
    """Redden, spot and age the bare skin."""
    # Melanin hides blood: dark skin reddens less.
    pale = float(np.mean(_linear(looks.skin))) ** 0.5
    blood = np.float32([0.10, -0.34, -0.30]) * (looks.blush * pale)
    color *= 1 + maps["blush"][..., None] * blood
    color *= 1 + (maps["mottle"] - 0.5)[..., None] * np.float32([0.10, -0.20, -0.18]) * (
        0.8 + 1.4 * looks.age
    )
    color *= 1 - maps["lids"][..., None] * np.float32([0.10, 0.20, 0.17])
    color *= 1 - (looks.freckles * maps["freckles"])[..., None] * np.float32([0.45, 0.62, 0.72])
    if looks.age > 0:
        sallow = 1 - looks.age * np.float32([0.02, 0.05, 0.09])
        color *= sallow


def _paint_hair(color: F32, maps: dict[str, F32], looks: Looks) -> None:
    """Paint scalp, beard shadow, brows and the roots of the lashes over the skin."""
    hair = _linear(looks.hair)
    if looks.hair_style != "bald":
        _mix(color, 0.55 * hair + 0.1 * _linear(looks.skin), 0.93 * maps["scalp"])
    beard = 0.6 * _linear(looks.brows) + 0.08
    _mix(color, beard, 0.62 * looks.beard * maps["stubble"])
    _mix(color, _linear(looks.brows), np.clip(maps["brows"] * (0.35 + looks.brow_density), 0, 0.93))
    _mix(color, _linear(looks.brows) * 0.35, 0.85 * looks.lashes * maps["lashline"])


def _mix(color: F32, other: F32, share: F32) -> None:
    """Move colours (S, S, 3) towards another by a share (S, S)."""
    color += share[..., None] * (other.astype(np.float32) - color)


def _linear(color: Color) -> F32:
    """Return the linear value of a displayed colour; our gamma is 2."""
    return np.square(np.float32(color) / 255)


def _grey(path: Path, size_px: int) -> F32:
    """Return a map in [0, 1] at the texture's size."""
    picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if picture is None:
        raise FileNotFoundError(f"{path} is damaged; install facepuppet again")
    if len(picture) != size_px:
        shrinks = len(picture) > size_px
        how = cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC
        picture = cv2.resize(picture, (size_px, size_px), interpolation=how)
    return picture.astype(np.float32) / 255
