"""Keeps the lists of sources, profiles and avatars up to date."""

from app.controllers.player import Wanted
from app.controllers.tools import Tools
from app.views.choice import Choice
from app.views.live_window import OPEN_FILE, LiveWindow


class ChoiceLists:
    """Remembers the files that were played, and which profiles there were last."""

    def __init__(self, window: LiveWindow, tools: Tools) -> None:
        self._window, self._tools = window, tools
        self._files: list[str] = []
        self.profiles: list[str] = []

    def show(self, wanted: Wanted, avatar: str) -> None:
        """List all there is, what is chosen being selected."""
        known = [*self._tools.cameras(), *self._tools.performances()]
        source = wanted.source
        if source and source not in self._files and source not in {one.key for one in known}:
            self._files.append(source)
        files = [Choice(path, path.replace("\\", "/").split("/")[-1], path) for path in self._files]
        self._window.show_sources([*known, *files], source)
        self.profiles = self._tools.profiles()
        self._window.show_profiles(self.profiles, wanted.profile)
        self._window.show_avatars(self._tools.avatars(), avatar)

    def offers(self) -> list[Choice]:
        """Return sources that work everywhere."""
        return [*self._tools.performances()[:1], OPEN_FILE]
