"""Drive settings as plain JSON values, and back from whatever a file holds.

What is unknown is ignored and what is missing gets its default, so that files of older and newer
versions can be read; what cannot be is said in a note, for the user. Coefficients go by name and
only where they differ from the default: the files can be read, and edited, by people.
"""

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, fields
from typing import Any, TypeVar

from core.arkit import EXPRESSION_NAMES
from core.drive_settings import N_KEYS, DriveSettings, ExpressionKey, Response

#: Raised when an older program would misread what this one writes.
VERSION = 1
T = TypeVar("T")
Note = Callable[[str], None]


def settings_to_plain(settings: DriveSettings) -> dict[str, Any]:
    """Return settings as JSON values."""
    plain: dict[str, Any] = {"version": VERSION}
    for part in ("steadiness", "head", "centring", "eyes", "idle"):
        plain[part] = asdict(getattr(settings, part))
    plain["responses"] = {
        name: asdict(response)
        for name, response in zip(EXPRESSION_NAMES, settings.responses, strict=True)
        if response != Response()
    }
    plain["keys"] = [key_to_plain(key) for key in settings.keys]
    return plain


def key_to_plain(key: ExpressionKey) -> dict[str, Any]:
    """Return an expression key as JSON values."""
    shown = {name: w for name, w in zip(EXPRESSION_NAMES, key.weights, strict=True) if w}
    return asdict(key) | {"weights": shown}


def settings_from_plain(
    plain: object, base: DriveSettings | None = None
) -> tuple[DriveSettings, tuple[str, ...]]:
    """Return settings from JSON values, and notes on what was not as it should be.

    Args:
        plain: Of `settings_to_plain`, or anything else.
        base: Gives what is missing; None: the defaults.
    """
    notes: list[str] = []
    settings = base or DriveSettings()
    found = _mapping(plain, "the settings", notes.append)
    version = found.get("version", VERSION)
    if isinstance(version, int) and version > VERSION:
        notes.append(
            f"settings of version {version}, this program knows {VERSION}: some may be lost"
        )
    parts = {
        name: record_from_plain(getattr(settings, name), found.get(name, {}), name, notes.append)
        for name in ("steadiness", "head", "centring", "eyes", "idle")
    }
    responses = _responses(settings.responses, found.get("responses", {}), notes.append)
    keys = settings.keys
    if "keys" in found:
        keys = _keys(found["keys"], notes.append)
    return DriveSettings(responses=responses, keys=keys, **parts), tuple(notes)


def record_from_plain(default: T, plain: object, where: str, note: Note) -> T:
    """Return a settings record with what JSON values say, clamped to its limits.

    Args:
        default: The record whose values stay where nothing usable is said.
        plain: A mapping, or anything else.
        where: Name of the record, for notes.
        note: Called with each note.
    """
    values: dict[str, Any] = {}
    found = _mapping(plain, where, note)
    for entry in fields(default):  # type: ignore[arg-type]
        old = getattr(default, entry.name)
        name = f"{where}.{entry.name}"
        new = found.get(entry.name, old)
        values[entry.name] = _value(old, new, entry.metadata, _about(name, note))
    return type(default)(**values)


def _value(old: Any, new: Any, limits: Mapping[str, Any], note: Note) -> Any:
    """Return a usable value."""
    if "low" in limits:
        return _number(old, new, limits["low"], limits["high"], note)
    if "choices" in limits and new not in limits["choices"]:
        note(f"is {new!r}, expected one of {', '.join(limits['choices'])}: left at {old}")
        return old
    if isinstance(new, type(old)):
        return new
    note(f"is {new!r}, expected {type(old).__name__}: left at {old}")
    return old


def _about(name: str, note: Note) -> Note:
    """Return what notes a text about a value."""
    return lambda text: note(f"{name} {text}")


def _number(old: float, new: object, low: float, high: float, note: Note) -> float:
    value = math.nan
    if isinstance(new, int | float) and not isinstance(new, bool):
        with suppress(OverflowError):
            value = float(new)
    if not math.isfinite(value):
        note(f"is {new!r}, expected a number: left at {old:g}")
        return old
    if not low <= value <= high:
        note(f"is {value:g}, expected {low:g} to {high:g}: limited")
    return min(max(value, low), high)


def _responses(base: tuple[Response, ...], plain: object, note: Note) -> tuple[Response, ...]:
    found = _mapping(plain, "responses", note)
    return tuple(
        record_from_plain(old, found[name], f"responses.{name}", note) if name in found else old
        for name, old in zip(EXPRESSION_NAMES, base, strict=True)
    )


def _keys(plain: object, note: Note) -> tuple[ExpressionKey, ...]:
    if not isinstance(plain, list):
        note(f"keys is {type(plain).__name__}, expected a list: left out")
        return ()
    if len(plain) > N_KEYS:
        note(f"keys has {len(plain)} entries, expected at most {N_KEYS}: the rest is left out")
    return tuple(key_from_plain(one, f"keys {n}", note) for n, one in enumerate(plain[:N_KEYS], 1))


def key_from_plain(plain: object, where: str, note: Note) -> ExpressionKey:
    """Return an expression key from JSON values; see `record_from_plain`."""
    found = dict(_mapping(plain, where, note))
    shown = _mapping(found.pop("weights", {}), f"{where}.weights", note)
    weights = tuple(
        _number(0.0, shown.get(name, 0.0), 0.0, 1.0, _about(f"{where}.{name}", note))
        for name in EXPRESSION_NAMES
    )
    return record_from_plain(ExpressionKey("Face", weights), found, where, note)


def _mapping(plain: object, where: str, note: Note) -> Mapping[str, Any]:
    if isinstance(plain, Mapping):
        return plain
    note(f"{where} is {type(plain).__name__}, expected named values: left at the defaults")
    return {}
