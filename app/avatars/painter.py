"""Draws avatars from solved faces: what the live view, films and stills call."""

from dataclasses import dataclass, field

import numpy as np

from app.avatars.views import Framing
from app.render.avatar import Avatar
from app.render.backdrop import blurred, covering, plain_backdrop, studio_backdrop
from app.render.lights import lit, wall_tint
from app.render.look import AvatarLook
from app.render.puppet import Puppet
from app.render.renderer import Renderer, Scene
from app.render.scene import Lights
from core.kernels.antialias import cut_out
from core.records import U8, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class AvatarWish:
    """A picture to draw.

    Attributes:
        avatar: Who.
        framing: From where: `views.portrait` or `views.overlay`.
        expression: (46,) coefficients.
        gaze_rad: (2, 2), see FaceState.
        transparent: Without any background, to lie over other pictures.
        look: Background, lights; what it says of the view is in the framing.
        behind: (H, W, 3) uint8 of any size: the picture of the background "picture", the frame
            of the background "blurred"; without it, both are the studio.
    """

    avatar: Avatar
    framing: Framing
    expression: FloatArray
    gaze_rad: FloatArray
    transparent: bool = False
    look: AvatarLook = field(default_factory=AvatarLook)
    behind: U8 | None = None


class AvatarPainter:
    """Keeps the avatars of the last wishes on the graphics card."""

    _KEPT = 2

    def __init__(self, renderer: Renderer, lights: Lights | None = None) -> None:
        """Prepare to draw.

        Args:
            renderer: What draws.
            lights: For all wishes, in place of those of their looks.
        """
        self._renderer, self._lights = renderer, lights
        self._puppets: dict[int, tuple[Avatar, Puppet]] = {}
        self._still: tuple[object, U8 | None, U8] | None = None

    def draw(self, wish: AvatarWish, scale: float = 1.0) -> U8:
        """Return the picture, (H, W, 4) uint8 with premultiplied alpha.

        Args:
            wish: What to draw.
            scale: Share of its width and height at which the figure is drawn, to be enlarged.
        """
        framing, look = wish.framing, wish.look
        items = self._puppet(wish.avatar).items(
            wish.expression, wish.gaze_rad, framing.head_to_camera, framing.body_to_camera
        )
        lights = self._lights or lit(look.lights, look.brightness, framing.view.mirrored)
        kind = "transparent" if wish.transparent else look.background.kind
        scene = Scene(framing.view, lights, items, self._behind(wish, kind, lights))
        picture = self._renderer.draw(scene, scale)
        if kind == "key":
            cut_out(*look.background.key, picture)
        return picture

    def _puppet(self, avatar: Avatar) -> Puppet:
        found = self._puppets.pop(id(avatar), None)
        if found is None:
            while len(self._puppets) >= self._KEPT:
                self._puppets.pop(next(iter(self._puppets)))[1].release()
            found = avatar, Puppet(self._renderer, avatar, exact=False)
        self._puppets[id(avatar)] = found
        return found[1]

    def _behind(self, wish: AvatarWish, kind: str, lights: Lights) -> U8 | None:
        """Return the backdrop (H, W, 3) of a wish; one that stays is made once."""
        size = wish.framing.view.camera.size_px
        if kind in ("transparent", "key"):
            return None
        if kind == "blurred" and wish.behind is not None:
            return blurred(wish.behind, size, wish.framing.view.mirrored)
        if kind == "color":
            return self._kept_still(size, wish.look.background.color, None)
        picture = wish.behind if kind == "picture" else None
        return self._kept_still(size, tuple(wall_tint(lights).tolist()), picture)

    def _kept_still(
        self, size_px: tuple[int, int], color: tuple[float, ...], picture: U8 | None
    ) -> U8:
        """Return what does not change from frame to frame: a colour, a picture or the studio.

        Args:
            size_px: (width, height).
            color: Whole numbers of a colour, or the studio's tint.
            picture: To be shown instead.
        """
        key, kept = (size_px, color), self._still
        if kept is None or kept[0] != key or kept[1] is not picture:
            if picture is not None:
                made = covering(picture, size_px)
            elif isinstance(color[0], int):
                made = plain_backdrop(size_px, color)
            else:
                made = studio_backdrop(size_px, np.array(color))
            kept = self._still = key, picture, made
        return kept[2]
