"""Every page looks as it did when somebody looked at it, and the comparison sees what is wrong."""

import itertools

import numpy as np
import pytest
from PySide6.QtWidgets import QApplication

from tests.app.killed_setup import Bot
from tests.app.page_pictures import (
    PAGES,
    alike,
    differences,
    small_picture,
    stored,
    use_light_theme,
)


@pytest.fixture(autouse=True)
def light(qapp):
    style, palette = qapp.style().objectName(), qapp.palette()
    use_light_theme()
    yield
    qapp.setStyle(style)
    qapp.setPalette(palette)


@pytest.mark.parametrize("name", PAGES)
def test_a_page_looks_as_it_should(qapp, tmp_path, monkeypatch, name):
    window = PAGES[name](Bot(), tmp_path / "profiles", monkeypatch)
    QApplication.processEvents()
    picture = small_picture(window)
    window.close()
    QApplication.processEvents()
    assert alike(picture, stored(name)), differences(picture, stored(name))


@pytest.mark.parametrize("one, other", list(itertools.combinations(PAGES, 2)))
def test_no_page_passes_for_another(one, other):
    assert not alike(stored(one), stored(other))


@pytest.mark.parametrize("name", PAGES)
def test_a_page_with_something_missing_shifted_or_dark_is_seen(name):
    right = stored(name)
    empty = right.copy()
    empty[8:28, 10:54] = right[0, 0]
    if not np.array_equal(empty, right):
        assert not alike(empty, right)
    assert not alike(np.roll(right, 4, axis=0), right)
    assert not alike(255 - right, right)
