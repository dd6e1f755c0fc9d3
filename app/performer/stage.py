"""Draws the performer in the room: clean pictures, before the webcam spoils them."""

from dataclasses import dataclass

import numpy as np

from app.avatars.build import Head, dressed
from app.avatars.wardrobe import Wardrobe
from app.performer.conditions import BEARD, POSTER
from app.performer.events import light_is_on
from app.performer.growth import bearded
from app.performer.guests import Guests, guests_for, with_poster
from app.performer.people import CAST, Person
from app.performer.posture import Posture
from app.performer.props import Props, props_of
from app.render.avatar import Avatar
from app.render.puppet import Puppet
from app.render.renderer import Renderer, Scene
from app.render.scene import Lights, View
from core.face_model import FaceModel
from core.records import F32, U8, Camera, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """All that stays the same during a take.

    Attributes:
        model: Topology of the person.
        person: Who performs.
        wardrobe: What all avatars share.
        camera: Of the webcam.
        lights: In the room.
        room: (H, W, 3) what is behind the person.
        conditions: Keys of CONDITIONS: what the person wears or holds.
        dark: The same lights and room while the lamps are switched off.
        guest: Who else may come into the picture.
    """

    model: FaceModel
    person: Person
    wardrobe: Wardrobe
    camera: Camera
    lights: Lights
    room: U8
    conditions: tuple[str, ...] = ()
    dark: tuple[Lights, U8] | None = None
    guest: Person | None = None


class Stage:
    """Owns a renderer; to be made, used and released in one thread."""

    def __init__(self, setting: Setting) -> None:
        self._setting = setting
        self._renderer = Renderer()
        model, person, wardrobe = setting.model, setting.person, setting.wardrobe
        self._puppet = Puppet(self._renderer, made_up(setting))
        props = props_of(model, person, wardrobe, setting.conditions)
        self._props = Props(self._renderer, props)
        self._lit = setting.lights, setting.room
        self._guests: Guests | None = None
        if setting.guest is not None:
            self._guests = guests_for(
                self._renderer, model, setting.guest, wardrobe, setting.conditions
            )
        if POSTER in setting.conditions and self._guests is not None:
            room = with_poster(setting.room, self._renderer, self._guests, setting.lights)
            self._lit = setting.lights, room

    def shoot(
        self, expression: FloatArray, gaze_rad: FloatArray, posture: Posture, time_s: float = 0.0
    ) -> U8:
        """Return the clean picture (H, W, 3) of one moment; the time moves what is held."""
        picture = self._renderer.draw(self._scene(expression, gaze_rad, posture, time_s))
        return np.ascontiguousarray(picture[..., :3])

    def depth_mm(
        self, expression: FloatArray, gaze_rad: FloatArray, posture: Posture, time_s: float = 0.0
    ) -> F32:
        """Return the distance (H, W) along z of what each pixel of that picture shows."""
        return self._renderer.depth_mm(self._scene(expression, gaze_rad, posture, time_s))

    def _scene(
        self, expression: FloatArray, gaze_rad: FloatArray, posture: Posture, time_s: float
    ) -> Scene:
        head, body = posture.head_to_camera, posture.body_to_camera
        items = self._puppet.items(expression, gaze_rad, head, body)
        items += self._props.items(posture, time_s)
        if self._guests is not None:
            items += self._guests.items(time_s)
        dark = self._setting.dark
        lights, room = self._lit if dark is None or light_is_on(time_s) else dark
        return Scene(View(self._setting.camera), lights, items, room)

    def release(self) -> None:
        """Free the renderer."""
        self._renderer.release()


def made_up(setting: Setting) -> Avatar:
    """Return the person's avatar, with a beard if the conditions ask for one."""
    person, wardrobe = setting.person, setting.wardrobe
    head, looks = Head(setting.model, person.neutral_mm, person.deltas_mm), CAST[person.name].looks
    if BEARD not in setting.conditions:
        return dressed(head, looks, wardrobe, person.name)
    # The skin under a beard is dark with its roots.
    stubbled = looks.changed(beard=1.0)
    return bearded(dressed(head, stubbled, wardrobe, person.name), head, looks, wardrobe)
