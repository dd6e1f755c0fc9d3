"""What the guided setup remembers of the user's choices from one time to the next."""

import json
import os
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from pathlib import Path


@dataclass(frozen=True, slots=True)
class SetupChoices:
    """The user's choices.

    Attributes:
        camera: Name of the camera that was used last.
        hold: Whether cameras are asked to hold exposure, focus and white balance.
        sound: Whether it is heard when a picture is taken.
    """

    camera: str = ""
    hold: bool = True
    sound: bool = True


def load_choices(path: Path) -> SetupChoices:
    """Return the choices in a file; what cannot be read is as at the first time."""
    usual = SetupChoices()
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        kept = {
            field.name: found[field.name] for field in fields(SetupChoices)
            if type(found.get(field.name)) is type(getattr(usual, field.name))
        }  # fmt: skip
    except (OSError, ValueError, AttributeError):
        return usual
    return SetupChoices(**kept)


def save_choices(path: Path, choices: SetupChoices) -> None:
    """Write the choices; where that cannot be they are asked for again next time."""
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh = path.with_name(path.name + ".new")
        fresh.write_text(json.dumps(asdict(choices)), encoding="utf-8")
        os.replace(fresh, path)
