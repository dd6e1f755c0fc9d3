"""A track as arrays: the .npz that `facepuppet track --out` writes. Its layout stays stable."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.errors import OutputError
from app.recording.sink import PartialFile, reason
from core.arkit import ARKIT_NAMES, EXPRESSION_NAMES, arkit_from
from core.records import Camera, FaceState, Frame


class TrackFile:
    """Collects the states of a track and writes them as .npz at the end."""

    def __init__(self, path: Path, camera: Callable[[], Camera], mode: str = "trained") -> None:
        """Claim the file.

        Args:
            path: Ends in .npz.
            camera: Tells at the end of the track which camera made its frames.
            mode: "trained" or "free", or "auto" where each frame has its own.

        Raises:
            OutputError: Nothing can be written there.
        """
        self._part, self._camera, self._mode = PartialFile(path), camera, mode
        self._states: list[FaceState] = []

    def write(self, frame: Frame, state: FaceState) -> None:
        """Take the next frame."""
        self._states.append(state)

    def finish(self) -> None:
        """Write the file.

        Raises:
            OutputError: It cannot be written; an older file of that name is unchanged.
        """
        try:
            with self._part.path.open("wb") as file:
                arrays = track_arrays(self._states, self._camera(), self._mode)
                np.savez_compressed(file, allow_pickle=False, **arrays)
        except OSError as error:
            self._part.discard()
            raise OutputError(self._part.target, reason(error)) from None
        self._part.finish()

    def discard(self) -> None:
        """Leave everything as it was before."""
        self._part.discard()


def track_arrays(states: Sequence[FaceState], camera: Camera, mode: str) -> dict[str, NDArray[Any]]:
    """Return a track of N frames as named arrays.

    Args:
        states: Of the frames.
        camera: That made them.
        mode: Of the whole track.

    Returns:
        time_s (N,) float64; lost (N,) bool; confidence (N,); landmarks_px (N, 75, 2);
        shape_mm (N, 75, 3) camera frame; rotation_wxyz (N, 4) and translation_mm (N, 3) model to
        camera; expression (N, 46) and arkit (N, 52), both in [0, 1], with expression_names and
        arkit_names; focal_px (); size_px (2,) width and height; mode (); with the mode "auto" also
        frame_mode (N,), the way in which each frame was solved. Numbers without a type here are
        float32.
    """

    def column(name: str, shape: tuple[int, ...]) -> NDArray[Any]:
        rows = [getattr(state, name) for state in states]
        return np.array(rows, np.float32).reshape(len(states), *shape)

    gaze_rad = column("gaze_rad", (2, 2)).astype(float)
    expression = column("expression", (len(EXPRESSION_NAMES),))
    arrays = {
        "time_s": np.array([state.time_s for state in states], np.float64),
        "lost": np.array([state.lost for state in states], np.bool_),
        "confidence": column("confidence", ()),
        "landmarks_px": column("landmarks_px", (75, 2)),
        "shape_mm": column("shape_mm", (75, 3)),
        "rotation_wxyz": column("rotation_wxyz", (4,)),
        "translation_mm": column("translation_mm", (3,)),
        "expression": expression,
        "expression_names": np.array(EXPRESSION_NAMES),
        "arkit": arkit_from(expression.astype(float), gaze_rad).astype(np.float32),
        "arkit_names": np.array(ARKIT_NAMES),
        "focal_px": np.array(camera.focal_px, np.float32),
        "size_px": np.array(camera.size_px, np.int32),
        "mode": np.array(mode),
    }
    if mode == "auto":
        arrays["frame_mode"] = np.array([state.mode for state in states], dtype="U7")
    return arrays
