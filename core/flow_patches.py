"""Small pictures of the eyes and the mouth that hold still while the head moves.

Lids and lips move in ways that flow follows badly. That they moved shows in these pictures, at
hardly any cost.
"""

import cv2
import numpy as np

from core.landmarks import NAMES
from core.records import F32, U8, FloatArray

#: Width and height of the three pictures: right eye, left eye, mouth.
PATCH_SIZES = ((16, 10), (16, 10), (18, 14))
#: Smallest contrast in grey levels that is stretched; less is a plain surface.
_LEAST_CONTRAST = 6.0


def _index(name: str) -> int:
    return NAMES.index(name)


_EYES = tuple((_index(f"{s}_eye_outer"), _index(f"{s}_eye_inner")) for s in "RL")
_SUBNASALE = _index("subnasale")


def frames_of(points_px: FloatArray) -> FloatArray:
    """Return the maps (3, 2, 3) from the unit squares of right eye, left eye and mouth.

    They hang on the corners of the eyes and the base of the nose, which lids and lips move least.

    Args:
        points_px: (P, 2), the internal landmarks first.
    """
    corners = points_px[np.array(_EYES)]  # eye, outer and inner, xy
    middle = corners.mean(axis=(0, 1))
    down = points_px[_SUBNASALE] - middle
    across = corners[1, 0] - corners[0, 0]
    return np.stack(
        [
            _frame(corners[0].mean(axis=0), 1.5 * (corners[0, 1] - corners[0, 0]), 0.75 * down),
            _frame(corners[1].mean(axis=0), 1.5 * (corners[1, 0] - corners[1, 1]), 0.75 * down),
            _frame(points_px[_SUBNASALE] + 0.62 * down, 0.9 * across, 1.2 * down),
        ]
    )


def _frame(center: FloatArray, wide: FloatArray, high: FloatArray) -> FloatArray:
    return np.column_stack([wide, high, center - 0.5 * wide - 0.5 * high])


def patches(picture: U8, points_px: FloatArray) -> list[F32]:
    """Return the pictures of right eye, left eye and mouth, flat, mean 0 and contrast 1.

    Args:
        picture: (H, W) grey.
        points_px: (P, 2), the internal landmarks first.
    """
    return [
        _patch(picture, frame, size)
        for frame, size in zip(frames_of(points_px), PATCH_SIZES, strict=True)
    ]


def _patch(picture: U8, frame: FloatArray, size: tuple[int, int]) -> F32:
    step = frame[:, :2] / np.array(size)
    start = frame[:, 2] + step @ [0.5, 0.5]
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    warp = np.column_stack([step, start])
    raw = cv2.warpAffine(picture, warp, size, flags=flags, borderMode=cv2.BORDER_REPLICATE)
    flat = raw.ravel().astype(np.float32)
    flat -= flat.mean()
    contrast = float(np.sqrt(flat @ flat / len(flat)))
    return np.asarray(flat / max(contrast, _LEAST_CONTRAST))


def difference(one: F32, other: F32) -> float:
    """Return 0 for equal pictures, about 1 for unrelated and 2 for opposite ones."""
    apart = one - other
    return 0.5 * float(apart @ apart) / len(apart)
