"""The avatars by name, and a painter that draws one as face states say."""

from app.avatars.gallery import Gallery
from app.avatars.painter import AvatarPainter as Drawer
from app.avatars.painter import AvatarWish
from app.avatars.views import Framing, overlay, portrait
from app.render.avatar import Avatar
from app.render.renderer import Renderer
from app.resources import asset
from core.face_model import FaceModel
from core.records import U8, Camera, FaceState, FloatArray, UserBlendshapes

#: The user's own head, then the built-in ones.
OWN = "own"
AVATARS: tuple[str, ...] = (OWN, "nora", "leo", "mei", "kofi", "amara", "viktor")


def make_avatar(name: str, model: FaceModel, user: UserBlendshapes | None = None) -> Avatar:
    """Return an avatar.

    Args:
        name: One of AVATARS.
        model: The shipped face model.
        user: Whose head is the own one; without it, that is the first built-in avatar.
    """
    gallery = Gallery(asset("."), model)
    if name == OWN:
        return gallery.built_in(AVATARS[1]) if user is None else gallery.of_user(user)
    return gallery.built_in(name)


class AvatarPainter:
    """Draws one avatar; to be made, used and released in one thread."""

    def __init__(self, avatar: Avatar, camera: Camera, as_portrait: bool = True) -> None:
        """Open a context and upload the avatar.

        Args:
            avatar: To draw.
            camera: Of the source; the picture has its size.
            as_portrait: Head and shoulders fill the picture; otherwise the avatar is drawn
                exactly where the head is in the source's picture.

        Raises:
            RenderError: This machine cannot draw.
        """
        self._renderer = Renderer()
        self._drawer = Drawer(self._renderer)
        self._avatar, self._camera, self._as_portrait = avatar, camera, as_portrait
        self._rest_mm: FloatArray | None = None

    def paint(self, state: FaceState) -> U8:
        """Return the avatar's picture (H, W, 4)."""
        wish = AvatarWish(self._avatar, self._framing(state), state.expression, state.gaze_rad)
        return self._drawer.draw(wish)

    def release(self) -> None:
        """Give the graphics resources back."""
        self._renderer.release()

    def _framing(self, state: FaceState) -> Framing:
        rotation, translation = state.rotation_wxyz, state.translation_mm
        if not self._as_portrait:
            return overlay(self._avatar, self._camera, rotation, translation)
        if self._rest_mm is None and not state.lost:
            self._rest_mm = translation
        size_px = self._camera.size_px
        return portrait(self._avatar, size_px, rotation, translation, self._rest_mm)
