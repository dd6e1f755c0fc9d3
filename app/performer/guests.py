"""Other people in the performer's room: passing by, leaning in, on a poster."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from app.avatars.build import Head, dressed
from app.avatars.wardrobe import Wardrobe
from app.performer.conditions import NEIGHBOUR, PASSER, POSTER
from app.performer.events import passing_mm, visit_share
from app.performer.people import CAST, Person
from app.performer.posture import Posture, posture_of
from app.performer.takes import Moment
from app.render.puppet import Puppet
from app.render.renderer import Item, Renderer, Scene
from app.render.scene import Lights, View
from core.arkit import EXPRESSION_NAMES
from core.camera import camera_for
from core.face_model import FaceModel
from core.records import U8, FloatArray

#: Eyes of who passes by, between the performer and the webcam, and how far the head turns to it.
_PASSING_AT_MM, _PASSING_YAW_RAD = np.array([0.0, -45.0, 430.0]), 0.6
#: Of who leans in: there, and as far to the side before; nearer to the webcam than the performer.
_NEIGHBOUR_AT_MM, _NEIGHBOUR_WAY_MM = np.array([205.0, -20.0, 505.0]), np.array([330.0, 60.0, 0.0])
#: The poster's place in the picture and its size, in parts of the picture's width.
_POSTER_AT, _POSTER_SIZE = (0.72, 0.06), (0.25, 0.32)
_STILL = np.zeros(len(EXPRESSION_NAMES)), np.zeros((2, 2))


@dataclass(frozen=True, slots=True)
class Guests:
    """Another person on the graphics card, as often as the conditions ask for.

    Attributes:
        conditions: What they do.
        puppet: The person.
    """

    conditions: Sequence[str]
    puppet: Puppet

    def items(self, time_s: float) -> list[Item]:
        """Return what to draw; somebody out of the picture is there, too."""
        if PASSER in self.conditions:
            place = _PASSING_AT_MM + [passing_mm(time_s), 0, 0]
            return self._items(_posture(place, _PASSING_YAW_RAD))
        if NEIGHBOUR in self.conditions:
            place = _NEIGHBOUR_AT_MM + (1 - visit_share(time_s)) * _NEIGHBOUR_WAY_MM
            return self._items(_posture(place, 0.15))
        return []

    def _items(self, posture: Posture) -> list[Item]:
        return self.puppet.items(*_STILL, posture.head_to_camera, posture.body_to_camera)


def guests_for(
    renderer: Renderer, model: FaceModel, person: Person, wardrobe: Wardrobe,
    conditions: Sequence[str],
) -> Guests | None:  # fmt: skip
    """Return the guests that conditions ask for, None if nobody comes."""
    if not {PASSER, NEIGHBOUR, POSTER} & {*conditions}:
        return None
    head = Head(model, person.neutral_mm, person.deltas_mm)
    puppet = Puppet(renderer, dressed(head, CAST[person.name].looks, wardrobe, person.name))
    return Guests(conditions, puppet)


def other_than(name: str) -> str:
    """Return who comes to visit a performer."""
    names = list(CAST)
    return names[(names.index(name) + 1) % len(names)]


def with_poster(room: U8, renderer: Renderer, guests: Guests, lights: Lights) -> U8:
    """Return the room (H, W, 3) with the guest's face on its wall."""
    width = room.shape[1]
    size = (round(_POSTER_SIZE[0] * width), round(_POSTER_SIZE[1] * width))
    camera = camera_for(size, 2.3 * size[0])
    paper = np.full((size[1], size[0], 3), (206, 198, 170), np.uint8)
    posture = _posture(np.array([0.0, 0.0, 560.0]), 0.1)
    items = guests.puppet.items(*_STILL, posture.head_to_camera, posture.body_to_camera)
    face = renderer.draw(Scene(View(camera), lights, items, paper))[..., :3]
    left, top = (round(part * width) for part in _POSTER_AT)
    hung = room.copy()
    hung[top : top + size[1], left : left + size[0]] = cv2.GaussianBlur(face, (0, 0), 0.8)
    return hung


def _posture(place_mm: FloatArray, yaw_rad: float) -> Posture:
    moment = Moment(_STILL[0], np.array([yaw_rad, 0.0, 0.0]), np.zeros(3), _STILL[1])
    return posture_of(moment, place_mm)
