"""A video of the source with its landmarks beside the avatar."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from app.errors import OutputError
from app.recording.sink import PartialFile
from core.landmarks import CURVES, N_INTERNAL
from core.records import U8, FaceState, Frame

#: The last landmarks stand for the outline but lie on the skin: they are dots, not a line.
DRAWN_CURVES = [list(curve) for curve in CURVES if max(curve) < N_INTERNAL]
#: Landmark curves in the picture, RGB.
LINE_COLOR = (90, 230, 120)
#: A frame around the source while no face is tracked, RGB.
LOST_COLOR = (230, 60, 60)
#: Positions are drawn to 1/16 px.
SHIFT_BITS = 4


class SideBySideVideo:
    """Writes .mp4 (MPEG-4) or .avi files twice as wide as the source."""

    def __init__(
        self,
        path: Path,
        fps: float,
        size_px: tuple[int, int],
        draw_avatar: Callable[[FaceState], U8],
    ) -> None:
        """Open the file.

        Args:
            path: Its suffix chooses the container.
            fps: Frames per second.
            size_px: (width, height) of the source.
            draw_avatar: Gives the avatar's picture (H, W, 3 or 4) RGB, of any size.

        Raises:
            OutputError: Nothing can be written there, or OpenCV knows no such container.
        """
        self._part, self._draw_avatar = PartialFile(path), draw_avatar
        # MPEG-4 halves the colour planes, so both sides must be even.
        self._size_px = (size_px[0] // 2 * 2, size_px[1] // 2 * 2)
        code = cv2.VideoWriter.fourcc(*"mp4v")
        whole = (2 * self._size_px[0], self._size_px[1])
        self._writer = cv2.VideoWriter(str(self._part.path), code, fps, whole)
        if not self._writer.isOpened():
            self._part.discard()
            raise OutputError(path, f"OpenCV writes no {path.suffix or 'such'} video; use .mp4")

    def write(self, frame: Frame, state: FaceState) -> None:
        """Add the picture of the next frame."""
        pair = side_by_side(frame, state, self._draw_avatar(state), self._size_px)
        self._writer.write(cv2.cvtColor(pair, cv2.COLOR_RGB2BGR))

    def finish(self) -> None:
        """Complete the video.

        Raises:
            OutputError: It cannot be put in place; an older file of that name is unchanged.
        """
        self._writer.release()
        self._part.finish()

    def discard(self) -> None:
        """Leave everything as it was before."""
        self._writer.release()
        self._part.discard()


def side_by_side(frame: Frame, state: FaceState, avatar: U8, size_px: tuple[int, int]) -> U8:
    """Return the source with its landmarks beside the avatar, (H, 2 W, 3).

    Args:
        frame: The source's picture.
        state: Solved from it.
        avatar: (h, w, 3 or 4) of any size.
        size_px: (W, H) of each half, at most the frame's.
    """
    width, height = size_px
    source = annotated(frame.rgb, state)[:height, :width]
    return np.concatenate([source, letterboxed(avatar[..., :3], size_px)], axis=1)


def annotated(rgb: U8, state: FaceState) -> U8:
    """Return a copy of the picture (H, W, 3) with the landmarks, or a red frame if lost."""
    picture = np.ascontiguousarray(rgb).copy()
    if state.lost:
        last = (picture.shape[1] - 1, picture.shape[0] - 1)
        cv2.rectangle(picture, (0, 0), last, LOST_COLOR, 4)
        return picture
    points = np.round(state.landmarks_px * 2**SHIFT_BITS).astype(np.int32)
    curves = [points[curve].reshape(-1, 1, 2) for curve in DRAWN_CURVES]
    cv2.polylines(picture, curves, False, LINE_COLOR, 1, cv2.LINE_AA, SHIFT_BITS)
    for x, y in points.tolist():
        cv2.circle(picture, (x, y), 2**SHIFT_BITS, LINE_COLOR, -1, cv2.LINE_AA, SHIFT_BITS)
    return picture


def letterboxed(picture: U8, size_px: tuple[int, int]) -> U8:
    """Return the whole picture scaled into this size, on black.

    Args:
        picture: (H, W, 3).
        size_px: (width, height).
    """
    width, height = size_px
    factor = min(width / picture.shape[1], height / picture.shape[0])
    inner = (
        max(1, min(width, round(picture.shape[1] * factor))),
        max(1, min(height, round(picture.shape[0] * factor))),
    )
    scaled = cv2.resize(np.ascontiguousarray(picture), inner, interpolation=cv2.INTER_AREA)
    out = np.zeros((height, width, 3), np.uint8)
    left, top = (width - inner[0]) // 2, (height - inner[1]) // 2
    out[top : top + inner[1], left : left + inner[0]] = scaled
    return out
