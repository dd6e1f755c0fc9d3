"""Profiles on disk: arrays as .npz (never pickle), the rest as JSON with a schema version.

    setup.npz        standard coefficients, landmarks, fit, shapes
    user.npz         the user's blendshapes
    regressor.npz    the trained regressor
    eyes.npz         what reads the gaze; not there if too few eyes were seen
    report.json      accuracy and times of the setup
    images/          the setup pictures, as the caller encoded them

The blendshapes are stored although the identity would give them: reading them takes 3 ms, less
than making them, and a profile then means the same under every later face model.
"""

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, TypeVar
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from core.errors import ArrayShapeError
from core.eye_reader import EyeReader
from core.fern_regressor import FernRegressor
from core.generations import Generation, ProfileDamagedError, read_generation, write_generation
from core.plain_json import json_text
from core.records import (
    Camera,
    FloatArray,
    Landmarks2D,
    ModelFit,
    SetupShapes,
    UserBlendshapes,
    freeze,
)

Arrays = dict[str, NDArray[Any]]
R = TypeVar("R")

IMAGES = "images/"


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """A person's trained model, and what it was made from except the pictures.

    Attributes:
        names: N file stems of the setup images.
        standard: (N, B) standard coefficients a*, NaN rows where there are none.
        landmarks: N landmark sets.
        camera: The camera of the setup images.
        fit: The face model fitted to them.
        user: The user's blendshapes.
        shapes: The 3D shape of every setup image.
        regressor: What follows the face live.
        report: Accuracy and times of the setup, JSON values.
        eyes: What reads the gaze live, None if too few eyes were seen.
    """

    names: tuple[str, ...]
    standard: FloatArray
    landmarks: tuple[Landmarks2D, ...]
    camera: Camera
    fit: ModelFit
    user: UserBlendshapes
    shapes: SetupShapes
    regressor: FernRegressor
    report: dict[str, object]
    eyes: EyeReader | None = None

    def __post_init__(self) -> None:
        freeze(self, standard=(np.float64, ("N", "B")))
        counts = {len(self.names), len(self.landmarks), len(self.standard)}
        if len(counts) != 1:
            raise ArrayShapeError("Profile", f"{sorted(counts)} images", "one number of images")


def save(folder: Path, profile: Profile, pictures: Mapping[str, bytes]) -> None:
    """Write a profile; a profile that is there is replaced only when all is on the disk.

    Args:
        folder: Made if it is not there.
        profile: What to keep.
        pictures: File name -> encoded picture, the names' stems being the profile's.

    Raises:
        ProfileNewerError, ProfileUnwritableError, ProfileDamagedError: Nothing was changed.
    """
    setup = {"standard": profile.standard}
    setup |= _stacked("landmarks", Landmarks2D, profile.landmarks)
    setup |= _arrays("fit", profile.fit) | _arrays("shapes", profile.shapes)
    files = {
        "setup.npz": _packed(setup),
        "user.npz": _packed(_arrays("user", profile.user)),
        "regressor.npz": _packed(profile.regressor.arrays()),
        "report.json": json_text(profile.report).encode(),
    }
    if profile.eyes is not None:
        files["eyes.npz"] = _packed(profile.eyes.arrays())
    files |= {IMAGES + name: content for name, content in pictures.items()}
    camera = profile.camera
    header = {
        "names": list(profile.names),
        "focal_px": float(camera.focal_px),
        "center_px": camera.center_px.tolist(),
        "size_px": [int(length) for length in camera.size_px],
    }
    write_generation(folder, header, files)


def load(folder: Path) -> Profile:
    """Read a profile.

    Raises:
        ProfileMissingError: There is none.
        ProfileNewerError: A newer program wrote it.
        ProfileDamagedError: A file is missing or not what was written.
    """
    generation = read_generation(folder)
    try:
        return _profile(generation)
    except (KeyError, TypeError, ValueError, EOFError, BadZipFile, ArrayShapeError) as error:
        found = f"inconsistent ({error})"
        raise ProfileDamagedError(generation.folder, found, "a complete profile") from error


def load_pictures(folder: Path) -> dict[str, bytes]:
    """Return the setup pictures of a profile as they were saved: file name -> encoded picture.

    Raises:
        ProfileMissingError, ProfileNewerError, ProfileDamagedError: As for `load`.
    """
    generation = read_generation(folder)
    names = [name for name in generation.files if name.startswith(IMAGES)]
    return {name.removeprefix(IMAGES): generation.read(name) for name in names}


def _profile(generation: Generation) -> Profile:
    header = generation.header
    setup = _unpacked(generation, "setup.npz")
    width, height = header["size_px"]
    return Profile(
        names=tuple(header["names"]),
        standard=setup["standard"],
        landmarks=_unstacked("landmarks", Landmarks2D, setup, len(header["names"])),
        camera=Camera(header["focal_px"], np.array(header["center_px"]), (width, height)),
        fit=_record("fit", ModelFit, setup),
        user=_record("user", UserBlendshapes, _unpacked(generation, "user.npz")),
        shapes=_record("shapes", SetupShapes, setup),
        regressor=FernRegressor.from_arrays(_unpacked(generation, "regressor.npz")),
        report=json.loads(generation.read("report.json")),
        eyes=_eyes(generation),
    )


def _eyes(generation: Generation) -> EyeReader | None:
    if "eyes.npz" not in generation.files:
        return None
    return EyeReader.from_arrays(_unpacked(generation, "eyes.npz"))


def _packed(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()


def _unpacked(generation: Generation, name: str) -> Arrays:
    with np.load(io.BytesIO(generation.read(name)), allow_pickle=False) as stored:
        return {key: stored[key] for key in stored.files}


def _arrays(prefix: str, record: Any) -> Arrays:
    """Return the array fields of a record under prefixed names."""
    return {f"{prefix}.{entry.name}": getattr(record, entry.name) for entry in fields(record)}


def _record(prefix: str, kind: type[R], arrays: Arrays) -> R:
    """Return the record whose `_arrays` these are."""
    names = [entry.name for entry in fields(kind)]  # type: ignore[arg-type]
    return kind(**{name: arrays[f"{prefix}.{name}"] for name in names})


def _stacked(prefix: str, kind: type[Any], records: tuple[Any, ...]) -> Arrays:
    """Return the fields of equal records, each stacked along a new first axis."""
    return {
        f"{prefix}.{entry.name}": np.stack([getattr(record, entry.name) for record in records])
        for entry in fields(kind)
    }


def _unstacked(prefix: str, kind: type[R], arrays: Arrays, count: int) -> tuple[R, ...]:
    """Return the records whose `_stacked` these are."""
    names = [entry.name for entry in fields(kind)]  # type: ignore[arg-type]
    stacks = {name: arrays[f"{prefix}.{name}"] for name in names}
    return tuple(kind(**{name: stack[n] for name, stack in stacks.items()}) for n in range(count))
