"""What is behind a figure: walls, colours, pictures, a blurred frame."""

from collections.abc import Sequence

import cv2
import numpy as np

from core.records import U8, FloatArray

#: Height of the small picture that is blurred; more is not to be seen afterwards.
_SMALL_PX = 54
#: Spread of the blur in that picture.
_SPREAD_PX = 2.4
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

    It is blurred while it is small, which costs less than the frame itself does to convert.
    """
    width, height = size_px
    small_px = max(2, round(_SMALL_PX * width / height)), _SMALL_PX
    small = cv2.resize(_middle(rgb, width / height), small_px, interpolation=cv2.INTER_AREA)
    soft = cv2.GaussianBlur(small, (0, 0), _SPREAD_PX, borderType=cv2.BORDER_REPLICATE)
    dim = cv2.convertScaleAbs(soft[:, ::-1] if mirrored else soft, alpha=_DIMMED)
    return np.asarray(cv2.resize(dim, (width, height), interpolation=cv2.INTER_LINEAR), np.uint8)


def _middle(picture: U8, aspect: float) -> U8:
    """Return the largest part of a picture, about its middle, of an aspect (width / height)."""
    height, width = picture.shape[:2]
    wide, high = min(width, round(height * aspect)), min(height, round(width / aspect))
    left, top = (width - max(wide, 1)) // 2, (height - max(high, 1)) // 2
    return picture[top : top + max(high, 1), left : left + max(wide, 1)]
