"""Draws the performer in the room: clean pictures, before the webcam spoils them."""

from dataclasses import dataclass

import numpy as np

from app.avatars.build import Wardrobe, dressed
from app.performer.hair import hair_meshes
from app.performer.people import CAST, Person
from app.performer.posture import Posture
from app.render.puppet import Puppet
from app.render.renderer import Item, Renderer, Scene
from app.render.scene import Lights, View
from core.face_model import FaceModel
from core.records import U8, Camera, FloatArray


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
        person, role = setting.person, CAST[setting.person.name]
        avatar = dressed(
            setting.model,
            person.neutral_mm,
            person.deltas_mm,
            role.looks.changed(hair_style="bald"),
            setting.wardrobe,
            person.name,
        )
        self._puppet = Puppet(self._renderer, avatar)
        rng = np.random.default_rng(role.row)
        self._hair = [
            self._renderer.upload(mesh, material)
            for mesh, material in hair_meshes(setting.model, person.neutral_mm, role.style, rng)
        ]

    def shoot(self, expression: FloatArray, gaze_rad: FloatArray, posture: Posture) -> U8:
        """Return the clean picture (H, W, 3) of one moment."""
        head, body = posture.head_to_camera, posture.body_to_camera
        items = self._puppet.items(expression, gaze_rad, head, body)
        items += [Item(drawable, head, body) for drawable in self._hair]
        setting = self._setting
        scene = Scene(View(setting.camera), setting.lights, items, setting.room)
        return np.ascontiguousarray(self._renderer.draw(scene)[..., :3])

    def release(self) -> None:
        """Free the renderer."""
        self._renderer.release()
