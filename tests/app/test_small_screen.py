"""The live window on a small screen: 1280 x 720 at one and a half times the size."""

import pytest
from PySide6.QtCore import QSize

from app.controllers.desk import open_desk
from tests.app.live_fakes import FakeToolbox

SMALL = QSize(853, 480)


@pytest.fixture
def window(qtbot):
    window, controller = open_desk(FakeToolbox())
    qtbot.addWidget(window)
    window.resize(SMALL)
    window.show()
    controller.start()
    yield window
    window.close()


def fits(size):
    return size.boundedTo(SMALL) == size


def test_the_window_fits_with_any_panel_open(window, qtbot):
    for key in window.panels.keys:
        window.panels.show(key)
        qtbot.waitUntil(window.panels.dock(key).isVisible)
        # The layout is computed anew in the event loop.
        qtbot.waitUntil(lambda: fits(window.minimumSizeHint()))
        window.panels.dock(key).hide()


def test_what_has_no_room_in_a_row_comes_again_with_the_room(window, qtbot):
    window.resize(500, 480)
    qtbot.waitUntil(lambda: not window.landmarks_box.isVisible())
    assert window.sources.isVisible() and window.avatars.isVisible()
    window.resize(1240, 600)
    qtbot.waitUntil(window.landmarks_box.isVisible)
    assert window.new_profile_button.isVisible() and window.mirror_box.isVisible()
