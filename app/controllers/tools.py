"""What the live window needs of the rest of the program, which tests can stand in for."""

from collections.abc import Generator
from pathlib import Path
from typing import Protocol

from PySide6.QtCore import SignalInstance

from app.controllers.overlays import MeshMaker
from app.controllers.player import Opener
from app.controllers.profile_maker import MadeProfile
from app.controllers.scene import Studio
from app.views.choice import Choice
from core.records import Progress


class Guided(Protocol):
    """What is needed of the window of the guided setup."""

    finished: SignalInstance  # name of the profile to go live with, or an empty text

    def show(self) -> None:
        """Show the window, in front of all others."""
        ...

    def add_pictures(self, profile: str, key: str) -> None:
        """Show the window and ask for a set of more pictures, see core.extra_shots."""
        ...

    def close(self) -> object:
        """Close it; everything taken is kept."""
        ...


class Editor(Protocol):
    """What is needed of the window of the landmark editor."""

    finished: SignalInstance  # whether the profile was trained anew
    failed: SignalInstance  # CoreError or AppError: there is nothing to show

    def show(self) -> None:
        """Show the window, in front of all others."""
        ...

    def close(self) -> object:
        """Close it."""
        ...


class Tools(Opener, Studio, MeshMaker, Protocol):
    """What is needed of the toolbox."""

    def cameras(self) -> list[Choice]:
        """Return the cameras of this machine."""
        ...

    def performances(self) -> list[Choice]:
        """Return what the virtual performer can play."""
        ...

    def avatars(self) -> list[Choice]:
        """Return the avatars that can be chosen."""
        ...

    def profiles(self) -> list[str]:
        """Return the names of the profiles."""
        ...

    def name_trouble(self, name: str) -> str:
        """Return what is wrong with the name of a new profile, or an empty text."""
        ...

    def guided_setup(self, source: str) -> Guided:
        """Return the guided setup, to be shown; the source is the camera to begin with."""
        ...

    def profile_editor(self, name: str) -> Editor:
        """Return the landmark editor of a profile, which shows itself when it is ready."""
        ...

    def profile_folder(self, name: str) -> Path:
        """Return where a profile is kept."""
        ...

    def profile_steps(self, name: str, source: str) -> Generator[Progress, None, MadeProfile]:
        """Make and keep a profile."""
        ...
