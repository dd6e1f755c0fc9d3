"""What the live window needs of the rest of the program, which tests can stand in for."""

from collections.abc import Generator
from typing import Protocol

from app.controllers.player import Opener
from app.controllers.profile_maker import MadeProfile
from app.controllers.scene import Studio
from app.views.choice import Choice
from core.records import Progress


class Tools(Opener, Studio, Protocol):
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

    def profile_steps(self, name: str, source: str) -> Generator[Progress, None, MadeProfile]:
        """Make and keep a profile."""
        ...
