"""What the live window remembers between starts, in one small file."""

import json
import os
from contextlib import suppress
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from app.resources import data_folder

VERSION = 1


@dataclass(frozen=True, slots=True)
class WindowSettings:
    """How the user left the window.

    Attributes:
        geometry: Place and size, as Qt writes them, base64.
        panels: Which are open and where, as Qt writes it, base64.
        switches: Of app.views.live_actions.DEEDS by key: which are on.
        swapped: Whether the avatar is on the left.
        avatar_place: x, y, width, height of the avatar's own window; empty before the first time.
        source: The camera used last; other sources are not begun with.
        profile: The profile used last, empty for none.
        avatar: The avatar used last.
        invited: Whether the invitation to the setup was put away.
    """

    geometry: str = ""
    panels: str = ""
    switches: dict[str, bool] = field(default_factory=dict)
    swapped: bool = False
    avatar_place: list[int] = field(default_factory=list)
    source: str = ""
    profile: str = ""
    avatar: str = ""
    invited: bool = False


def window_file() -> Path:
    """Return where the settings are kept."""
    return data_folder() / "settings" / "window.json"


def load_window() -> WindowSettings:
    """Return what was kept; the defaults for all that is missing or damaged."""
    try:
        content = json.loads(window_file().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return WindowSettings()
    if not isinstance(content, dict) or content.get("version") != VERSION:
        return WindowSettings()
    usual = WindowSettings()
    kept = {
        entry.name: content[entry.name]
        for entry in fields(WindowSettings)
        if _fits(content.get(entry.name), getattr(usual, entry.name))
    }
    return WindowSettings(**kept)


def save_window(settings: WindowSettings) -> None:
    """Keep settings in place of those before, whole or not at all.

    A folder that cannot be written to costs the user a habit, not the evening: nothing is raised.
    """
    path = window_file()
    fresh = path.with_name(path.name + ".new")
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh.write_text(json.dumps({"version": VERSION, **asdict(settings)}, indent=1), "utf-8")
        os.replace(fresh, path)


def _fits(value: Any, usual: Any) -> bool:
    """Return whether a value from the file is of the kind that belongs there."""
    if type(value) is not type(usual):
        return False
    if isinstance(value, dict):
        return all(isinstance(one, bool) for one in value.values())
    if isinstance(value, list):
        return all(type(one) is int for one in value)
    return True
