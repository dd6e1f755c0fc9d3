"""A track as a table: one row per frame, for spreadsheets."""

import csv
from contextlib import suppress
from pathlib import Path

import numpy as np

from app.recording.sink import PartialFile
from core.arkit import ARKIT_NAMES, EXPRESSION_NAMES, arkit_from
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.records import FaceState, Frame

#: The columns; angles positive to the subject's left, up, and towards the left shoulder.
HEADER: tuple[str, ...] = (
    "frame", "time_s", "lost", "confidence", "mode",
    "yaw_deg", "pitch_deg", "roll_deg", "x_mm", "y_mm", "z_mm",
    "rotation_w", "rotation_x", "rotation_y", "rotation_z",
    "right_gaze_yaw_deg", "right_gaze_pitch_deg", "left_gaze_yaw_deg", "left_gaze_pitch_deg",
    *EXPRESSION_NAMES,
    *(f"arkit_{name}" for name in ARKIT_NAMES),
)  # fmt: skip


class Table:
    """Writes the states of a track as .csv."""

    def __init__(self, path: Path) -> None:
        """Claim the file.

        Raises:
            OutputError: Nothing can be written there.
        """
        self._part = PartialFile(path)
        self._file = self._part.path.open("w", newline="", encoding="utf-8")
        self._rows = csv.writer(self._file)
        self._rows.writerow(HEADER)

    def write(self, frame: Frame, state: FaceState) -> None:
        """Add the row of the next frame."""
        self._rows.writerow(row(frame.index, state))

    def finish(self) -> None:
        """Complete the table.

        Raises:
            OutputError: It cannot be put in place; an older file of that name is unchanged.
        """
        self._file.close()
        self._part.finish()

    def discard(self) -> None:
        """Leave everything as it was before."""
        # What was not written yet finds no place on a full disk.
        with suppress(OSError):
            self._file.close()
        self._part.discard()


def row(index: int, state: FaceState) -> list[str]:
    """Return the row of one frame in the order of HEADER."""
    angles = head_angles_from_matrix(matrix_from_quaternion(state.rotation_wxyz))
    numbers = np.concatenate(
        [
            np.rad2deg(angles),
            state.translation_mm,
            state.rotation_wxyz,
            np.rad2deg(state.gaze_rad).ravel(),
            state.expression,
            arkit_from(state.expression, state.gaze_rad),
        ]
    )
    lost = str(int(state.lost))
    start = [str(index), f"{state.time_s:.4f}", lost, f"{state.confidence:.3f}", state.mode]
    return start + [f"{number:.5g}" for number in numbers]
