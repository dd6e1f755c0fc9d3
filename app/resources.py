"""Where the files that the program ships are."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def asset(name: str) -> Path:
    """Return the path of a file or folder under assets/, such as face_model.npz."""
    return _find("assets", name)


def shader(name: str) -> Path:
    """Return the path of a file under shaders/."""
    return _find("shaders", name)


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
