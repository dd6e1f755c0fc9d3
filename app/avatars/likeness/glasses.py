"""Finds the rims of glasses in the pictures: they stand before the skin and are none of it."""

from collections.abc import Generator, Sequence

import cv2
import numpy as np

from app.avatars.likeness.ground import Ground
from core.face_model import eye_centers_mm
from core.records import F32, BoolArray

#: Where rims can be: height over the eyes' line and half width of the face, in mm.
_ABOVE_MM, _BELOW_MM, _ASIDE_MM, _DEEP_MM = 27.0, 38.0, 76.0, 50.0
#: Lids and lashes lie nearer to the eyeball's centre than this, seen from the front.
_LIDS_MM = np.array([21.0, 14.0])
#: A rim is a dark line no wider than this, in texels of a texture of 1536, and so much darker
#: than beside it, as a logarithm.
_WIDE, _DARKER = 33, 0.3
#: Share of the texels that are rims if there are glasses (a quarter with dark ones, 0.07 at most
#: without), in so many of the first pictures, and how far around one nothing is seen.
_LEAST, _LOOKED_AT, _AROUND = 0.11, 4, 9
#: Rims are wide enough to be looked for in a smaller picture.
_SMALLER = 3


def without_rims(
    ground: Ground, albedos: Sequence[F32], weights: Sequence[F32]
) -> Generator[None, None, list[F32]]:
    """Return weights (X,) that trust no texel before which the rim of glasses is.

    Without glasses the weights are as before: lines of a face are fine or below the eyes.

    Args:
        ground: Of all pictures.
        albedos: (X, 3) of each picture.
        weights: (X,) of each picture.

    Yields:
        Nothing, after each picture.
    """
    zone, bare = _zones(ground)
    shares = []
    for albedo, weight in zip(albedos[:_LOOKED_AT], weights[:_LOOKED_AT], strict=True):
        seen = bare & (weight > 0.3)
        line = _dark_lines(ground, albedo, weight)
        shares.append((line & seen).sum() / max(int(seen.sum()), 1))
        yield
    if np.median(shares) < _LEAST:
        return list(weights)
    out = []
    for albedo, weight in zip(albedos, weights, strict=True):
        line = _dark_lines(ground, albedo, weight)
        out.append(np.asarray(weight * ~(zone & _wider(ground, line)), np.float32))
        yield
    return out


def _zones(ground: Ground) -> tuple[BoolArray, BoolArray]:
    """Return texels (X,) where rims can be, and those of them without brows and lids."""
    mean = ground.model.mean_mm.astype(float)
    x, y, z = ground.atlas.at_texels(mean).T
    zone = (y > -_ABOVE_MM) & (y < _BELOW_MM) & (np.abs(x) < _ASIDE_MM) & (z < _DEEP_MM)
    for center in eye_centers_mm(ground.model, mean):
        away = np.hypot((x - center[0]) / _LIDS_MM[0], (y - center[1]) / _LIDS_MM[1])
        zone &= away > 1
    bare = zone & (ground.maps["brows"] < 0.02) & (ground.maps["lids"] < 0.05)
    # Beside the nose's wings it is dark in every face.
    return zone, bare & ~((np.abs(x) < 24) & (y > 22))


def _dark_lines(ground: Ground, albedo: F32, weight: F32) -> BoolArray:
    """Return texels (X,) of lines that are darker than what is beside them."""
    known = weight > 0.02
    level = np.log(np.maximum(albedo.mean(axis=1), 2e-3))
    # What is not seen is no border of anything.
    level[~known] = np.median(level[known]) if known.any() else 0.0
    picture = ground.atlas.spread(level)
    last = int(ground.atlas.rows.max()) + 1
    small = cv2.resize(picture[:last], None, fx=1 / _SMALLER, fy=1 / _SMALLER,
                       interpolation=cv2.INTER_AREA)  # fmt: skip
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (_WIDE // _SMALLER, _WIDE // _SMALLER))
    lines = cv2.morphologyEx(small, cv2.MORPH_BLACKHAT, kernel)
    picture[:last] = cv2.resize(lines, (len(picture), last), interpolation=cv2.INTER_LINEAR)
    return np.asarray((ground.atlas.gathered(picture) > _DARKER) & known)


def _wider(ground: Ground, line: BoolArray) -> BoolArray:
    """Return lines (X,) with their soft edges."""
    picture = ground.atlas.spread(line.astype(np.float32))
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * _AROUND + 1, 2 * _AROUND + 1))
    return np.asarray(ground.atlas.gathered(cv2.dilate(picture, kernel)) > 0)
