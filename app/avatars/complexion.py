"""Mixes the painted maps into the skin's texture of one person."""

from pathlib import Path

import cv2
import numpy as np

from app.avatars.looks import Looks, linear, rgb
from core.records import F32, U8

#: Oiliness of plain skin, and of lips and lid rims, in the texture's alpha.
_SKIN_GLOSS, _WET_GLOSS = 0.34, 0.75
#: Colour of what is inside the mouth and behind the lids, in people of every tone.
_FLESH = (150, 78, 72)
#: Rows mixed at a time: small enough to stay in the processor's cache.
_BAND = 16


def skin_texture(folder: Path, looks: Looks, size_px: int = 2048) -> U8:
    """Return the skin's texture, (S, S, 4) uint8: colour and oiliness.

    Args:
        folder: assets/textures/skin.
        looks: Of the person.
        size_px: S.
    """
    maps = {path.stem: _map(path, size_px) for path in sorted(folder.glob("*.jpg"))}
    out = np.empty((size_px, size_px, 4), np.uint8)
    for row in range(0, size_px, _BAND):
        band = {
            name: np.multiply(picture[row : row + _BAND], np.float32(1 / 255), dtype=np.float32)
            for name, picture in maps.items()
        }
        cv2.merge(_mixed(band, looks), out[row : row + _BAND])
    return out


def _mixed(maps: dict[str, F32], looks: Looks) -> list[U8]:
    """Return red, green, blue and oiliness (h, S) where the maps (h, S) are."""
    color = _tinted(maps, looks)
    _mix(color, linear(looks.lips), 0.92, maps["lips"])
    _mix(color, linear(_FLESH), 0.85, maps["flesh"])
    # The lips keep some of the skin's grain, in their own colour.
    grain = 0.35 * (maps["mottle"] - 0.5) + 0.32 * (maps["pores"] - 0.5)
    color *= 1 + grain + 1.2 * looks.age * (maps["wrinkles"] - 0.5)
    _paint_hair(color, maps, looks)
    gloss = _SKIN_GLOSS + 0.2 * maps["blush"] + (_WET_GLOSS - _SKIN_GLOSS) * maps["lips"]
    gloss *= (1 - 0.5 * maps["scalp"]) * (1 - 0.6 * maps["brows"]) * (0.6 + 0.8 * maps["pores"])
    np.sqrt(np.clip(color, 0, 1, out=color), out=color)
    return [_grey_levels(plane) for plane in (*color, np.clip(gloss, 0, 1, out=gloss))]


def _grey_levels(plane: F32) -> U8:
    """Return values from 0 to 1 as grey levels; the plane is changed."""
    plane *= 255
    plane += 0.5
    return plane.astype(np.uint8)


def _tinted(maps: dict[str, F32], looks: Looks) -> F32:
    """Return the bare skin (3, h, S), reddened, spotted, aged: a plane for each colour."""
    # Melanin hides blood: dark skin reddens less.
    pale = float(linear(looks.skin).mean()) ** 0.5
    blood = rgb(0.10, -0.34, -0.30) * (looks.blush * pale)
    patchy = rgb(0.06, -0.13, -0.11) * (0.8 + 1.4 * looks.age)
    bare = linear(looks.skin) * (1 - looks.age * rgb(0.02, 0.05, 0.09))
    color = np.empty((3, *maps["blush"].shape), np.float32)
    mottle = maps["mottle"] - 0.5
    for plane, *values in zip(color, bare, blood, patchy, strict=True):
        own, red, spotted = (float(value) for value in values)
        np.multiply(maps["blush"], own * red, out=plane)
        plane += own
        plane *= 1 + spotted * mottle
    _darken(color, rgb(0.10, 0.20, 0.17), maps["lids"])
    _darken(color, rgb(0.45, 0.62, 0.72) * looks.freckles, maps["freckles"])
    return color


def _paint_hair(color: F32, maps: dict[str, F32], looks: Looks) -> None:
    """Paint scalp, beard shadow, brows and the roots of the lashes over the skin."""
    if looks.hair_style != "bald":
        roots = 0.55 * linear(looks.hair) + 0.1 * linear(looks.skin)
        _mix(color, roots, 0.9, maps["scalp"])
    beard = 0.7 * linear(looks.brows) + 0.15 * linear(looks.skin) * rgb(0.7, 0.9, 1.0)
    _mix(color, beard, 0.8 * looks.beard, maps["stubble"])
    _mix(color, linear(looks.brows), 0.35 + 0.8 * looks.brow_density, maps["brows"])
    _mix(color, linear(looks.brows) * 0.3, 0.85 * looks.lashes, maps["lashline"])


def _darken(color: F32, by: F32, where: F32) -> None:
    """Take a share (3,) of each colour (3, h, S) away where a map (h, S) says so."""
    columns = _painted(where)
    for plane, share in zip(color[..., columns], by, strict=True):
        plane *= 1 - float(share) * where[:, columns]


def _mix(color: F32, other: F32, strength: float, where: F32) -> None:
    """Move colours (3, h, S) towards another by a map (h, S) times its strength, 0.95 at most."""
    columns = _painted(where)
    share = np.minimum(float(strength) * where[:, columns], np.float32(0.95))
    for plane, goal in zip(color[..., columns], other, strict=True):
        plane += share * (float(goal) - plane)


def _painted(where: F32) -> slice:
    """Return the columns in which a map (h, S) is not empty: most cover little of the skin."""
    columns = np.flatnonzero(where.any(axis=0))
    return slice(int(columns[0]), int(columns[-1]) + 1) if len(columns) else slice(0)


def _map(path: Path, size_px: int) -> U8:
    """Return a grey map at the texture's size."""
    picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if picture is None:
        raise FileNotFoundError(f"{path} is damaged: install facepuppet again")
    if len(picture) == size_px:
        return np.asarray(picture, np.uint8)
    how = cv2.INTER_AREA if len(picture) > size_px else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(picture, (size_px, size_px), interpolation=how))
