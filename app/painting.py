"""Avatars to choose from, and a painter that draws one as a face state says."""

import numpy as np

from app.avatars.build import Head, dressed
from app.avatars.looks import LOOKS
from app.avatars.wardrobe import load_wardrobe
from app.render.avatar import Avatar
from app.render.puppet import Puppet, body_below, pose_matrix
from app.render.renderer import Renderer, Scene
from app.render.scene import View, studio_lights
from app.resources import asset
from core.face_model import FaceModel, deltas_mm, neutral_mm
from core.records import U8, Camera, FaceState, FloatArray, UserBlendshapes

#: The avatars by key, for people.
AVATARS = {"builtin": "Built-in head", "own": "Your own head"}
#: Grey levels of the backdrop, above and below.
BACKDROP_LEVELS = (92, 40)


def make_avatar(
    key: str, model: FaceModel, user: UserBlendshapes | None = None, looks: str = "light"
) -> Avatar:
    """Return an avatar.

    Args:
        key: Of AVATARS.
        model: The face model.
        user: Whose head "own" has; without it, it has the built-in one.
        looks: A key of LOOKS.
    """
    wardrobe = load_wardrobe(asset("."), model)
    if key == "own" and user is not None:
        head = Head(model, user.neutral_mm, user.deltas_mm)
    else:
        mean = np.zeros(len(model.identity_modes_mm))
        head = Head(model, neutral_mm(model, mean), deltas_mm(model, mean))
    return dressed(head, LOOKS[looks], wardrobe, AVATARS[key])


class AvatarPainter:
    """Draws one avatar; to be made, used and released in one thread.

    The view is that of the source's own camera, so that avatar and person are of equal size at
    equal places in their pictures.
    """

    def __init__(self, avatar: Avatar, camera: Camera, upright: FloatArray | None = None) -> None:
        """Open a context and upload the avatar.

        Args:
            avatar: To draw.
            camera: Of the picture.
            upright: (3, 3) rotation of the body at rest; facing the camera if not given.

        Raises:
            RenderError: This machine cannot draw.
        """
        self._renderer = Renderer()
        self._puppet, self._avatar = Puppet(self._renderer, avatar), avatar
        self._view, self._lights = View(camera), studio_lights()
        self._upright = np.eye(3) if upright is None else upright
        self._backdrop = backdrop(camera.size_px)

    def paint(self, state: FaceState) -> U8:
        """Return the avatar's picture (H, W, 4)."""
        head = pose_matrix(state.rotation_wxyz, state.translation_mm)
        body = body_below(self._avatar, head, self._upright)
        items = self._puppet.items(state.expression, state.gaze_rad, head, body)
        return self._renderer.draw(Scene(self._view, self._lights, items, self._backdrop))

    def release(self) -> None:
        """Give the graphics resources back."""
        self._puppet.release()
        self._renderer.release()


def backdrop(size_px: tuple[int, int]) -> U8:
    """Return a plain picture (H, W, 3) that is lighter above."""
    width, height = size_px
    levels = np.linspace(*BACKDROP_LEVELS, height)
    tint = np.array([0.92, 1.0, 1.1])
    return np.ascontiguousarray(
        np.broadcast_to((levels[:, None, None] * tint), (height, width, 3)).astype(np.uint8)
    )
