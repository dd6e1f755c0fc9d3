"""A guided setup that is killed at one of its steps: `python -m tests.app.killed_setup STEP ROOT`.

What `tests.app.test_killed_setup` finds afterwards is what a user finds after a power cut.
"""

import os
import sys
import time
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from tests.app.setup_fakes import begin, open_setup, seen_people, shoot

#: Exit code of the kill, where the system has no signal for it.
KILLED = 9


class Bot:
    """As much of pytest-qt's bot as the setup's helpers need."""

    def addWidget(self, widget):
        self.widget = widget

    def waitUntil(self, told, timeout):
        until_s = time.monotonic() + timeout / 1000
        while not told():
            if time.monotonic() > until_s:
                raise TimeoutError(told)
            QApplication.processEvents()
            time.sleep(0.002)


def die():
    """End at once, without any goodbye."""
    os._exit(KILLED)


def name_typed(bot, setup):
    setup.window.start.name.setText("me")


def camera_checked(bot, setup):
    name_typed(bot, setup)
    setup.window.start.begin_button.click()
    bot.waitUntil(setup.window.next_button.isEnabled, timeout=5000)


def pictures_taken(bot, setup):
    begin(bot, setup)
    shoot(bot, setup, 14)


def nudge_a_point(bot, editor):
    """Choose a landmark by a click and move it by a key."""
    canvas = editor.parent().canvas

    def chosen():
        # The picture finds its place only after the page has been shown.
        x, y = canvas.scene.points_px[0]
        point = canvas.zoom.to_widget(float(x), float(y)).toPoint()
        QTest.mouseClick(canvas, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, point)
        return bool(editor.selected)

    bot.waitUntil(chosen, timeout=60_000)
    QTest.keyClick(canvas, Qt.Key.Key_Left)


def point_dragged(bot, setup):
    pictures_taken(bot, setup)
    setup.controller.show("check")
    bot.waitUntil(lambda: setup.controller.editor is not None, timeout=120_000)
    nudge_a_point(bot, setup.controller.editor)


def training_begun(bot, setup):
    pictures_taken(bot, setup)
    setup.controller.show("train")
    heard = []
    setup.controller.training._maker.progressed.connect(lambda *_: heard.append(1))
    setup.window.train.train_button.click()
    bot.waitUntil(lambda: heard, timeout=5000)


STEPS = {
    "start": name_typed, "camera": camera_checked, "capture": pictures_taken,
    "check": point_dragged, "train": training_begun,
}  # fmt: skip


def main(step, root):
    application = QApplication([])
    bot = Bot()
    setup = open_setup(bot, Path(root), seen_people(), pytest.MonkeyPatch())
    STEPS[step](bot, setup)
    application.processEvents()
    die()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
