"""A user's own looks from the pictures of the setup."""

from collections.abc import Generator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import cv2
import numpy as np

from app.avatars.complexion import skin_texture
from app.avatars.likeness.atlas import make_atlas
from app.avatars.likeness.blend import (
    agreed_weights,
    agreeing,
    edge_padded,
    joined,
    toning,
)
from app.avatars.likeness.choice import choose, sharpness
from app.avatars.likeness.colors import Frontal, as_color, hair_of, iris_of, white_of_eyes
from app.avatars.likeness.glasses import without_rims
from app.avatars.likeness.ground import Ground, Pictures, lay_ground
from app.avatars.likeness.judge import Likeness, Skins, judged
from app.avatars.likeness.light import RoomLight, mean_light, room_light
from app.avatars.likeness.surroundings import at_vertices
from app.avatars.likeness.tone import light_of_skin
from app.avatars.likeness.views import Posed, View, view_of
from app.avatars.looks import Looks
from app.render.scene import DEFAULTS, studio_lights
from core.face_model import FaceModel
from core.records import F32, U8, BoolArray, FloatArray, Progress

T = TypeVar("T")
LABEL = "Making your own avatar"
#: Pictures whose hair and eyes are looked at: the most frontal ones.
_FRONTAL = 4
#: Vertices with so little weight are not shown; the width over which they fade in.
_LEAST_SHARE, _SHARE_FADE = 0.12, 0.3
#: With less of the face's plain skin seen, nothing is made.
_LEAST_PLAIN = 0.05
#: Share of painted skin's oiliness that skin from pictures lacks.
_GLOSS_OFF = 0.4


def make_likeness(
    model: FaceModel, pictures: Pictures, skin_maps: Path
) -> Generator[Progress, None, Likeness | None]:
    """Return a user's own looks; None if no picture shows the face well.

    Args:
        model: The shipped face model.
        pictures: What to make it from.
        skin_maps: assets/textures/skin.

    Yields:
        Progress.
    """
    sharp = yield from _told(_sharpnesses(pictures.images), 0, 1)
    chosen = choose(sharp, pictures.landmarks, pictures.shapes)
    if not chosen.skin:
        return None
    ground = lay_ground(model, skin_maps)
    rows = (*chosen.skin, *chosen.lids)
    total = len(rows) + 3
    heads, views = [], []
    for done, row in enumerate(rows):
        yield Progress(done, total, LABEL)
        heads.append(pictures.head(model, row))
        views.append(view_of(pictures.images[row], heads[-1], pictures.camera, ground.atlas, model))
    if not any(_enough(ground, view.weight > 0.3) for view in views):
        return None
    room = room_light(views, ground.plain)
    frontal = _frontal(pictures, chosen.skin[:_FRONTAL], heads)
    room = replace(room, white=_white(ground, room, frontal))
    own, share = yield from _told(
        _own_albedo(ground, views, room, len(chosen.skin)), len(rows), total
    )
    if not _enough(ground, share > 0.5):
        return None
    looks = _looks(ground, frontal, room, own, share)
    yield Progress(len(rows) + 1, total, LABEL)
    painted = skin_texture(skin_maps, looks, ground.atlas.size_px)
    yield Progress(len(rows) + 1, total, LABEL)
    skins = Skins(_texture(ground, own, share, painted), painted, share)
    judging = judged(ground, pictures, chosen, room, skins, looks)
    return (yield from _told(judging, len(rows) + 2, total))


def _told(steps: Generator[None, None, T], done: int, total: int) -> Generator[Progress, None, T]:
    """Run steps and tell each time how much is done; return what they return."""
    while True:
        yield Progress(done, total, LABEL)
        try:
            next(steps)
        except StopIteration as end:
            # What a generator returns has no type here.
            return end.value  # type: ignore[no-any-return]


def _sharpnesses(images: Sequence[U8]) -> Generator[None, None, list[float]]:
    out = []
    for image in images:
        out.append(sharpness(image))
        yield
    return out


def _enough(ground: Ground, seen: BoolArray) -> bool:
    """Return whether a good part of the face's plain skin is among texels (X,) that are seen."""
    return bool((ground.plain & seen).sum() > _LEAST_PLAIN * ground.plain.sum())


def _white(ground: Ground, room: RoomLight, seen: Frontal) -> FloatArray:
    """Return the light (3,) that a white surface of the face sends in the pictures' mean light.

    At first it is taken to be as strong as the avatars' studio: the avatar is then as bright and
    as coloured as the user in the pictures. What is unlikely for skin and eyes is taken off.
    """
    normals = seen.heads[0].normals
    shown = ground.face_vertices & (normals[:, 2] < -0.35)
    wrap = np.asarray(DEFAULTS["skin"]["wrap"], float)
    studio = mean_light(studio_lights(), normals[shown], wrap)
    white = white_of_eyes(seen, ground.model)
    return studio * light_of_skin(room.skin / studio, None if white is None else white / studio)


def _own_albedo(
    ground: Ground, views: Sequence[View], room: RoomLight, n_skin: int
) -> Generator[None, None, tuple[F32, F32]]:
    """Return what the pictures show without their light, (X, 3), and where they do, (X,)."""
    lids = ground.maps["lids"]
    albedos, weights = [], []
    for number, view in enumerate(views):
        albedos.append(room.albedo(view.light, view.normals, number))
        # The skin of the lids is seen when eyes are shut; nothing else is taken from there.
        only = lids if number >= n_skin else 1 - 0.97 * lids * (len(views) > n_skin)
        # The first pictures are the frontal ones at rest.
        weight = view.weight * ground.window * only / (1 + 0.12 * number)
        weights.append(np.asarray(weight, np.float32))
        yield
    weights = yield from without_rims(ground, albedos, weights)
    weights = yield from agreed_weights(albedos, weights, ground.atlas)
    albedos = yield from agreeing(ground, albedos, weights)
    own = yield from joined(albedos, weights, ground.atlas)
    return own, _shown_share(ground, own, np.max(weights, axis=0))


def _shown_share(ground: Ground, own: F32, weight: F32) -> F32:
    """Return where the own skin is shown, (X,): soft at its edges, without hair on the forehead."""
    atlas = ground.atlas
    skin = np.median(own[ground.plain & (weight > 0.3)], axis=0)
    off = np.log(np.maximum(own, 2e-3) / skin)
    level = off.mean(axis=1)
    tint = np.abs(off - level[:, None]).max(axis=1)
    strange = (level < -0.5) | ((tint > 0.25) & (level < 0))
    hair = strange * ground.near_hair
    _, seen = at_vertices(atlas, own, weight)
    haired = at_vertices(atlas, hair[:, None].astype(np.float32), np.ones_like(weight))[0]
    good = np.clip((seen - _LEAST_SHARE) / _SHARE_FADE, 0, 1) * np.clip(1 - 3 * haired[:, 0], 0, 1)
    soft = np.clip(2 * ground.mesh.softened(good, 3) - 1, 0, 1)
    share = atlas.at_texels(soft) * np.clip(weight / 0.05, 0, 1)
    share = share * (1 - ground.maps["flesh"]) * ground.window
    return np.asarray(share * (1 - 0.9 * ground.maps["lashline"]), np.float32)


def _frontal(pictures: Pictures, rows: Sequence[int], heads: Sequence[Posed]) -> Frontal:
    """Return the pictures of some rows, whose heads come first."""
    images = [pictures.images[row] for row in rows]
    marks = [pictures.landmarks[row] for row in rows]
    return Frontal(images, heads[: len(rows)], marks, pictures.camera)


def _looks(ground: Ground, seen: Frontal, room: RoomLight, own: F32, share: F32) -> Looks:
    """Return the colours of the user."""
    tone = np.median(own[ground.plain & (share > 0.5)], axis=0).astype(float)
    hair = hair_of(seen, room, ground.model, tone)
    iris = iris_of(seen, ground.model, room.white)
    lips = own[(ground.maps["lips"] > 0.7) & (share > 0.5)]
    brows = own[(ground.maps["brows"] > 0.4) & (share > 0.5)]
    looks = Looks(skin=as_color(tone), hair=hair.color, hair_style=hair.style, freckles=0.0,
                  blush=0.3, lashes=0.6)  # fmt: skip
    if len(lips):
        looks = looks.changed(lips=as_color(np.median(lips, axis=0)))
    if len(brows):
        looks = looks.changed(brows=as_color(np.quantile(brows, 0.25, axis=0)))
    return looks if iris is None else looks.changed(iris=iris)


def _texture(ground: Ground, own: F32, share: F32, painted: U8) -> U8:
    """Return the texture (S, S, 4): the own skin and, beyond it, painted skin in its tone."""
    atlas = ground.atlas
    color = np.square(atlas.gathered(painted[..., :3]) / 255)
    found, kept = toning(ground, own, color, share)
    # Smooth, so a small picture of it is enough.
    small = make_atlas(ground.model, len(painted) // 4)
    tone = edge_padded(small.spread(np.exp(small.at_texels(kept))), small, 3)
    tone[tone[..., 0] == 0] = np.exp(kept.mean(axis=0))
    whole = np.square(painted[..., :3].astype(np.float32) / 255)
    whole *= cv2.resize(tone, painted.shape[:2], interpolation=cv2.INTER_LINEAR)
    toned = atlas.gathered(whole)
    own = own * np.exp(atlas.at_texels(kept - found))
    whole[atlas.rows, atlas.columns] = toned + share[:, None] * (own - toned)
    out = painted.copy()
    out[..., :3] = 255 * np.sqrt(np.clip(whole, 0, 1)) + 0.5
    # Pictures of skin hold some of its gloss already.
    gloss = atlas.gathered(painted[..., 3]) * (1 - _GLOSS_OFF * share)
    out[atlas.rows, atlas.columns, 3] = gloss.astype(np.uint8)
    return out
