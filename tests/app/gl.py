"""A renderer for tests, and measures of how much two pictures differ."""

import numpy as np
import pytest

from app.render.context import RenderError
from app.render.renderer import Renderer


def renderer_or_skip():
    try:
        return Renderer()
    except RenderError as error:
        pytest.skip(f"no OpenGL here: {error}")


def silhouette_overlap(picture, other):
    """Return intersection over union of what is drawn, by alpha."""
    a, b = picture[..., 3] > 127, other[..., 3] > 127
    return (a & b).sum() / (a | b).sum()


def share_off(picture, other, levels=8):
    """Return the share of the drawn pixels with a colour off by more than some levels."""
    drawn = (picture[..., 3] > 127) | (other[..., 3] > 127)
    off = np.abs(picture[..., :3].astype(int) - other[..., :3].astype(int)).max(axis=2) > levels
    return off[drawn].mean()
