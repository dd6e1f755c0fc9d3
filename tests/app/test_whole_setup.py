"""The whole guided setup with the virtual performer as the camera: from the first page to live."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from app.controllers.capturing import QUICK
from app.controllers.live import LiveController
from app.controllers.setup_tools import PROMPTED, SetupTools
from app.controllers.setup_wizard import SetupController
from app.controllers.toolbox import Toolbox
from app.profiles import profile_folder
from app.sources import PERFORMER
from app.views.live_window import LiveWindow
from app.views.setup.setup_window import SetupWindow
from app.workbook import Workbook
from core.store import load
from tests.app.killed_setup import nudge_a_point

NAME = "mara"
#: Frames of 30 per second from one look to the next: a webcam of 10 frames per second.
STRIDE = 3
PATIENCE_MS = 300_000

pytestmark = pytest.mark.slow


class NoCameras(SetupTools):
    """The tools of a machine without a camera, whatever is plugged into this one."""

    def cameras(self):
        return []


def next_page(qtbot, window, step, controller):
    """Go on with the button, once it is possible."""
    qtbot.waitUntil(window.next_button.isEnabled, timeout=PATIENCE_MS)
    qtbot.mouseClick(window.next_button, Qt.MouseButton.LeftButton)
    assert controller.step == step


def test_a_newcomer_gets_from_the_first_page_to_a_live_avatar(qtbot, home):
    window = SetupWindow()
    qtbot.addWidget(window)
    controller = SetupController(window, NoCameras(STRIDE))
    wanted = []
    controller.live_wanted.connect(wanted.append)
    window.show()
    controller.start()

    # 1. Profile
    assert controller.step == "start" and not window.next_button.isEnabled()
    QTest.keyClicks(window.start.name, NAME)
    qtbot.mouseClick(window.start.begin_button, Qt.MouseButton.LeftButton)
    assert controller.step == "camera"

    # 2. Camera: only the performer is there.
    window.camera.camera_chosen.emit(PROMPTED)
    next_page(qtbot, window, "capture", controller)

    # 3. Twenty pictures, hands-free
    window.capture.plan_chosen.emit("quick")
    qtbot.waitUntil(lambda: controller.capturing.shot is None, timeout=PATIENCE_MS)
    states = window.capture.sheet.states()
    assert {name for name, state in states.items() if state != "missing"} == set(QUICK)
    assert sum(states[name] == "good" for name in QUICK) >= 15
    book = Workbook(profile_folder(NAME), lambda rgb: None)
    assert not any(book.quality(name).get("by_hand") for name in QUICK)

    # 4. Landmarks
    next_page(qtbot, window, "check", controller)
    qtbot.waitUntil(lambda: controller.editor is not None, timeout=PATIENCE_MS)
    assert controller.editor is not None
    nudge_a_point(qtbot, controller.editor)
    next_page(qtbot, window, "train", controller)
    book = Workbook(profile_folder(NAME), lambda rgb: None)
    assert sum(int(book.landmarks(name).edited.sum()) for name in QUICK) == 1

    # 5. Training
    qtbot.mouseClick(window.train.train_button, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(window.train.live_button.isEnabled, timeout=PATIENCE_MS)
    profile = load(profile_folder(NAME))
    assert set(profile.names) == set(QUICK)
    assert profile.eyes is not None
    assert "under 3 px" in window.train.report.toPlainText()

    # 6. Live
    qtbot.mouseClick(window.train.live_button, Qt.MouseButton.LeftButton)
    assert wanted == [NAME]
    window.close()
    puppeteer(qtbot)


def puppeteer(qtbot):
    """Follow the same person with the new profile, and see the avatar move."""
    window = LiveWindow()
    qtbot.addWidget(window)
    controller = LiveController(window, Toolbox())
    solved = []
    controller.solved.connect(solved.append)
    window.show()
    controller.start()
    window.source_chosen.emit(f"{PERFORMER}:mixed")
    window.profile_chosen.emit(NAME)

    def follows():
        return sum(one.state.mode == "trained" and not one.state.lost for one in solved) > 20

    qtbot.waitUntil(follows, timeout=PATIENCE_MS)
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture, timeout=PATIENCE_MS)
    moved = np.ptp([one.state.rotation_wxyz for one in solved[-20:]], axis=0)
    assert moved.max() > 1e-4
    window.close()
