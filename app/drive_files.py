"""Settings of the drive on disk: one file for each profile and avatar, and presets by name.

    settings/drive/PROFILE/AVATAR.json       the settings
    settings/drive/PROFILE/AVATAR.json.last  the same before the last change
    settings/drive/PROFILE/centre            where the user sits and how the face rests, whatever
                                             the avatar
    settings/presets/NAME.json               settings that the user gave a name

A file is replaced in one step. One that cannot be read is put aside, and the last good one, or what
the profile's other avatars use, takes its place; the user is told.
"""

import json
import os
import shutil
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

from app.errors import AppError
from app.profiles import data_folder
from core.centring import Centre, centre_from_plain, centre_to_plain
from core.drive_json import settings_from_plain, settings_to_plain
from core.drive_presets import PRESETS
from core.drive_settings import DriveSettings
from core.plain_json import json_text

#: What is used before anything was kept.
FIRST = PRESETS["Natural"][1]
#: Folder of what is kept without a profile; no profile's name, which begins with a letter.
NOBODY = "-"
#: Longest name of a preset, and the most bytes of its file's name without its ending: a letter that
#: is not English takes 6 to 12.
MOST_LETTERS = 40
MOST_BYTES = 200


class PresetNameError(AppError):
    """A text can be no name of a preset."""

    def __init__(self, text: str, why: str) -> None:
        self.text = text
        super().__init__(f"{text!r} cannot be a preset's name: {why}; choose another name")


class SettingsUnwritableError(AppError):
    """Settings cannot be kept."""

    def __init__(self, path: Path, reason: str) -> None:
        self.path = path
        super().__init__(
            f"cannot keep the settings in {path}: {reason}; they hold until the program ends. Make "
            "the folder writable, or free some space"
        )


@dataclass(frozen=True, slots=True, eq=False)
class Kept:
    """What is kept for a profile and an avatar.

    Attributes:
        settings: Of the drive.
        centre: As it was set, None if it was not.
        notes: What was wrong with the file, for the user.
    """

    settings: DriveSettings
    centre: Centre | None = None
    notes: tuple[str, ...] = field(default=())


def drive_file(profile: str, avatar: str) -> Path:
    """Return where the settings of a profile, or with an empty name of none, and avatar are."""
    folder = data_folder() / "settings" / "drive" / (quote(profile, safe=" ") or NOBODY)
    return folder / f"{quote(avatar, safe=' ')}.json"


def load_kept(profile: str, avatar: str) -> Kept:
    """Return what is kept; of an avatar that is new what the profile's last one uses."""
    path = drive_file(profile, avatar)
    place = _read(_centre_file(path))
    centre = None if isinstance(place, str) else centre_from_plain(place)
    notes: list[str] = []
    for one in (path, _last(path), *_others(path)):
        if not one.exists():
            continue
        found = _read(one)
        if isinstance(found, str):
            notes.append(f"{one} {found}: not used")
            _put_aside(one)
            continue
        settings, doubts = settings_from_plain(found, FIRST)
        notes += [f"{one}: {doubt}" for doubt in doubts]
        return Kept(settings, centre, tuple(notes))
    return Kept(FIRST, centre, tuple(notes))


def save_kept(profile: str, avatar: str, kept: Kept) -> None:
    """Keep settings and centre; those before stay as the last good ones.

    Raises:
        SettingsUnwritableError: They cannot be written; what was there is unchanged.
    """
    path = drive_file(profile, avatar)
    _write(path, settings_to_plain(kept.settings), keep_last=True)
    centre = {} if kept.centre is None else centre_to_plain(kept.centre)
    _write(_centre_file(path), centre, keep_last=False)


def forget_kept(profile: str) -> None:
    """Delete the settings and the centre of a profile that was deleted."""
    shutil.rmtree(drive_file(profile, "").parent, ignore_errors=True)


def preset_names() -> list[str]:
    """Return the names of all presets: those of the program first."""
    own = (unquote(path.stem) for path in _preset_folder().glob("*.json"))
    return [*PRESETS, *sorted((name for name in own if name not in PRESETS), key=str.casefold)]


def load_preset(name: str) -> Kept:
    """Return the settings of a preset, with notes if its file is damaged."""
    if name in PRESETS:
        return Kept(PRESETS[name][1])
    path = _preset_file(name)
    found = _read(path)
    if isinstance(found, str):
        return Kept(FIRST, None, (f"the preset {name} {found}: the usual settings are used",))
    settings, doubts = settings_from_plain(found, FIRST)
    return Kept(settings, None, tuple(f"preset {name}: {doubt}" for doubt in doubts))


def save_preset(name: str, settings: DriveSettings) -> None:
    """Keep settings under a name; a preset of the user's of that name is replaced.

    Raises:
        PresetNameError: The name is empty, too long, or one of the program's presets.
        SettingsUnwritableError: They cannot be written.
    """
    text = name.strip()
    if not text or len(text) > MOST_LETTERS:
        raise PresetNameError(name, f"expected 1 to {MOST_LETTERS} letters")
    if (found := len(_quoted(text))) > MOST_BYTES:
        why = f"it takes {found} bytes as a file name, expected at most {MOST_BYTES}"
        raise PresetNameError(name, f"{why}; letters that are not English take 6 or more each")
    if text.casefold() in (one.casefold() for one in PRESETS):
        raise PresetNameError(name, "it is the name of a preset of the program")
    _write(_preset_file(text), settings_to_plain(settings), keep_last=False)


def delete_preset(name: str) -> None:
    """Delete a preset of the user's; one that is gone already is no trouble."""
    with suppress(OSError):
        _preset_file(name).unlink()


def _preset_folder() -> Path:
    return data_folder() / "settings" / "presets"


def _preset_file(name: str) -> Path:
    return _preset_folder() / f"{_quoted(name)}.json"


def _quoted(name: str) -> str:
    """Return a name as part of a file's name: surrogates, which no file system takes, too."""
    return quote(name, safe=" ", errors="replace")


def _centre_file(path: Path) -> Path:
    return path.with_name("centre")


def _last(path: Path) -> Path:
    return path.with_name(path.name + ".last")


def _others(path: Path) -> list[Path]:
    """Return the files of the profile's other avatars, the newest first."""
    with suppress(OSError):
        return sorted(path.parent.glob("*.json"), key=lambda one: -one.stat().st_mtime)
    return []


def _put_aside(path: Path) -> None:
    with suppress(OSError):
        os.replace(path, path.with_name(path.name + ".broken"))


def _read(path: Path) -> Mapping[str, Any] | str:
    """Return the content of a file, or what is wrong with it."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        return f"cannot be read ({error.strerror or error})"
    except ValueError:
        return "is damaged, expected JSON"
    return content if isinstance(content, dict) else "is damaged, expected named values"


def _holds(path: Path, text: str) -> bool:
    """Return whether a file has a text already."""
    with suppress(OSError, ValueError):
        return path.read_text(encoding="utf-8") == text
    return False


def _write(path: Path, plain: Mapping[str, Any], keep_last: bool) -> None:
    fresh, text = path.with_name(path.name + ".new"), json_text(plain)
    try:
        if _holds(path, text):
            # Written again it would push what came before it out of the last good state.
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh.write_text(text, encoding="utf-8")
        if keep_last and path.exists():
            os.replace(path, _last(path))
        os.replace(fresh, path)
    except OSError as error:
        with suppress(OSError):
            fresh.unlink()
        raise SettingsUnwritableError(path, error.strerror or str(error)) from None
