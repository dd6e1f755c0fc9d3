"""The small pictures of windows that tests compare with, and the program that makes them.

Run `python -m tests.app.page_pictures` after a window was changed on purpose, and look at it in
full size first. Small, because letters differ from one machine to the next and blocks do not.
"""

import tempfile
from pathlib import Path

import cv2
import numpy as np
import pytest
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QColor, QImage, QPalette
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.controllers.desk import open_desk
from tests.app.killed_setup import Bot, point_dragged
from tests.app.live_fakes import FakeToolbox
from tests.app.setup_fakes import begin, open_setup, seen_people, shoot

FOLDER = Path(__file__).resolve().parents[1] / "data" / "pages"
SIZE, SMALL = QSize(1280, 720), QSize(64, 36)
#: Furthest mean difference of grey levels, and share of cells that may differ by more than BLOCK.
MEAN, BLOCK, SHARE = 3.0, 24.0, 0.03


def use_light_theme():
    """Make windows look the same whatever the machine's theme is."""
    application = QApplication.instance()
    application.setStyle("Fusion")
    palette = QPalette(QColor(239, 239, 239), QColor(239, 239, 239))
    application.setPalette(palette)


def live_first(bot, root, monkeypatch):
    window, controller = open_desk(FakeToolbox(cameras=()))
    window.resize(SIZE)
    window.show()
    controller.start()
    bot.waitUntil(lambda: not window.source_pane.has_picture, timeout=60_000)
    return window


def live_tracking(bot, root, monkeypatch):
    window, controller = open_desk(FakeToolbox(profiles=("me",)))
    window.resize(SIZE)
    window.show()
    controller.start()
    bot.waitUntil(
        lambda: window.source_pane.has_picture and window.avatar_pane.has_picture, timeout=60_000
    )
    return window


def setup_start(bot, root, monkeypatch):
    return open_setup(bot, root, {}, monkeypatch).window


def setup_camera(bot, root, monkeypatch):
    setup = open_setup(bot, root, {}, monkeypatch)
    setup.window.start.name.setText("me")
    setup.window.start.begin_button.click()
    bot.waitUntil(setup.window.next_button.isEnabled, timeout=60_000)
    return setup.window


def setup_pictures(bot, root, monkeypatch):
    setup = open_setup(bot, root, seen_people(), monkeypatch)
    page = begin(bot, setup)
    for taken in range(1, 4):
        QTest.keyClick(setup.window, Qt.Key.Key_Space)
        bot.waitUntil(lambda: page.progress.value() == taken, timeout=60_000)  # noqa: B023
    bot.waitUntil(lambda: not page.live.guide.flash, timeout=60_000)
    return setup.window


def setup_landmarks(bot, root, monkeypatch):
    setup = open_setup(bot, root, seen_people(), monkeypatch)
    point_dragged(bot, setup)
    return setup.window


def setup_training(bot, root, monkeypatch):
    setup = open_setup(bot, root, seen_people(), monkeypatch)
    begin(bot, setup)
    shoot(bot, setup, 14)
    setup.controller.show("train")
    return setup.window


PAGES = {
    one.__name__: one
    for one in (
        live_first, live_tracking, setup_start, setup_camera, setup_pictures, setup_landmarks,
        setup_training,
    )
}  # fmt: skip


def small_picture(window):
    """Return a window's picture (36, 64, 3), one cell for 20 by 20 pixels."""
    image = window.grab().toImage().scaled(
        SMALL, Qt.AspectRatioMode.IgnoreAspectRatio, Qt.TransformationMode.SmoothTransformation
    )  # fmt: skip
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), -1)
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).copy()


def differences(picture, reference):
    """Return the mean difference of two small pictures, and the share of cells far apart."""
    apart = np.abs(picture.astype(float) - reference).mean(axis=2)
    return float(apart.mean()), float((apart > BLOCK).mean())


def alike(picture, reference):
    mean, share = differences(picture, reference)
    return mean < MEAN and share < SHARE


def stored(name):
    picture = cv2.imread(str(FOLDER / f"{name}.png"))
    return cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)


def main():
    application = QApplication([])
    use_light_theme()
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, page in PAGES.items():
        with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
            patch.setenv("FACEPUPPET_HOME", folder)
            window = page(Bot(), Path(folder) / "profiles", patch)
            application.processEvents()
            picture = small_picture(window)
            cv2.imwrite(str(FOLDER / f"{name}.png"), cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
            window.close()
            application.processEvents()


if __name__ == "__main__":
    main()
