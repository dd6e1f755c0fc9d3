"""A head without hair: of a skin's texture on which a scalp with hair is painted."""

from pathlib import Path

import cv2
import numpy as np

from app.avatars.looks import Looks, linear
from core.records import F32, U8

#: How far the border between forehead and scalp is spread, as a share of the texture's size.
_SPREAD = 0.012
#: Share of the hair's colour that shaved roots leave.
_ROOTS = 0.05


def shaved(skin: U8, scalp_map: Path, looks: Looks) -> U8:
    """Return a skin's texture (S, S, 4) whose scalp is skin, too, with a soft hairline.

    Args:
        skin: Colour and oiliness, the scalp painted with roots of hair.
        scalp_map: Picture of where hair grows on it.
        looks: With the colours of the skin and the hair.
    """
    size = len(skin)
    grown = cv2.imread(str(scalp_map), cv2.IMREAD_GRAYSCALE)
    if grown is None:
        raise FileNotFoundError(f"{scalp_map} is damaged: install facepuppet again")
    sigma = _SPREAD * size
    where = cv2.resize(grown, (size, size)).astype(np.float32) / 255
    # What thins out at the border is covered as a whole; then the border is spread.
    reach = 2 * round(sigma) + 1
    where = cv2.dilate(np.minimum(4 * where, 1), np.ones((reach, reach), np.uint8))
    where = cv2.GaussianBlur(where, (0, 0), sigma / 2)[..., None]
    bare = (1 - _ROOTS) * linear(looks.skin) + _ROOTS * linear(looks.hair)
    color: F32 = np.square(skin[..., :3].astype(np.float32) / 255)
    color += where * (bare.astype(np.float32) - color)
    out = skin.copy()
    out[..., :3] = 255 * np.sqrt(color) + 0.5
    return out
