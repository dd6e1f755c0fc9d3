"""What is behind a figure: walls, colours, pictures, a blurred frame."""

from collections.abc import Sequence

import cv2
import numpy as np

from core.records import U8, FloatArray

#: Least height of the small picture that is blurred; more is not to be seen afterwards.
_SMALL_PX = 54
#: Spread of the blur, in heights of the picture.
_SPREAD = 0.045
#: A blurred frame is a little darker, so that the figure stands out.
_DIMMED = 0.82


def studio_backdrop(size_px: tuple[int, int], tint: FloatArray) -> U8:
    """Return a grey-blue wall, lit behind the head, (H, W, 3) uint8.

    Args:
        size_px: (width, height).
        tint: (3,) factor on its colours.
    """
    width, height = size_px
    y, x = np.mgrid[0:height, 0:width]
    away = np.hypot((x / width - 0.5) * width / height, y / height - 0.4)
    # Grain hides the steps between grey levels.
    grain = np.random.default_rng(5).uniform(-0.7, 0.7, (height, width))
    wall = tint * [92.0, 100.0, 110.0] * (1.28 - 0.85 * away)[..., None] + grain[..., None]
    return np.asarray(np.clip(wall, 0, 255).astype(np.uint8))


def plain_backdrop(size_px: tuple[int, int], color: Sequence[float]) -> U8:
    """Return one colour, (H, W, 3) uint8."""
    width, height = size_px
    return np.full((height, width, 3), color, np.uint8)


def covering(picture: U8, size_px: tuple[int, int]) -> U8:
    """Return the middle of a picture (h, w, 3) that fills a size, (H, W, 3), undistorted."""
    width, height = size_px
    cut = _middle(picture, width / height)
    smaller = cut.shape[0] > height
    how = cv2.INTER_AREA if smaller else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(cut, (width, height), interpolation=how), np.uint8)


def blurred(rgb: U8, size_px: tuple[int, int], mirrored: bool) -> U8:
    """Return a frame (h, w, 3) out of focus, filling a size, (H, W, 3).

    It is blurred while it is small, and made small by a whole number, which OpenCV does four
    times as fast: half a millisecond in all.
    """
    width, height = size_px
    cut = _middle(rgb, width / height)
    times = max(1, min(cut.shape[0] // _SMALL_PX, cut.shape[1] // 2))
    rows, columns = cut.shape[0] // times, cut.shape[1] // times
    cut = cut[: rows * times, : columns * times]
    small = cv2.resize(cut, (columns, rows), interpolation=cv2.INTER_AREA)
    spread_px = max(_SPREAD * rows, 0.3)
    soft = cv2.GaussianBlur(small, (0, 0), spread_px, borderType=cv2.BORDER_REPLICATE)
    dim = cv2.convertScaleAbs(soft[:, ::-1] if mirrored else soft, alpha=_DIMMED)
    return np.asarray(cv2.resize(dim, (width, height), interpolation=cv2.INTER_LINEAR), np.uint8)


def _middle(picture: U8, aspect: float) -> U8:
    """Return the largest part of a picture, about its middle, of an aspect (width / height)."""
    height, width = picture.shape[:2]
    wide, high = min(width, round(height * aspect)), min(height, round(width / aspect))
    left, top = (width - max(wide, 1)) // 2, (height - max(high, 1)) // 2
    return picture[top : top + max(high, 1), left : left + max(wide, 1)]
