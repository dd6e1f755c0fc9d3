"""A picture of a few frames spread over a track, and its states."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from app.recording.sink import PartialFile
from app.recording.video import side_by_side
from core.records import U8, FaceState, Frame

#: Frames shown, in two columns.
N_SHOWN, COLUMNS = 6, 2


class Highlights:
    """Keeps every state, and writes source and avatar of a few frames as one picture.

    Attributes:
        states: All so far.
    """

    def __init__(
        self,
        path: Path,
        size_px: tuple[int, int],
        draw_avatar: Callable[[FaceState], U8],
        n_frames: int,
    ) -> None:
        """Claim the file.

        Args:
            path: A .png or .jpg.
            size_px: (width, height) of the source.
            draw_avatar: Gives the avatar's picture (H, W, 3 or 4) RGB, of any size.
            n_frames: Frames that will come.

        Raises:
            OutputError: Nothing can be written there.
        """
        self._part, self._size_px, self._draw_avatar = PartialFile(path), size_px, draw_avatar
        ends = np.linspace(0, n_frames, N_SHOWN + 1)
        self._shown = set(((ends[:-1] + ends[1:]) / 2).astype(int).tolist())
        self._tiles: list[U8] = []
        self.states: list[FaceState] = []

    def write(self, frame: Frame, state: FaceState) -> None:
        """Take the next frame."""
        if len(self.states) in self._shown:
            avatar = self._draw_avatar(state)
            self._tiles.append(side_by_side(frame, state, avatar, self._size_px))
        self.states.append(state)

    def finish(self) -> None:
        """Write the picture, if there was a frame to show.

        Raises:
            OutputError: It cannot be put in place.
        """
        if not self._tiles:
            self._part.discard()
            return
        blank = np.zeros_like(self._tiles[0])
        tiles = self._tiles + [blank] * (-len(self._tiles) % COLUMNS)
        rows = [np.hstack(tiles[n : n + COLUMNS]) for n in range(0, len(tiles), COLUMNS)]
        sheet = cv2.cvtColor(np.vstack(rows), cv2.COLOR_RGB2BGR)
        _, encoded = cv2.imencode(self._part.target.suffix, sheet)
        self._part.path.write_bytes(encoded.tobytes())
        self._part.finish()

    def discard(self) -> None:
        """Leave everything as it was before."""
        self._part.discard()
