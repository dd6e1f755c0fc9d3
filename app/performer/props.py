"""Everything that a performer wears or holds beside the clothes, placed in each picture."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.avatars.build import Head
from app.avatars.hair import strands
from app.avatars.looks import Color, Looks
from app.avatars.small_textures import cloth_texture
from app.avatars.wardrobe import Wardrobe
from app.performer.cap import cap_mesh, knit
from app.performer.conditions import CUP, FRINGE, GLASSES, HAND, HAND_EYE, MICROPHONE, STROKE
from app.performer.cup import cup_material, cup_solid, cup_to_camera
from app.performer.events import held_share, stroke_share
from app.performer.glasses import frame_and_lenses, frame_material, lens_material
from app.performer.growth import fringe
from app.performer.hand import (
    AT_EYE_MM,
    AT_LIPS_MM,
    AT_NOSE_MM,
    hand_skin,
    hand_solid,
    hand_to_camera,
    sleeve_solid,
)
from app.performer.microphone import body_material, grille_material, microphone
from app.performer.people import CAST, Person
from app.performer.posture import Posture
from app.performer.shapes import Solid, mesh_of
from app.render.renderer import Item, Renderer
from app.render.scene import Material, Mesh
from core.face_model import FaceModel, eye_centers_mm
from core.landmarks import NAMES
from core.records import FloatArray

#: Where something is in the camera frame (4, 4), by posture and time in the take.
Placing = Callable[[Posture, float], FloatArray]


def on_head(posture: Posture, time_s: float) -> FloatArray:
    """Return the place of what follows the head."""
    return posture.head_to_camera


def on_body(posture: Posture, time_s: float) -> FloatArray:
    """Return the place of what follows the body."""
    return posture.body_to_camera


@dataclass(frozen=True, slots=True, eq=False)
class Prop:
    """A thing and where it is.

    Attributes:
        mesh: Its shape, in the frame that is placed.
        material: How it looks.
        placing: Where that frame is.
    """

    mesh: Mesh
    material: Material
    placing: Placing


class Props:
    """Things on the graphics card."""

    def __init__(self, renderer: Renderer, props: list[Prop]) -> None:
        self._things = [(renderer.upload(p.mesh, p.material), p.placing) for p in props]

    def items(self, posture: Posture, time_s: float) -> list[Item]:
        """Return what to draw."""
        out = []
        for drawable, placing in self._things:
            place = placing(posture, time_s)
            out.append(Item(drawable, place, place))
        return out


def props_of(
    model: FaceModel, person: Person, wardrobe: Wardrobe, conditions: tuple[str, ...]
) -> list[Prop]:
    """Return what a person wears and holds under the given conditions."""
    role = CAST[person.name]
    out = [] if role.cap is None else [_cap(role.cap, role.row, person, wardrobe, model)]
    if GLASSES in conditions:
        frame, lenses = frame_and_lenses(model, person.neutral_mm)
        out += [_still(frame, frame_material()), _still(lenses, lens_material())]
    if FRINGE in conditions:
        out.append(_fringe(Head(model, person.neutral_mm, person.deltas_mm), wardrobe, role.looks))
    if MICROPHONE in conditions:
        grille, rest = microphone(lips_mm(model, person))
        out += [
            Prop(mesh_of(grille), grille_material(), on_body),
            Prop(mesh_of(rest), body_material(), on_body),
        ]
    lips = lips_mm(model, person)
    places = {
        HAND: (lips + AT_LIPS_MM, held_share),
        HAND_EYE: (eye_centers_mm(model, person.neutral_mm)[0] + AT_EYE_MM, held_share),
        STROKE: (lips + AT_NOSE_MM, stroke_share),
    }
    for name, (place_mm, share) in places.items():
        if name in conditions:
            out += _hand(place_mm, share, role.looks)
    if CUP in conditions:
        out.append(_cup(lips))
    return out


def lips_mm(model: FaceModel, person: Person) -> FloatArray:
    """Return the middle of the person's lips (3,), model frame."""
    rows = [model.landmark_vertices[NAMES.index(n)] for n in ("lipin_up_mid", "lipin_lo_mid")]
    return np.asarray(person.neutral_mm[rows].mean(axis=0))


def _cap(color: Color, seed: int, person: Person, wardrobe: Wardrobe, model: FaceModel) -> Prop:
    mesh = cap_mesh(wardrobe.scalp, person.neutral_mm, model.mean_mm)
    return Prop(mesh, knit(color, np.random.default_rng(seed)), on_head)


def _still(solid: Solid, material: Material) -> Prop:
    return Prop(mesh_of(solid), material, on_head)


def _fringe(head: Head, wardrobe: Wardrobe, looks: Looks) -> Prop:
    solid, coverage = fringe(head, wardrobe)
    material = strands(looks, np.random.default_rng(29))
    return Prop(mesh_of(solid, coverage), material, on_head)


def _hand(place_mm: FloatArray, share: Callable[[float], float], looks: Looks) -> list[Prop]:
    rng = np.random.default_rng(41)

    def placing(posture: Posture, time_s: float) -> FloatArray:
        return hand_to_camera(posture.head_to_camera, place_mm, share(time_s))

    cloth = Material("plain", cloth_texture(looks.shirt, rng), two_sided=True, repeated=True)
    return [
        Prop(mesh_of(hand_solid()), hand_skin(looks.skin, rng), placing),
        Prop(mesh_of(sleeve_solid()), cloth, placing),
    ]


def _cup(lips: FloatArray) -> Prop:
    def placing(posture: Posture, time_s: float) -> FloatArray:
        return cup_to_camera(posture.head_to_camera, lips, held_share(time_s))

    return Prop(mesh_of(cup_solid()), cup_material(), placing)
