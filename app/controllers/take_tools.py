"""What takes need of the rest of the program: solving, drawing, a user's head."""

from collections.abc import Generator
from pathlib import Path
from typing import Protocol

from app.errors import AppError
from app.models import load_models
from app.painting import Cast, LivePainter, LiveWish
from app.priority import stepping_back
from app.profiles import profile_folder
from app.render.look import AvatarLook
from app.render.quality import Ladder, Quality
from app.render.renderer import Renderer
from app.resources import asset
from app.takes.exporting import FilmWish, export_film
from app.takes.library import Take
from app.takes.rows import Moment
from app.takes.solving import SolveWish, solve, tracker_for
from core.blink_levels import blink_levels
from core.drive import Drive
from core.errors import CoreError
from core.face_model import load_face_model
from core.records import U8, Frame, Progress, UserBlendshapes
from core.store import load


class TakeTools(Protocol):
    """What is needed of the workshop; tests can stand in for it."""

    def user(self, profile: str) -> UserBlendshapes | None:
        """Return whose head a profile has, None if it is not there; in a background thread."""
        ...

    def solve(self, take: Take, wish: SolveWish, drive: Drive) -> Generator[Progress, None, Take]:
        """Solve a take's video again; the drive is new, with the user's settings."""
        ...

    def film(
        self, take: Take, path: Path, wish: FilmWish, avatar: str, look: AvatarLook
    ) -> Generator[Progress, None, Path]:
        """Write a film of an avatar."""
        ...


def folder_of(profile: str) -> Path | None:
    """Return where a profile is kept, None without one."""
    try:
        return profile_folder(profile) if profile else None
    except AppError:
        return None


class TakeWorkshop:
    """Works with the shipped models; each piece of work loads its own, for its own thread."""

    def user(self, profile: str) -> UserBlendshapes | None:
        """Return whose head a profile has, None if it is not there any more."""
        if not profile:
            return None
        try:
            return load(profile_folder(profile)).user
        except (CoreError, AppError):
            return None

    def solve(self, take: Take, wish: SolveWish, drive: Drive) -> Generator[Progress, None, Take]:
        """Solve a take's video again.

        Raises:
            CoreError, AppError: The profile or the video cannot be used.
        """
        return stepping_back(self._solve(take, wish, drive))

    def _solve(self, take: Take, wish: SolveWish, drive: Drive) -> Generator[Progress, None, Take]:
        yield Progress(0, 1, "Preparing the tracker")
        profile = load(profile_folder(wish.profile)) if wish.profile else None
        if profile is not None:
            drive.know_levels(blink_levels(profile.standard, profile.shapes.coefficients))
        tracker = tracker_for(load_models(), profile, wish.mode)
        return (yield from solve(take, wish, tracker, drive.step))

    def film(
        self, take: Take, path: Path, wish: FilmWish, avatar: str, look: AvatarLook
    ) -> Generator[Progress, None, Path]:
        """Write a film of an avatar; its renderer lives and ends in the thread that runs this.

        Raises:
            AppError: This machine cannot draw, or the file cannot be written.
        """
        return stepping_back(self._film(take, path, wish, avatar, look))

    def _film(
        self, take: Take, path: Path, wish: FilmWish, avatar: str, look: AvatarLook
    ) -> Generator[Progress, None, Path]:
        yield Progress(0, 1, "Preparing the avatar")
        model = load_face_model(asset("face_model.npz"))
        cast = Cast(avatar, self.user(take.facts.profile), folder_of(take.facts.profile))
        renderer = Renderer()
        try:
            # There is time: all frames are drawn as well as can be.
            painter = LivePainter(renderer, model, wish.size_px, Ladder((Quality(),)))

            def draw(moment: Moment, frame: Frame | None) -> U8:
                seen = LiveWish(cast, moment.driven, frame=frame, solved=moment.solved, look=look)
                return painter.draw(seen)

            return (yield from export_film(take, path, wish, draw))
        finally:
            renderer.release()
