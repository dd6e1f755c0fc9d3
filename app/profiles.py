"""Profiles by name: where they live, and their pictures as image files."""

import os
import re
from collections.abc import Mapping
from pathlib import Path

import cv2
import numpy as np

from app.errors import AppError
from app.resources import data_folder as data_folder
from core.generations import HEADER_NAME, ProfileDamagedError, read_generation
from core.records import U8, SetupImages
from core.store import IMAGES, Profile, load_pictures

#: From so many pictures on they are kept as JPEG: PNG would take 50 MB and more.
MANY_PICTURES = 120
JPEG_QUALITY = 95
NAME = r"[\w-][\w .-]*"
#: Four bytes each at most: a file system takes 255.
MOST_LETTERS = 60
#: What Windows keeps for devices, whatever follows a dot.
RESERVED = {
    "con",
    "prn",
    "aux",
    "nul",
    *(f"{port}{n}" for port in ("com", "lpt") for n in range(10)),
}


class ProfileNameError(AppError):
    """A text can be neither a profile's name nor its path."""

    def __init__(self, text: str) -> None:
        self.text = text
        super().__init__(f"{_shortened(text)!r} is no name for a profile{_reason(text)}")


def _shortened(text: str) -> str:
    return text if len(text) <= MOST_LETTERS else f"{text[:20]}…"


def _is_reserved(text: str) -> bool:
    return text.partition(".")[0].strip().casefold() in RESERVED


def _reason(text: str) -> str:
    if re.fullmatch(NAME, text) is None or text.endswith((" ", ".")):
        return (
            ", expected letters, digits, spaces, '-', '_' or '.', with a letter or digit first "
            "and no space or dot last"
        )
    if _is_reserved(text):
        return ": Windows keeps it for a device. Choose another, for example your first name"
    return f": it has {len(text)} letters, expected {MOST_LETTERS} at most"


def profile_folder(text: str) -> Path:
    """Return the folder that a name or a path (with a separator) means.

    Raises:
        ProfileNameError: It is neither.
    """
    if "\0" in text:
        raise ProfileNameError(text)
    if "/" in text or os.sep in text:
        return Path(text).expanduser()
    if re.fullmatch(NAME, text) is None or text.endswith((" ", ".")):
        raise ProfileNameError(text)
    if len(text) > MOST_LETTERS or _is_reserved(text):
        raise ProfileNameError(text)
    return data_folder() / "profiles" / text


def profile_names() -> list[str]:
    """Return the names of the profiles in the user's data folder, in alphabetical order."""
    headers = (data_folder() / "profiles").glob(f"[!.]*/{HEADER_NAME}")
    return sorted((path.parent.name for path in headers), key=str.casefold)


def encoded_pictures(images: SetupImages) -> dict[str, bytes]:
    """Return setup pictures as image files: file name -> content."""
    suffix = ".jpg" if len(images.images) >= MANY_PICTURES else ".png"
    return {
        name + suffix: encoded(rgb, suffix)
        for name, rgb in zip(images.names, images.images, strict=True)
    }


def encoded(rgb: U8, suffix: str = ".png") -> bytes:
    """Return a picture (H, W, 3) as the content of an image file."""
    options = [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY] if suffix == ".jpg" else []
    done, content = cv2.imencode(suffix, cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR), options)
    if not done:
        raise ValueError(f"OpenCV cannot encode a picture of {rgb.shape} as {suffix}")
    return bytes(content.tobytes())


def decoded(content: bytes) -> U8 | None:
    """Return the picture (H, W, 3) of an image file's content, None if it is none."""
    picture = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR) if content else None
    return (
        None if picture is None else np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB), np.uint8)
    )


def decoded_pictures(
    profile: Profile | SetupImages, files: Mapping[str, bytes], folder: Path
) -> SetupImages:
    """Return the setup pictures of a profile from its image files.

    Args:
        profile: Whose pictures they are: gives names and standard coefficients.
        files: File name -> content.
        folder: For messages.

    Raises:
        ProfileDamagedError: A picture is missing or cannot be decoded.
    """
    contents = {Path(name).stem: content for name, content in files.items()}
    images = tuple(_decoded(contents.get(name), folder / name) for name in profile.names)
    return SetupImages(images, profile.names, profile.standard)


def pictures_kept(folder: Path) -> bool:
    """Return whether a profile holds its pictures; the user may have deleted them.

    Raises:
        CoreError: The profile cannot be read.
    """
    return any(name.startswith(IMAGES) for name in read_generation(folder).files)


def load_setup_images(folder: Path, profile: Profile) -> SetupImages:
    """Return the pictures that a profile was made from.

    Raises:
        ProfileDamagedError: They are not all there.
    """
    return decoded_pictures(profile, load_pictures(folder), folder)


def _decoded(content: bytes | None, path: Path) -> U8:
    if content is None:
        raise ProfileDamagedError(path, "not there", "a setup picture")
    picture = decoded(content)
    if picture is None:
        raise ProfileDamagedError(path, "not decodable", "a setup picture")
    return picture
