"""What the live window's controller needs from the rest of the program, in one place."""

from collections.abc import Generator
from functools import cached_property
from pathlib import Path
from threading import Lock

import numpy as np

from app.capture.source import FrameSource
from app.capture.webcam import list_cameras
from app.models import Models, load_models
from app.painting import AVATARS, AvatarPainter, make_avatar
from app.profiles import profile_folder
from app.setup_steps import collect, keep, make_profile
from app.sources import PERFORMER, open_source
from app.views.live_window import Choice
from app.workers.avatar_loop import Painter
from core.camera import camera_for
from core.generations import check_target
from core.records import Progress, UserBlendshapes

#: Size of the avatar's picture.
AVATAR_SIZE_PX = (640, 480)
AVATAR_TEXTS = {"own": "Your own head"}


class Toolbox:
    """Sources, models, painters and the making of profiles."""

    def __init__(self) -> None:
        self._loading = Lock()

    def sources(self) -> list[Choice]:
        """Return the cameras of this machine and the virtual performer."""
        cameras = [Choice(f"camera:{c.index}", c.name) for c in list_cameras()]
        return [*cameras, Choice(PERFORMER, "Virtual performer")]

    def avatars(self) -> list[Choice]:
        """Return the avatars that can be chosen."""
        return [Choice(name, AVATAR_TEXTS.get(name, name.capitalize())) for name in AVATARS]

    def open_source(self, key: str) -> FrameSource:
        """Open a source; a path is a video or a folder.

        Raises:
            AppError: It cannot be read.
        """
        return open_source(key, live=True)

    def models(self) -> Models:
        """Return the shipped models, loaded at the first call from any thread."""
        with self._loading:
            return self._models

    def make_painter(self, avatar: str, user: UserBlendshapes | None) -> Painter:
        """Return the painter of an avatar; called in the render thread.

        Args:
            avatar: One of `avatars`.
            user: Whose head is the user's own; None: the model's mean.
        """
        made = make_avatar(avatar, self.models().face_model, user)
        return AvatarPainter(made, camera_for(AVATAR_SIZE_PX, AVATAR_SIZE_PX[0]))

    def profile_steps(self, name: str, source: str) -> Generator[Progress, None, str]:
        """Make and keep a profile; returns its name.

        Raises:
            AppError, CoreError: The source or the name cannot be used; nothing was changed.
        """
        folder = profile_folder(name)
        check_target(folder)
        models = self.models()
        pictures = yield from collect(Path(source), models.aligner)
        steps = make_profile(models.face_model, pictures, None, np.random.default_rng(1))
        profile, images = yield from steps
        keep(folder, profile, images, source=source)
        return name

    @cached_property
    def _models(self) -> Models:
        return load_models()
