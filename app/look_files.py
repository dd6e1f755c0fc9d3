"""How the user wants to see each avatar, kept in one small file."""

import json
import os
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from app.profiles import data_folder
from app.render.lights import LIGHTS
from app.render.look import AvatarLook, look_from_json

VERSION = 1
#: Whether the avatar mirrors the user: as the webcam's picture does, always, never.
MIRRORS = ("source", "yes", "no")


@dataclass(frozen=True, slots=True)
class KeptLook:
    """What is kept for one avatar.

    Attributes:
        look: Its `mirrored` is not kept: it follows from `mirror` and the webcam's picture.
        mirror: One of MIRRORS.
    """

    look: AvatarLook = field(default_factory=AvatarLook)
    mirror: str = "source"


def looks_file() -> Path:
    """Return where the looks are kept."""
    return data_folder() / "settings" / "looks.json"


def load_looks() -> dict[str, KeptLook]:
    """Return what was kept, avatar -> look; what is missing or makes no sense is left out."""
    try:
        content = json.loads(looks_file().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    if not isinstance(content, dict) or content.get("version") != VERSION:
        return {}
    looks = content.get("avatars")
    entries = looks.items() if isinstance(looks, dict) else ()
    return {name: _kept(values) for name, values in entries if isinstance(values, dict)}


def save_looks(looks: dict[str, KeptLook]) -> None:
    """Keep looks in place of those before, whole or not at all.

    A folder that cannot be written to costs the user a habit, not the evening: nothing is raised.
    """
    path = looks_file()
    fresh = path.with_name(path.name + ".new")
    avatars = {
        name: {"mirror": kept.mirror, **kept.look.changed(mirrored=False).to_json()}
        for name, kept in looks.items()
    }
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh.write_text(json.dumps({"version": VERSION, "avatars": avatars}, indent=1), "utf-8")
        os.replace(fresh, path)


def _kept(values: dict[str, Any]) -> KeptLook:
    mirror = values.get("mirror")
    look = look_from_json(values, LIGHTS).changed(mirrored=False)
    return KeptLook(look, mirror if mirror in MIRRORS else "source")
