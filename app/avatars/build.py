"""Puts head, looks, hair and bust together into an avatar."""

from dataclasses import dataclass, replace

import numpy as np

from app.avatars.assembly import Assembly
from app.avatars.bob import curtain
from app.avatars.bust import fitted_bust, neck_openness, neck_uv
from app.avatars.complexion import skin_texture
from app.avatars.hair import CUTS, Cut, combed, hair_mm, strands
from app.avatars.hairline import above_hairline_mm
from app.avatars.head import Surface, eye_radii_mm, lid_rows, lip_rows, surface
from app.avatars.looks import Looks
from app.avatars.pieces import Piece
from app.avatars.small_textures import cloth_texture, eye_texture, lash_texture
from app.avatars.wardrobe import Wardrobe
from app.render.avatar import Avatar, Eyes
from app.render.scene import Material, Uniforms
from core.face_model import FaceModel, eye_centers_mm
from core.records import F32, U8, FloatArray

#: Radius of the iris.
IRIS_MM = 6.0
#: Skin so far above the hairline is covered.
_COVERED_MM = 24.0
#: Where the skull turns on the neck, for the mean head.
PIVOT_MM = np.array([0.0, 62.0, 92.0])


@dataclass(frozen=True, slots=True, eq=False)
class Head:
    """The shape of one person's head.

    Attributes:
        model: Its topology.
        neutral_mm: (V, 3).
        deltas_mm: (46, V, 3).
    """

    model: FaceModel
    neutral_mm: FloatArray
    deltas_mm: F32


@dataclass(frozen=True, slots=True, eq=False)
class Worn:
    """A piece that is worn on the head.

    Attributes:
        material: How it looks.
        piece: Its mesh in the model frame.
        deltas_mm: (46, n, 3) how expressions move it; None: not at all.
    """

    material: Material
    piece: Piece
    deltas_mm: F32 | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Costume:
    """What replaces the painted looks of a person.

    Attributes:
        skin: (S, S, 4) the skin's texture: colour and oiliness.
        eye: Texture of the eyeballs, None for one by the looks.
        hair: Material of the hair on the scalp, None for strands by the looks.
        worn: Pieces on the head.
    """

    skin: U8
    eye: U8 | None = None
    hair: Material | None = None
    worn: tuple[Worn, ...] = ()


def dressed(
    head: Head, looks: Looks, wardrobe: Wardrobe, name: str, costume: Costume | None = None
) -> Avatar:
    """Return the avatar of a head with skin, eyes, hair and a shirt."""
    rng = np.random.default_rng(7)
    model, neutral = head.model, head.neutral_mm
    assembly = Assembly(neutral, head.deltas_mm, wardrobe.extra)
    skin = skin_texture(wardrobe.skin_maps, looks) if costume is None else costume.skin
    _add_skin(assembly, head, looks, wardrobe, skin)
    _add_mouth_and_lashes(assembly, model, looks, wardrobe)
    if looks.hair_style in CUTS:
        material = costume.hair if costume and costume.hair else strands(looks, rng)
        _add_hair(assembly, head, CUTS[looks.hair_style], wardrobe, material)
    for worn in costume.worn if costume else ():
        _add_worn(assembly, worn)
    centers = eye_centers_mm(model, neutral)
    radii = eye_radii_mm(model, neutral, centers)
    white = costume.eye if costume else None
    if white is None:
        white = eye_texture(looks.iris, IRIS_MM, float(radii.mean()), rng)
    ball = Material("eye", white)
    eyes = Eyes(centers, radii, lid_rows(model), (ball, ball))
    made = assembly.avatar(name, eyes, lip_rows(model), PIVOT_MM)
    return replace(made, seal=wardrobe.seal)


def _add_worn(assembly: Assembly, worn: Worn) -> None:
    """Add a piece that is worn on the head."""
    piece = worn.piece
    extra = _hair_extra(np.ones(len(piece.points_mm)))
    first = assembly.add_vertices(piece.points_mm, extra, worn.deltas_mm)
    assembly.add_surface(worn.material, piece.triangles + np.int32(first), piece.uv)


def _add_skin(
    assembly: Assembly, head: Head, looks: Looks, wardrobe: Wardrobe, texture: U8
) -> None:
    """Add the skin of head and neck and the shirt."""
    bust = wardrobe.bust
    neck_mm, shirt_mm = fitted_bust(bust, head.neutral_mm)
    ring = len(bust.ring)
    neck_extra = np.stack([bust.neck_holds, neck_openness(bust, wardrobe.extra[:, 1])], axis=1)
    first = assembly.add_vertices(neck_mm[ring:], _extra(neck_extra[ring:]))
    rows = np.concatenate([bust.ring, first + np.arange(len(neck_mm) - ring)]).astype(np.int32)
    skin = surface(head.model, "skin", "mouth")
    if looks.hair_style in CUTS:
        # What lies deep under hair is never seen.
        seen = (
            above_hairline_mm(head.model.mean_mm.astype(float))[skin.triangles].min(axis=1)
            < _COVERED_MM
        )
        skin = Surface(skin.triangles[seen], skin.uv[seen])
    material = Material("skin", texture)
    assembly.add_surface(
        material,
        np.concatenate([skin.triangles, rows[bust.neck_triangles]]),
        np.concatenate([skin.uv, neck_uv(bust, head.model)]),
    )
    first = assembly.add_vertices(shirt_mm, _extra(np.ones((len(shirt_mm), 2))))
    cloth = cloth_texture(looks.shirt, np.random.default_rng(3))
    uv = shirt_mm[bust.shirt_triangles][..., :2] / 64 + 16
    material = Material("plain", cloth, repeated=True)
    assembly.add_surface(material, bust.shirt_triangles + np.int32(first), uv.astype(np.float32))


def _add_mouth_and_lashes(
    assembly: Assembly,
    model: FaceModel,
    looks: Looks,
    wardrobe: Wardrobe,
) -> None:
    """Add teeth, tongue and lashes."""
    inside = surface(model, "teeth", "tongue")
    assembly.add_surface(
        Material("wet", wardrobe.mouth, {"gloss": wardrobe.wetness}, two_sided=True, in_mouth=True),
        inside.triangles,
        inside.uv,
    )
    if looks.lashes > 0:
        lashes = surface(model, "lashes")
        texture = lash_texture(wardrobe.lashes, looks.lashes)
        values: Uniforms = {"cutoff": 0.0, "shine": 0.1}
        material = Material("hair", texture, values, two_sided=True, blended=True)
        assembly.add_surface(material, lashes.triangles, lashes.uv)


def _add_hair(
    assembly: Assembly, head: Head, cut: Cut, wardrobe: Wardrobe, material: Material
) -> None:
    """Add the hair; the brows' muscles move the scalp a little."""
    scalp = wardrobe.scalp
    deltas = np.stack([scalp.mix @ delta for delta in head.deltas_mm]).astype(np.float32)
    uv = combed(scalp.mix @ head.neutral_mm)[scalp.triangles] * [6.0, 2.0]
    coverage = np.clip((scalp.above_mm + wardrobe.fray_mm) / 12.0, 0, 1)
    points = hair_mm(scalp, head.neutral_mm, cut)
    first = assembly.add_vertices(points, _hair_extra(coverage), deltas)
    assembly.add_surface(material, scalp.triangles + np.int32(first), uv.astype(np.float32))
    if cut.hangs:
        hanging, triangles, corner_uv, ends = curtain(points, head.neutral_mm)
        first = assembly.add_vertices(hanging, _hair_extra(ends))
        assembly.add_surface(material, triangles + np.int32(first), corner_uv)


def _hair_extra(coverage: FloatArray | F32) -> F32:
    """Return (n, 4) extra values of hair that moves with the head."""
    zero, one = np.zeros_like(coverage), np.ones_like(coverage)
    return np.stack([zero, one, coverage, zero], axis=1).astype(np.float32)


def _extra(hold_and_openness: FloatArray) -> F32:
    """Return (n, 4) extra values with nothing special to a material."""
    return np.pad(hold_and_openness, ((0, 0), (0, 2)), constant_values=1.0).astype(np.float32)
