"""Where the files that the program ships are, and those of its user."""

import os
import sys
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def asset(name: str) -> Path:
    """Return the path of a file or folder under assets/, such as face_model.npz."""
    return _find("assets", name)


def shader(name: str) -> Path:
    """Return the path of a file under shaders/."""
    return _find("shaders", name)


def data_folder() -> Path:
    """Return the folder of this user's data; the variable FACEPUPPET_HOME overrides it."""
    chosen = os.environ.get("FACEPUPPET_HOME")
    if chosen:
        return Path(chosen).expanduser()
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        base = Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share")
    return base / "facepuppet"


def _find(kind: str, name: str) -> Path:
    """Return the shipped file: inside an installed package first, else in the checkout.

    Raises:
        FileNotFoundError: The installation is incomplete.
    """
    places = [_PACKAGE / "_data" / kind / name, _PACKAGE.parent / kind / name]
    for path in places:
        if path.exists():
            return path
    raise FileNotFoundError(
        f"{kind}/{name} is not part of this installation (looked at {places[0]} and {places[1]}); "
        "install facepuppet again"
    )
