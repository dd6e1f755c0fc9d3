"""The states of a take as rows of one fixed layout, on the disk and back.

While a take is recorded its rows are appended to one plain file: what was written stays readable
whatever happens next. A complete take has them as columns, the layout of a track (README, Tracks)
and what else a take knows:

    play_s (N,) float64           time since the take's begin, pauses left out
    frame_index (N,) int64        running number in the source; gaps are frames that were left out
    video_index (N,) int32        frame of the take's video, -1 where its picture was not kept
    gaze_rad (N, 2, 2)            yaw and pitch of each eye
    regions (N, 6)                confidence by region, in the order of landmarks.REGION_NAMES
    driven_rotation_wxyz (N, 4), driven_translation_mm (N, 3), driven_expression (N, 46),
    driven_gaze_rad (N, 2, 2)     what the avatar did
    driven_lost (N,) bool         whether it had nobody to follow
"""

import zipfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arkit import ARKIT_NAMES, EXPRESSION_NAMES, arkit_from
from core.landmarks import N_LANDMARKS, REGION_NAMES
from core.records import Camera, FaceState

N_SHAPES = len(EXPRESSION_NAMES)
ROW = np.dtype(
    [
        ("time_s", "<f8"), ("play_s", "<f8"), ("frame_index", "<i8"), ("video_index", "<i4"),
        ("frame_mode", "<U7"), ("lost", "?"), ("confidence", "<f4"),
        ("landmarks_px", "<f4", (N_LANDMARKS, 2)), ("shape_mm", "<f4", (N_LANDMARKS, 3)),
        ("rotation_wxyz", "<f4", (4,)), ("translation_mm", "<f4", (3,)),
        ("expression", "<f4", (N_SHAPES,)), ("gaze_rad", "<f4", (2, 2)),
        ("regions", "<f4", (len(REGION_NAMES),)),
        ("driven_lost", "?"), ("driven_rotation_wxyz", "<f4", (4,)),
        ("driven_translation_mm", "<f4", (3,)), ("driven_expression", "<f4", (N_SHAPES,)),
        ("driven_gaze_rad", "<f4", (2, 2)),
    ]
)  # fmt: skip
SOLVED = (
    "landmarks_px", "shape_mm", "rotation_wxyz", "translation_mm", "expression", "gaze_rad",
    "regions",
)  # fmt: skip
DRIVEN = ("rotation_wxyz", "translation_mm", "expression", "gaze_rad")
#: Rows that are worked on at once, so that an hour takes no more memory than a minute.
AT_ONCE = 4096

Rows = NDArray[Any]


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """One frame of a take.

    Attributes:
        play_s: Since the take's begin, pauses left out.
        frame_index: Of the source.
        video_index: Of the take's video, -1 without a picture.
        solved: The face.
        driven: What the avatar does.
    """

    play_s: float
    frame_index: int
    video_index: int
    solved: FaceState
    driven: FaceState


def row_of(moment: Moment) -> Rows:
    """Return the row (1,) of a moment."""
    row = np.zeros(1, ROW)
    solved, driven = moment.solved, moment.driven
    row["time_s"], row["play_s"] = solved.time_s, moment.play_s
    row["frame_index"], row["video_index"] = moment.frame_index, moment.video_index
    row["frame_mode"], row["lost"] = solved.mode, solved.lost
    row["confidence"], row["driven_lost"] = solved.confidence, driven.lost
    for name in SOLVED:
        row[name] = getattr(solved, name)
    for name in DRIVEN:
        row[f"driven_{name}"] = getattr(driven, name)
    return row


def moment_of(row: Any) -> Moment:
    """Return the moment of one row."""
    fields: dict[str, Any] = {name: np.asarray(row[name], float) for name in SOLVED}
    solved = FaceState(
        time_s=float(row["time_s"]), confidence=float(row["confidence"]),
        mode=str(row["frame_mode"]), lost=bool(row["lost"]), **fields,
    )  # fmt: skip
    done: dict[str, Any] = {name: np.asarray(row[f"driven_{name}"], float) for name in DRIVEN}
    driven = replace(solved, lost=bool(row["driven_lost"]), **done)
    return Moment(
        float(row["play_s"]), int(row["frame_index"]), int(row["video_index"]), solved, driven
    )


def appended(path: Path) -> Rows:
    """Return the rows of a file that was appended to, without a last one that is cut short.

    They stay on the disk until they are looked at.
    """
    n_rows = path.stat().st_size // ROW.itemsize if path.exists() else 0
    if n_rows == 0:
        return np.zeros(0, ROW)
    return np.memmap(path, ROW, mode="r", shape=(n_rows,))


def write_columns(
    path: Path, rows: Rows, camera: Camera, sign: Callable[[], object] = lambda: None
) -> None:
    """Write rows as the columns of an .npz file, bit by bit.

    Args:
        path: To write; complete only when this returns.
        rows: (N,) of the type ROW.
        camera: That made the frames.
        sign: Called every now and then.

    Raises:
        OSError: The disk takes no more.
    """
    facts = {
        "expression_names": np.array(EXPRESSION_NAMES), "arkit_names": np.array(ARKIT_NAMES),
        "focal_px": np.array(camera.focal_px, np.float32),
        "size_px": np.array(camera.size_px, np.int32), "mode": np.array(mode_of(rows)),
    }  # fmt: skip
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name in ROW.names or ():
            sign()
            kind, shape = _layout(name)
            _write(archive, name, (kind, (len(rows), *shape)), (some[name] for some in cut(rows)))
        arkit = (_arkit(some) for some in cut(rows))
        _write(archive, "arkit", ("<f4", (len(rows), len(ARKIT_NAMES))), arkit)
        for name, value in facts.items():
            _write(archive, name, (value.dtype.str, value.shape), [value])


def cut(rows: Rows) -> Iterator[Rows]:
    """Return the rows in stretches that fit into memory."""
    return (rows[start : start + AT_ONCE] for start in range(0, len(rows), AT_ONCE))


def mode_of(rows: Rows) -> str:
    """Return the mode of all rows: that of each, or "auto" where they differ."""
    modes = np.unique(rows["frame_mode"])
    return str(modes[0]) if len(modes) == 1 else "auto"


def read_columns(path: Path) -> Rows:
    """Return the rows (N,) of a file that `write_columns` wrote.

    Raises:
        OSError, KeyError, ValueError, BadZipFile and what else zipfile and numpy make of damage:
            It is not such a file.
    """
    # numpy does not close what it opened where the archive is damaged.
    with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
        rows = np.zeros(len(stored["time_s"]), ROW)
        for name in ROW.names or ():
            rows[name] = stored[name]
    return rows


def _layout(name: str) -> tuple[str, tuple[int, ...]]:
    fields: Any = ROW.fields
    kind, shape = fields[name][0].subdtype or (fields[name][0], ())
    return kind.str, shape


def _arkit(rows: Rows) -> Rows:
    whole = arkit_from(rows["expression"].astype(float), rows["gaze_rad"].astype(float))
    return whole.astype("<f4")


def _write(
    archive: zipfile.ZipFile, name: str, layout: tuple[str, tuple[int, ...]], pieces: Iterable[Rows]
) -> None:
    """Write one array, piece by piece."""
    header = {"descr": layout[0], "fortran_order": False, "shape": layout[1]}
    with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
        np.lib.format.write_array_header_1_0(file, header)
        for piece in pieces:
            file.write(np.ascontiguousarray(piece).tobytes())
