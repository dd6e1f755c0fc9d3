"""What the live window's controller needs from the rest of the program, in one place."""

import gc
import os
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from app.capture.played import Played, Recording
from app.capture.source import FrameSource
from app.capture.webcam import list_cameras
from app.controllers.face_mesh import FaceMesh
from app.controllers.player import Performer
from app.controllers.profile_maker import MadeProfile
from app.controllers.progress import between
from app.errors import AppError
from app.models import Models, auto_tracker, free_tracker, load_aligner, load_models
from app.painting import AVATARS, OWN, LivePainter
from app.performer.opening import SETUP, TAKE_NAMES
from app.priority import taking_turns
from app.profiles import profile_folder, profile_names
from app.render.renderer import Renderer
from app.render.thread import RenderThread
from app.resources import asset
from app.sources import PERFORMER, open_source
from app.views.choice import Choice
from app.workers.avatar_loop import DrawingThread, Painted, painted
from core.blink_levels import blink_levels
from core.free_warm_up import warm_up
from core.generations import check_target
from core.records import Progress, UserBlendshapes
from core.store import Profile, load

if TYPE_CHECKING:
    from app.controllers.guided import GuidedSetup
    from app.controllers.profile_editor import ProfileEditor
    from app.setup_steps import Pictures

#: Size of the avatar's picture.
AVATAR_SIZE_PX = (640, 480)
#: Share of the whole making of a profile that finding the pictures takes.
COLLECT_SHARE = 0.35


class Toolbox:
    """Sources, models, painters and the making of profiles."""

    def __init__(self) -> None:
        self._loading = Lock()

    def cameras(self) -> list[Choice]:
        """Return the cameras of this machine."""
        return [Choice(f"camera:{found.index}", found.name) for found in list_cameras()]

    def performances(self) -> list[Choice]:
        """Return what the virtual performer can play."""
        takes = [take for take in TAKE_NAMES if take != SETUP]
        texts = [f"Virtual performer: {take.replace('_', ' ')}" for take in takes]
        return [Choice(f"{PERFORMER}:{k}", text) for k, text in zip(takes, texts, strict=True)]

    def avatars(self) -> list[Choice]:
        """Return the avatars that can be chosen."""
        pictures = asset("avatars") / "thumbnails"
        names = [
            Choice(name, name.capitalize(), picture=str(pictures / f"{name}.jpg"))
            for name in AVATARS
            if name != OWN
        ]
        return [Choice(OWN, "Your own head (Nora until the setup is done)"), *names]

    def profiles(self) -> list[str]:
        """Return the names of the profiles."""
        return profile_names()

    def open_source(self, key: str, began_again: Callable[[], None]) -> FrameSource:
        """Open a source; files and the performer can be paused, stepped and moved.

        Args:
            key: Of a camera or a performance, or the path of a video or a folder.
            began_again: Called in the reading thread where a frame does not follow the one before.

        Raises:
            AppError: It cannot be read.
        """
        source = open_source(key)
        return source if source.live else Played(cast("Recording", source), began_again)

    def open_profile(self, key: str) -> Performer:
        """Load a profile and make the tracker that uses it as long as its person is there.

        Raises:
            CoreError, AppError: It cannot be used.
        """
        folder = profile_folder(key)
        return replace(self.performer(load(folder)), folder=folder)

    def performer(self, profile: Profile) -> Performer:
        """Return what follows the person of a profile, and anybody else without it."""
        tracker = auto_tracker(self.models(), profile)
        levels = blink_levels(profile.standard, profile.shapes.coefficients)
        return Performer(tracker, profile.user, regressor=profile.regressor, levels=levels)

    def open_free(self) -> Performer:
        """Make a tracker that needs no profile."""
        tracker = free_tracker(self.models())
        return Performer(tracker, None, lambda: tracker.user if tracker.acquainted else None)

    def face_mesh(self, user: UserBlendshapes | None) -> FaceMesh:
        """Return the lines of a user's face, without one of the mean face."""
        return FaceMesh(self.models().face_model, user)

    def models(self) -> Models:
        """Return the shipped models, loaded and warmed up at the first call from any thread."""
        with self._loading:
            return self._models

    def make_render_thread(
        self, done: Callable[[Painted], None], failed: Callable[[AppError], None]
    ) -> DrawingThread:
        """Return the thread that draws avatars; it calls what it is given."""

        def make(renderer: Renderer) -> Callable[..., Painted]:
            painter = LivePainter(
                renderer, self.models().face_model, AVATAR_SIZE_PX, meanwhile=True
            )
            return painted(painter.draw, lambda: painter.drawn)

        return RenderThread(make, done, failed)

    def name_trouble(self, name: str) -> str:
        """Return what is wrong with the name of a new profile, or an empty text."""
        if set(name) & {"/", os.sep}:
            return "a name has no slash in it"
        try:
            profile_folder(name)
        except AppError as error:
            return str(error)
        return ""

    def guided_setup(self, source: str) -> "GuidedSetup":
        """Return the guided setup, to be shown; the source is the camera to begin with."""
        # The setup's tools are a toolbox themselves.
        from app.controllers.guided import GuidedSetup

        return GuidedSetup(source)

    def profile_editor(self, name: str) -> "ProfileEditor":
        """Return the landmark editor of a profile, which shows itself when it is ready."""
        # As the setup's, its windows are loaded when they are wished for.
        from app.controllers.profile_editor import ProfileEditor

        return ProfileEditor(profile_folder(name))

    def profile_folder(self, name: str) -> Path:
        """Return where a profile is kept."""
        return profile_folder(name)

    def profile_steps(self, name: str, source: str) -> Generator[Progress, None, MadeProfile]:
        """Make and keep a profile.

        Args:
            name: Of the profile; one of that name is replaced when the new one is complete.
            source: Path of a video or a folder, or `app.sources.PERFORMER`.

        Raises:
            AppError, CoreError: The source or the name cannot be used; nothing was changed.
        """
        # All that trains is loaded when it is needed: the window shall open soon.
        from app.setup_steps import keep, make_profile

        folder = profile_folder(name)
        check_target(folder)
        try:
            model = self.models().face_model
            pictures = yield from between(0.0, COLLECT_SHARE, self._collect(source))
            steps = taking_turns(make_profile(model, pictures, None, np.random.default_rng(1)))
            profile, images = yield from between(COLLECT_SHARE, 1.0, steps)
            kept = keep(folder, profile, images, source=Path(source).name)
        finally:
            # Of an attempt that came to nothing no empty folder stays behind.
            with suppress(OSError):
                folder.rmdir()
        return MadeProfile(name, made_text(name, kept, pictures.notes))

    def _collect(self, source: str) -> "Generator[Progress, None, Pictures]":
        from app.controllers.filming import film_performer
        from app.setup_steps import collect

        # The live view may be using the aligner of the models, and that is for one thread.
        aligner = load_aligner()
        if source == PERFORMER:
            return (yield from film_performer(aligner))
        return (yield from collect(Path(source), aligner))

    @cached_property
    def _models(self) -> Models:
        models = load_models()
        warm_up(models.face_model)
        # Python's collector shall not look through all of them and numba's code again and again:
        # that takes 100 ms, in which no thread goes on.
        gc.freeze()
        return models


def made_text(name: str, profile: Profile, notes: Sequence[str]) -> str:
    """Return how good a new profile is, for people."""
    held_out: Any = profile.report["held_out"]
    limit, share = next(iter(held_out["share_under_px"].items()))
    told = (
        f"The profile {name} was made from {len(profile.names)} pictures; on pictures kept for "
        f"testing, {100 * share:.0f} % of the results are within {limit} px."
    )
    return " ".join([told, *(f"Note: {note}." for note in notes)])
