"""The avatar lives on while its camera is gone."""

import time
from dataclasses import replace

from app.controllers.desk import open_desk
from app.drive_files import FIRST
from core.drive_settings import IdleSettings
from tests.app.live_fakes import FakeSource, FakeToolbox
from tests.core.driven_faces import index


class GoneCamera(FakeSource):
    """Gives frames until it is unplugged, then waits."""

    trouble = ""
    stopped = False

    def read(self):
        while self.trouble and not self.stopped:
            time.sleep(0.005)
        return None if self.stopped else super().read()

    def interrupt(self):
        self.stopped = True


def test_while_the_camera_is_gone_the_avatar_goes_to_rest_and_lives_on(qtbot):
    toolbox, opened = FakeToolbox(), []
    toolbox.open_source = lambda key, _: opened.append(GoneCamera(toolbox, key, 80)) or opened[0]
    window, controller = open_desk(toolbox)
    qtbot.addWidget(window)
    window.show()
    controller.start()
    qtbot.waitUntil(lambda: len(toolbox.wishes) > 10)
    controller.drive.use(replace(FIRST, idle=IdleSettings(hold_s=0.1, blinking="always")))
    opened[0].trouble = "The camera is gone."
    qtbot.wait(100)
    before = len(toolbox.wishes)

    def blinked():
        return any(w.state.expression[index("eyeBlinkLeft")] > 0.8 for w in toolbox.wishes[before:])

    qtbot.waitUntil(blinked, timeout=10_000)
    assert all(wish.state.lost for wish in toolbox.wishes[before + 5 :])
    opened[0].trouble = ""
    qtbot.waitUntil(lambda: not toolbox.wishes[-1].state.lost)
    window.close()
