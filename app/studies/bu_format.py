"""The Boston University head tracking database [La Cascia, Sclaroff and Athitsos 2000].

Each film `NAME.avi` (320x240, 30 frames per second, some 200 frames) has a text file `NAME.dat`
with a row per frame from a magnetic sensor on the head. The database's own page is gone; what we
know of the rows is how the evaluation scripts of CLM-framework and OpenFace read them: a running
number, x, y, z in inches, then roll, yaw, pitch in degrees, and one row before the first frame.
By the same scripts the axes are those of a camera frame (x right, y down, z forward) seen in a
mirror: x, yaw and roll have the other sign.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.errors import AppError
from app.studies.measures import MM_PER_INCH
from core.geometry import matrix_from_rotation_vector, quaternion_from_matrix
from core.records import FloatArray, freeze

SUFFIX, FILM_SUFFIXES = ".dat", (".avi", ".mp4", ".mpg", ".mov", ".mkv")
LAYOUT = (
    "FOLDER/jam1.avi with FOLDER/jam1.dat beside it, and so on (jam, jim, llm, ssm, vam: 1 to 9), "
    "also in folders inside it such as uniform-light; a row of a .dat file is a running number, "
    "x y z in inches, roll yaw pitch in degrees"
)
#: Rows may be missing at the end, or be one more than frames; more is another film's file.
_MOST_MISSING = 5


class HeadTrackingDataError(AppError):
    """A folder or file is not what the Boston University database has."""

    def __init__(self, path: Path, found: str) -> None:
        self.path, self.found = path, found
        super().__init__(f"{path}: found {found}, expected {LAYOUT}")


@dataclass(frozen=True, slots=True, eq=False)
class SensorPose:
    """What the sensor told of a frame, in our camera's directions; its zero is its own.

    Attributes:
        rotation_wxyz: (4,).
        translation_mm: (3,); the sensor sits elsewhere on the head than between the eyes, so a
            turn of the head moves it otherwise.
    """

    rotation_wxyz: FloatArray
    translation_mm: FloatArray

    def __post_init__(self) -> None:
        freeze(self, rotation_wxyz=(np.float64, (4,)), translation_mm=(np.float64, (3,)))


def films_in(folder: Path) -> list[tuple[Path, Path]]:
    """Return each film and its truth, sorted by name.

    Raises:
        HeadTrackingDataError: There is no such pair.
    """
    if not folder.is_dir():
        raise HeadTrackingDataError(folder, "no folder")
    pairs = []
    tables = [path for path in folder.rglob("*") if path.suffix.lower() == SUFFIX]
    for table in sorted(tables):
        films = [
            path for path in sorted(table.parent.iterdir())
            if path.stem.lower() == table.stem.lower() and path.suffix.lower() in FILM_SUFFIXES
        ]  # fmt: skip
        if films:
            pairs.append((films[0], table))
    if not pairs:
        found = f"{len(tables)} {SUFFIX} files, none with a film of the same name beside it"
        raise HeadTrackingDataError(folder, found if tables else f"no {SUFFIX} files")
    return pairs


def read_truth(path: Path, n_frames: int) -> list[SensorPose]:
    """Return the truth of a film's frames; some may lack at the end.

    Args:
        path: The .dat file.
        n_frames: Frames of the film.

    Raises:
        HeadTrackingDataError: The rows are no poses, or too few for the film.
    """
    rows = _rows(path)
    # The row more than frames is from before the first one.
    rows = rows[1:] if len(rows) == n_frames + 1 else rows
    if len(rows) < max(n_frames - _MOST_MISSING, 1):
        raise HeadTrackingDataError(path, f"{len(rows)} rows for a film of {n_frames} frames")
    return [_pose(row) for row in rows[:n_frames]]


def _pose(row: FloatArray) -> SensorPose:
    """Return the pose of x, y, z, roll, yaw, pitch (6,), out of the mirror."""
    x, y, z, roll, yaw, pitch = row
    turns = np.diag(np.deg2rad([pitch, -yaw, -roll]))
    about_x, about_y, about_z = (matrix_from_rotation_vector(turn) for turn in turns)
    place_mm = MM_PER_INCH * np.array([-x, y, z])
    return SensorPose(quaternion_from_matrix(about_x @ about_y @ about_z), place_mm)


def _rows(path: Path) -> FloatArray:
    """Return (N, 6) what the rows hold after the running number."""
    try:
        rows = np.loadtxt(path, ndmin=2)
    except (OSError, ValueError) as error:
        raise HeadTrackingDataError(path, str(error).splitlines()[0]) from error
    if rows.shape[1] not in (6, 7) or not np.isfinite(rows).all():
        raise HeadTrackingDataError(path, f"{len(rows)} rows of {rows.shape[1]} numbers")
    return np.asarray(rows[:, -6:])
