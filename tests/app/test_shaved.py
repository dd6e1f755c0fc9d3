"""A head without hair."""

import cv2
import numpy as np
import pytest

from app.avatars.complexion import skin_texture
from app.avatars.looks import LOOKS
from app.avatars.shaved import shaved
from app.resources import asset

MAPS = asset("textures") / "skin"
SIZE = 512


@pytest.fixture(scope="module")
def looks():
    return LOOKS["light"]


@pytest.fixture(scope="module")
def haired(looks):
    return skin_texture(MAPS, looks, SIZE)


def test_a_shaved_scalp_is_skin_with_no_edge(haired, looks):
    bald = shaved(haired, MAPS / "scalp.jpg", looks)
    scalp = cv2.resize(cv2.imread(str(MAPS / "scalp.jpg"), cv2.IMREAD_GRAYSCALE), (SIZE, SIZE))
    wanted = np.array(looks.skin, float)
    assert np.abs(haired[scalp > 250, :3].mean(axis=0) - wanted).max() > 60
    assert np.abs(bald[scalp > 250, :3].mean(axis=0) - wanted).max() < 15
    # What is far from the scalp is as it was.
    away = cv2.dilate(scalp, np.ones((61, 61), np.uint8)) == 0
    np.testing.assert_array_equal(bald[away], haired[away])


def test_a_missing_map_is_reported(haired, looks):
    with pytest.raises(FileNotFoundError, match="install facepuppet again"):
        shaved(haired, MAPS / "none.jpg", looks)
