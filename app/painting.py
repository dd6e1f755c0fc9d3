"""The avatars by name, and painters that draw one as face states say."""

import time
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from app.avatars.gallery import Gallery
from app.avatars.painter import AvatarPainter as Drawer
from app.avatars.painter import AvatarWish
from app.avatars.views import Framing, overlay, portrait
from app.background import BackgroundMaker
from app.own_looks import load_likeness, stamp
from app.picture_files import PictureShelf
from app.render.avatar import Avatar
from app.render.look import AvatarLook
from app.render.quality import IN_SOFTWARE, ON_CARD, Drawn, Ladder
from app.render.renderer import Renderer
from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.face_model import FaceModel
from core.geometry import multiply_quaternions
from core.landmarks import N_LANDMARKS
from core.records import U8, Camera, FaceState, FloatArray, Frame, UserBlendshapes

#: The user's own head, then the built-in ones.
OWN = "own"
AVATARS: tuple[str, ...] = (
    OWN, "nora", "leo", "mei", "kofi", "amara", "viktor", "juno", "fennec",
)  # fmt: skip

#: Avatars that the live view keeps: making one takes seconds.
KEPT_AVATARS = 3


def make_avatar(name: str, model: FaceModel, user: UserBlendshapes | None = None) -> Avatar:
    """Return an avatar.

    Args:
        name: One of AVATARS.
        model: The shipped face model.
        user: Whose head is the own one; without it, that is the first built-in avatar.
    """
    return avatar_from(Gallery(asset("."), model), name, user)


def avatar_from(
    gallery: Gallery, name: str, user: UserBlendshapes | None, folder: Path | None = None
) -> Avatar:
    """Return an avatar of a gallery, which keeps the files that all of them share.

    Args:
        gallery: To make it with.
        name: One of AVATARS.
        user: Whose head is the own one.
        folder: Of the user's profile, None if it is not known: copies have the same face.
    """
    if name != OWN:
        return gallery.built_in(name)
    if user is None:
        return gallery.built_in(AVATARS[1])
    known = load_likeness(user, folder)
    return (
        gallery.of_user(user) if known is None else gallery.of_user(user, known.looks, known.skin)
    )


def resting() -> FaceState:
    """Return a face that looks straight ahead and shows nothing, as before the first frame."""
    return FaceState(
        0.0, np.array([1.0, 0, 0, 0]), np.array([0, 0, 600.0]), np.zeros(len(EXPRESSION_NAMES)),
        np.zeros((2, 2)), np.zeros((N_LANDMARKS, 3)), np.zeros((N_LANDMARKS, 2)), 0.0, "trained",
        lost=True,
    )  # fmt: skip


class PortraitView:
    """Head and shoulders, centred where the head first was, upright as the user usually is.

    Webcams look at people from above or below; a user who looks at the screen shall see an avatar
    that looks straight ahead.
    """

    def __init__(self, size_px: tuple[int, int], user: UserBlendshapes | None = None) -> None:
        """Prepare pictures of a size (width, height); the user's usual rotation is taken off."""
        self._size_px = size_px
        self._rest_wxyz = np.array([1.0, 0, 0, 0]) if user is None else user.rest_wxyz
        self._from_rest = self._rest_wxyz * [1, -1, -1, -1]
        self._rest_mm: FloatArray | None = None

    def framing(self, avatar: Avatar, state: FaceState, look: AvatarLook | None = None) -> Framing:
        """Return where camera, head and body are."""
        if self._rest_mm is None and not state.lost:
            self._rest_mm = state.translation_mm
        # Before the face is seen, the state's rotation is nobody's.
        usual = state.rotation_wxyz if self._rest_mm is not None else self._rest_wxyz
        rotation = multiply_quaternions(usual, self._from_rest)
        return portrait(avatar, self._size_px, rotation, state.translation_mm, self._rest_mm, look)


class AvatarPainter:
    """Draws one avatar; to be made, used and released in one thread."""

    def __init__(
        self, avatar: Avatar, camera: Camera, user: UserBlendshapes | None = None,
        as_portrait: bool = True,
    ) -> None:  # fmt: skip
        """Open a context and upload the avatar.

        Args:
            avatar: To draw.
            camera: Of the source; the picture has its size.
            user: Who is tracked.
            as_portrait: Head and shoulders fill the picture; otherwise the avatar is drawn
                exactly where the head is in the source's picture.

        Raises:
            RenderError: This machine cannot draw.
        """
        self._renderer = Renderer()
        self._drawer = Drawer(self._renderer)
        self._avatar, self._camera = avatar, camera
        self._portrait = PortraitView(camera.size_px, user) if as_portrait else None

    def paint(self, state: FaceState) -> U8:
        """Return the avatar's picture (H, W, 4)."""
        return self._drawer.draw(_wish(self._avatar, self._framing(state), state))

    def release(self) -> None:
        """Give the graphics resources back."""
        self._renderer.release()

    def _framing(self, state: FaceState) -> Framing:
        if self._portrait is not None:
            return self._portrait.framing(self._avatar, state)
        return overlay(self._avatar, self._camera, state.rotation_wxyz, state.translation_mm)


#: What tells avatars apart: name, user, folder of the profile, stamp of the own looks.
Role = tuple[str, UserBlendshapes | None, Path | None, int]


@dataclass(frozen=True, slots=True, eq=False)
class Cast:
    """Who plays in the live view; every change of avatar, user or source is a new cast.

    Attributes:
        avatar: One of AVATARS.
        user: Whose head the own one is, None without a profile.
        folder: Of the user's profile, None without one.
    """

    avatar: str
    user: UserBlendshapes | None
    folder: Path | None = None


@dataclass(frozen=True, slots=True, eq=False)
class LiveWish:
    """A portrait to draw in the live view.

    Attributes:
        cast: Who.
        state: What the avatar does.
        delivered_s: When the frame came, on the clock of time.perf_counter; None: no frame, or
            one that was painted before, in another look.
        frame: What `state` was solved from, to be shown beside the avatar's picture.
        solved: What the tracker found in the frame, before anything was made of it.
        look: How the picture is taken.
    """

    cast: Cast
    state: FaceState
    delivered_s: float | None = None
    frame: Frame | None = None
    solved: FaceState | None = None
    look: AvatarLook = field(default_factory=AvatarLook)


class LivePainter:
    """Draws what the live view wishes; used in the render thread, whose renderer it is given."""

    def __init__(
        self, renderer: Renderer, model: FaceModel, size_px: tuple[int, int],
        ladder: Ladder | None = None, *, meanwhile: bool = False,
    ) -> None:  # fmt: skip
        """Prepare to draw; avatars are made when first wished for.

        Args:
            renderer: Of the calling thread.
            model: The shipped face model.
            size_px: (width, height) of the pictures.
            ladder: How well they are drawn; without it as well as can be done in time.
            meanwhile: Let the avatar before play on while another is made, in a thread of its own.
        """
        self._renderer, self._drawer = renderer, Drawer(renderer)
        self._model, self._size_px = model, size_px
        self._asked_samples = 0
        self._ladder = ladder or Ladder(IN_SOFTWARE if renderer.software else ON_CARD)
        self._pictures = PictureShelf()
        self._cast: Cast | None = None
        self._avatars: dict[Role, Avatar] = {}
        self._maker = BackgroundMaker(self._make) if meanwhile else None
        self._making = False

    def draw(self, wish: LiveWish) -> U8:
        """Return the picture (H, W, 4).

        Raises:
            AppError: A file of the avatar cannot be used.
        """
        if wish.cast is not self._cast:
            self._enter(wish.cast)
        begun_s = time.perf_counter()
        quality, self._asked_samples = self._ladder.quality, wish.look.samples
        look = wish.look.changed(samples=min(wish.look.samples, quality.samples))
        framing = self._view.framing(self._avatar, wish.state, look)
        state, behind = wish.state, self._behind(wish)
        drawn = AvatarWish(
            self._avatar, framing, state.expression, state.gaze_rad, False, look, behind
        )
        picture = self._drawer.draw(drawn, quality.scale)
        if not self._making:
            self._ladder.count(1000 * (time.perf_counter() - begun_s))
        return picture

    @property
    def drawn(self) -> Drawn:
        """How the next picture will be drawn, if as many samples are asked for as for the last."""
        quality = self._ladder.quality
        samples = self._renderer.samples(min(self._asked_samples, quality.samples))
        return Drawn(quality.scale, samples, self._renderer.software, self._making)

    def _behind(self, wish: LiveWish) -> U8 | None:
        """Return the picture that the background of a wish needs, if it needs one."""
        if wish.look.background.kind == "picture":
            return self._pictures.get(wish.look.background.picture)
        return None if wish.frame is None else wish.frame.rgb

    def _enter(self, cast: Cast) -> None:
        """Centre the portrait anew, with the cast's avatar as soon as there is one."""
        user = cast.user if cast.avatar == OWN else None
        role = (cast.avatar, user, cast.folder, 0 if user is None else stamp(user, cast.folder))
        # The last used is last; the first makes way.
        avatar = self._avatars.pop(role, None) or self._made(role)
        self._making = avatar is None
        if avatar is None:
            return
        self._avatars[role] = avatar
        if len(self._avatars) > KEPT_AVATARS:
            self._avatars.pop(next(iter(self._avatars)))
        self._avatar, self._cast = avatar, cast
        self._view = PortraitView(self._size_px, cast.user)

    def _made(self, role: Role) -> Avatar | None:
        """Return a new avatar, or None while it is made and another can play."""
        if self._maker is None or self._cast is None:
            return self._make(role)
        return self._maker.take(role)

    def _make(self, role: Role) -> Avatar:
        name, user, folder, _ = role
        return avatar_from(self._gallery, name, user, folder)

    @cached_property
    def _gallery(self) -> Gallery:
        return Gallery(asset("."), self._model)


def _wish(avatar: Avatar, framing: Framing, state: FaceState) -> AvatarWish:
    return AvatarWish(avatar, framing, state.expression, state.gaze_rad)
