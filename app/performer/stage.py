"""Draws the performer in the room: clean pictures, before the webcam spoils them."""

from dataclasses import dataclass

import numpy as np

from app.avatars.build import Head, dressed
from app.avatars.wardrobe import Wardrobe
from app.performer.cap import cap_mesh, knit
from app.performer.people import CAST, Person
from app.performer.posture import Posture
from app.render.puppet import Puppet
from app.render.renderer import Item, Renderer, Scene
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
    """

    model: FaceModel
    person: Person
    wardrobe: Wardrobe
    camera: Camera
    lights: Lights
    room: U8


class Stage:
    """Owns a renderer; to be made, used and released in one thread."""

    def __init__(self, setting: Setting) -> None:
        self._setting = setting
        self._renderer = Renderer()
        model, person, role = setting.model, setting.person, CAST[setting.person.name]
        head = Head(model, person.neutral_mm, person.deltas_mm)
        avatar = dressed(head, role.looks, setting.wardrobe, person.name)
        self._puppet = Puppet(self._renderer, avatar)
        self._worn = []
        if role.cap is not None:
            cap = cap_mesh(setting.wardrobe.scalp, person.neutral_mm, model.mean_mm)
            wool = knit(role.cap, np.random.default_rng(role.row))
            self._worn.append(self._renderer.upload(cap, wool))

    def shoot(self, expression: FloatArray, gaze_rad: FloatArray, posture: Posture) -> U8:
        """Return the clean picture (H, W, 3) of one moment."""
        picture = self._renderer.draw(self._scene(expression, gaze_rad, posture))
        return np.ascontiguousarray(picture[..., :3])

    def depth_mm(self, expression: FloatArray, gaze_rad: FloatArray, posture: Posture) -> F32:
        """Return the distance (H, W) along z of what each pixel of that picture shows."""
        return self._renderer.depth_mm(self._scene(expression, gaze_rad, posture))

    def _scene(self, expression: FloatArray, gaze_rad: FloatArray, posture: Posture) -> Scene:
        head, body = posture.head_to_camera, posture.body_to_camera
        items = self._puppet.items(expression, gaze_rad, head, body)
        items += [Item(drawable, head, body) for drawable in self._worn]
        setting = self._setting
        return Scene(View(setting.camera), setting.lights, items, setting.room)

    def release(self) -> None:
        """Free the renderer."""
        self._renderer.release()
