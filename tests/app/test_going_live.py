"""Facts about what is played when the guided setup is left for the live window."""

from PySide6.QtWidgets import QWidget

from app.commands.guided import go_live
from app.controllers import toolbox
from tests.app.live_fakes import CAMERA, FakeToolbox


def test_the_live_window_plays_the_source_and_the_profile_of_the_setup(qtbot, monkeypatch):
    other = "camera:7"
    tools = FakeToolbox(cameras=(CAMERA, other), profiles=("me",))
    monkeypatch.setattr(toolbox, "Toolbox", lambda: tools)
    before = QWidget()
    qtbot.addWidget(before)
    window = go_live(before, "me", other)
    qtbot.addWidget(window)
    qtbot.waitUntil(lambda: {one.key for one in tools.open_now} == {other}, timeout=10_000)
    qtbot.waitUntil(lambda: window.source_pane.has_picture, timeout=10_000)
    window.close()
