"""The users' own looks on the disk: made once from a profile's pictures, kept beside profiles.

    likeness/<place>-<face>.npz    skin as JPEG, colours and figures as JSON
    likeness/<place>.json          the hair that the user chose

`place` stands for the profile's folder, `face` for the user's neutral face, so that looks are
found for whoever is tracked, replaced when the profile is trained anew, and go with it.
"""

import hashlib
import io
import json
import os
from collections.abc import Generator, Mapping
from contextlib import suppress
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import cv2
import numpy as np

from app.avatars.hair import CUTS
from app.avatars.likeness.ground import Pictures
from app.avatars.likeness.judge import Likeness
from app.avatars.likeness.make import make_likeness
from app.avatars.looks import Looks
from app.errors import AppError
from app.profiles import data_folder, decoded
from app.replacing import REPLACING, check_edition, edition
from app.resources import asset
from core.errors import CoreError
from core.face_model import FaceModel
from core.generations import reason_of
from core.records import U8, Progress, UserBlendshapes
from core.store import Profile, load, load_pictures

#: Raised when looks are made in another way, so that they are made again.
VERSION = 1
#: What hair can be chosen; "" is what the pictures show.
HAIR_STYLES: tuple[str, ...] = ("", *CUTS, "bald")
_QUALITY = 93


class LooksUnwritableError(AppError):
    """The own looks, or what was chosen of them, cannot be kept."""

    def __init__(self, path: Path, reason: str) -> None:
        self.path, self.reason = path, reason
        super().__init__(
            f"cannot keep your own avatar's looks in {path}: {reason}; what was there is "
            "unchanged. Make the folder writable, or free some space"
        )


def likeness_steps(folder: Path, model: FaceModel) -> Generator[Progress, None, Likeness | None]:
    """Return the own looks of a profile's user; make and keep them if they are not there.

    Args:
        folder: Of the profile.
        model: The shipped face model.

    Yields:
        Progress.

    Returns:
        None if there are no pictures, or none that shows a face well.

    Raises:
        CoreError: The profile cannot be read.
        AppError: The looks cannot be kept; or the profile was deleted, or changed, meanwhile.
    """
    begun = edition(folder)
    profile = load(folder)
    kept = load_likeness(profile.user, folder)
    # Whoever has this face may have deleted the pictures of another profile, not of this one.
    if kept is not None and (kept.skin is not None or _file(folder, profile.user).exists()):
        return kept
    yield Progress(0, 1, "Reading the pictures")
    pictures = yield from _pictures(folder, profile)
    if pictures is None:
        return None
    made = yield from make_likeness(model, pictures, asset("textures") / "skin")
    if made is not None:
        with REPLACING:
            check_edition(folder, begun)
            save_likeness(folder, profile.user, made)
    return made


def load_likeness(user: UserBlendshapes, folder: Path | None = None) -> Likeness | None:
    """Return the kept looks of a user, with the hair that was chosen; None if there are none.

    Args:
        user: Whose.
        folder: Of the profile that plays; None: of any profile with this user's face.
    """
    path = _found(user, folder)
    if path is None:
        return None
    try:
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as data:
            told = json.loads(str(data["told"]))
            skin = _decoded(data) if "color" in data.files else None
    except (OSError, EOFError, KeyError, ValueError, BadZipFile):
        return None
    if told.get("version") != VERSION:
        return None
    looks = _looks(told["looks"])
    style = _style_in(_hair_file(path, folder))
    return Likeness(skin, looks.changed(hair_style=style) if style else looks, told["report"])


def save_likeness(folder: Path, user: UserBlendshapes, likeness: Likeness) -> Path:
    """Keep the looks of a profile's user instead of earlier ones; return their file."""
    place, path = _place(folder), _file(folder, user)
    told = {"version": VERSION, "looks": asdict(likeness.looks), "report": likeness.report}
    arrays: dict[str, Any] = {"told": np.array(json.dumps(told))}
    if likeness.skin is not None:
        arrays["color"] = _encoded(np.ascontiguousarray(likeness.skin[..., 2::-1]))
        arrays["gloss"] = _encoded(np.ascontiguousarray(likeness.skin[..., 3]))
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    _replace(path, buffer.getvalue())
    for other in _folder().glob(f"{place}-*.npz"):
        if other != path:
            other.unlink(missing_ok=True)
    return path


def stamp(user: UserBlendshapes, folder: Path | None = None) -> int:
    """Return a number that changes when the looks of a user are made or changed."""
    path = _found(user, folder)
    if path is None:
        return 0
    files = (path, _hair_file(path, folder))
    return sum(entry.stat().st_mtime_ns for entry in files if entry.exists())


def chosen_hair(folder: Path) -> str:
    """Return the hair that the user of a profile chose, one of HAIR_STYLES."""
    return _style_in(_chosen_file(folder))


def choose_hair(folder: Path, style: str) -> None:
    """Keep the hair, one of HAIR_STYLES, of the user of a profile.

    Raises:
        LooksUnwritableError: What was chosen before is unchanged.
    """
    _replace(_chosen_file(folder), json.dumps({"hair_style": style}).encode())


def forget_looks(folder: Path) -> None:
    """Delete what was made from the pictures of a profile that is about to be deleted."""
    for path in _folder().glob(f"{_place(folder)}*"):
        with suppress(OSError):
            path.unlink()


def forget_skin(folder: Path) -> None:
    """Delete the skin that was made from pictures which are about to be deleted; keep colours."""
    for path in _folder().glob(f"{_place(folder)}-*.npz"):
        try:
            with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as data:
                told = data["told"]
        except (OSError, EOFError, KeyError, ValueError, BadZipFile):
            path.unlink(missing_ok=True)
            continue
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, told=told)
        _replace(path, buffer.getvalue())


def _pictures(folder: Path, profile: Profile) -> Generator[Progress, None, Pictures | None]:
    """Return the pictures of a profile, None if they are not all there."""
    try:
        files = {Path(name).stem: content for name, content in load_pictures(folder).items()}
    except CoreError:
        return None
    images = []
    for name in profile.names:
        yield Progress(0, 1, "Reading the pictures")
        rgb = decoded(files.get(name, b""))
        if rgb is None:
            return None
        images.append(rgb)
    return Pictures(images, profile.landmarks, profile.shapes, profile.camera, profile.user)


def _style_in(path: Path) -> str:
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    style = told.get("hair_style") if isinstance(told, dict) else ""
    return str(style) if style in HAIR_STYLES else ""


def _looks(told: Mapping[str, Any]) -> Looks:
    """Return looks from JSON; what is not known keeps its default."""
    known = {entry.name for entry in fields(Looks)}
    values = {
        name: tuple(value) if isinstance(value, list) else value
        for name, value in told.items()
        if name in known
    }
    return Looks().changed(**values)


def _decoded(data: Mapping[str, Any]) -> U8:
    color = cv2.imdecode(data["color"], cv2.IMREAD_COLOR)
    gloss = cv2.imdecode(data["gloss"], cv2.IMREAD_GRAYSCALE)
    if color is None or gloss is None:
        raise ValueError("the skin is no picture")
    return np.ascontiguousarray(np.dstack([color[..., ::-1], gloss]), np.uint8)


def _encoded(picture: U8) -> U8:
    done, content = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    if not done:
        raise ValueError(f"OpenCV cannot encode a picture of {picture.shape}")
    return np.asarray(content, np.uint8)


def _folder() -> Path:
    return data_folder() / "likeness"


def _place(folder: Path) -> str:
    return hashlib.sha256(str(folder.expanduser().resolve()).encode()).hexdigest()[:16]


def _file(folder: Path, user: UserBlendshapes) -> Path:
    return _folder() / f"{_place(folder)}-{_face(user)}.npz"


def _face(user: UserBlendshapes) -> str:
    return hashlib.sha256(np.ascontiguousarray(user.neutral_mm).tobytes()).hexdigest()[:24]


def _found(user: UserBlendshapes, folder: Path | None) -> Path | None:
    """Return the file of a user's looks; copies of a profile have the same face."""
    if folder is not None and (own := _file(folder, user)).exists():
        return own
    return next(iter(sorted(_folder().glob(f"*-{_face(user)}.npz"))), None)


def _chosen_file(folder: Path) -> Path:
    return _folder() / f"{_place(folder)}.json"


def _hair_file(path: Path, folder: Path | None) -> Path:
    """Return where the hair is kept that goes with a file of looks, for a profile if it is known.

    A copy of a profile has its own, whosever file the skin comes from.
    """
    own = path.with_name(path.name.split("-")[0] + ".json")
    return own if folder is None else _chosen_file(folder)


def _replace(path: Path, content: bytes) -> None:
    """Write a file in one step."""
    part = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(content)
        os.replace(part, path)
    except OSError as error:
        with suppress(OSError):
            part.unlink()
        raise LooksUnwritableError(path, reason_of(error)) from None
