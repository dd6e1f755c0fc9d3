"""Whether a texture from pictures explains the user's pictures better than painted skin."""

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from app.avatars.likeness.choice import Choice, head_angles_deg
from app.avatars.likeness.ground import Ground, Pictures
from app.avatars.likeness.light import RoomLight
from app.avatars.likeness.views import View, displayed, view_of
from app.avatars.looks import Looks
from core.records import F32, U8

#: Pictures looked at; heads turned further show too little of the face.
_PICTURES, _TURNED_DEG = 3, 40.0
#: The own texture must come this much nearer to the pictures, and cover this much of the face.
MOST_ERROR, LEAST_COVER = 0.95, 0.35


@dataclass(frozen=True, slots=True, eq=False)
class Likeness:
    """A user's own looks.

    Attributes:
        skin: (S, S, 4) texture of the skin, None where the pictures do not give a good one.
        looks: Colours, for painted skin and all else.
        report: Mean distance in levels of the own and of painted skin from pictures that the own
            was not made from, and the share of the face that pictures cover.
    """

    skin: U8 | None
    looks: Looks
    report: dict[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class Skins:
    """The own texture and the one that it must be better than.

    Attributes:
        own: (S, S, 4).
        painted: (S, S, 4).
        share: (X,) how much of the own skin is from pictures.
    """

    own: U8
    painted: U8
    share: F32


def judged(
    ground: Ground, pictures: Pictures, chosen: Choice, room: RoomLight, skins: Skins, looks: Looks
) -> Generator[None, None, Likeness]:
    """Return the likeness with the own skin if it is good, else with colours alone.

    Args:
        ground: Of all textures.
        pictures: All of the user.
        chosen: Those that the own skin was made from.
        room: Their light.
        skins: To be judged.
        looks: Of the user.

    Yields:
        Nothing, after each picture.
    """
    rows = _others(pictures, chosen)
    errors = []
    for row in rows:
        head = pictures.head(ground.model, row)
        view = view_of(pictures.images[row], head, pictures.camera, ground.atlas, ground.model)
        yield
        errors.append([_distance(ground, view, room, skin) for skin in (skins.own, skins.painted)])
        yield
    own, painted = np.mean(errors, axis=0)
    face = ground.window > 0.5
    cover = float(np.mean(skins.share[face] > 0.5))
    good = own < MOST_ERROR * painted and cover > LEAST_COVER
    report = {"own_levels": float(own), "painted_levels": float(painted), "cover": cover}
    return Likeness(skins.own if good else None, looks, report)


def _others(pictures: Pictures, chosen: Choice) -> list[int]:
    """Return rows of frontal pictures at rest that were not used, or of one that was."""
    turned = np.abs(head_angles_deg(pictures.shapes)[:, :2]).max(axis=1)
    motion = pictures.shapes.coefficients.sum(axis=1) + turned / 15
    motion[~np.isfinite(pictures.shapes.rms_px) | (turned > _TURNED_DEG)] = np.inf
    motion[[*chosen.skin, *chosen.lids]] = np.inf
    rows = [int(row) for row in motion.argsort()[:_PICTURES] if np.isfinite(motion[row])]
    return rows or [chosen.skin[0]]


def _distance(ground: Ground, view: View, room: RoomLight, skin: U8) -> float:
    """Return the mean distance in levels of a texture in the picture's light from the picture."""
    color = np.square(ground.atlas.gathered(skin[..., :3]) / 255)
    light = color * room.shade(view.normals) * room.white.astype(np.float32)
    weight = view.weight * ground.window * (view.weight > 0.3)
    gain = np.average(view.light / np.maximum(light, 1e-3), axis=0, weights=weight + 1e-9)
    off = np.abs(displayed(light * gain.astype(np.float32)) - displayed(view.light))
    return float(np.average(off.mean(axis=1), weights=weight + 1e-9))
