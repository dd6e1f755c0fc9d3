"""Draws avatars from solved faces: what the live view, films and stills call."""

from dataclasses import dataclass

import numpy as np

from app.avatars.views import Framing
from app.render.avatar import Avatar
from app.render.puppet import Puppet
from app.render.renderer import Renderer, Scene
from app.render.scene import Lights, studio_lights
from core.records import U8, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class AvatarWish:
    """A picture to draw.

    Attributes:
        avatar: Who.
        framing: From where: `views.portrait` or `views.overlay`.
        expression: (46,) coefficients.
        gaze_rad: (2, 2), see FaceState.
        transparent: Without the studio's backdrop, to lie over other pictures.
    """

    avatar: Avatar
    framing: Framing
    expression: FloatArray
    gaze_rad: FloatArray
    transparent: bool = False


class AvatarPainter:
    """Keeps the avatars of the last wishes on the graphics card."""

    _KEPT = 2

    def __init__(self, renderer: Renderer, lights: Lights | None = None) -> None:
        self._renderer = renderer
        self._lights = lights or studio_lights()
        self._puppets: dict[int, tuple[Avatar, Puppet]] = {}
        self._backdrops: dict[tuple[int, int], U8] = {}

    def draw(self, wish: AvatarWish) -> U8:
        """Return the picture, (H, W, 4) uint8 with premultiplied alpha."""
        framing = wish.framing
        items = self._puppet(wish.avatar).items(
            wish.expression, wish.gaze_rad, framing.head_to_camera, framing.body_to_camera
        )
        size = framing.view.camera.size_px
        backdrop = None if wish.transparent else self._backdrop(size)
        return self._renderer.draw(Scene(framing.view, self._lights, items, backdrop))

    def _puppet(self, avatar: Avatar) -> Puppet:
        found = self._puppets.pop(id(avatar), None)
        if found is None:
            while len(self._puppets) >= self._KEPT:
                self._puppets.pop(next(iter(self._puppets)))[1].release()
            found = avatar, Puppet(self._renderer, avatar)
        self._puppets[id(avatar)] = found
        return found[1]

    def _backdrop(self, size_px: tuple[int, int]) -> U8:
        if size_px not in self._backdrops:
            self._backdrops = {size_px: studio_backdrop(size_px)}
        return self._backdrops[size_px]


def studio_backdrop(size_px: tuple[int, int]) -> U8:
    """Return a grey-blue wall, lit behind the head, (H, W, 3) uint8."""
    width, height = size_px
    y, x = np.mgrid[0:height, 0:width]
    away = np.hypot((x / width - 0.5) * width / height, y / height - 0.4)
    # Grain hides the steps between grey levels.
    grain = np.random.default_rng(5).uniform(-0.7, 0.7, (height, width))
    wall = np.array([92.0, 100.0, 110.0]) * (1.28 - 0.85 * away)[..., None] + grain[..., None]
    return np.asarray(np.clip(wall, 0, 255).astype(np.uint8))
