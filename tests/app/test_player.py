"""The player and a source that waits for its camera."""

import threading

import pytest

from app.capture.source import ClosedOnExit
from app.controllers.player import Performer, Player, Wanted


class Waiting(ClosedOnExit):
    """A camera that is gone."""

    size_px, fps, name, live = (4, 4), 30.0, "Desk camera", True
    trouble = "The camera Desk camera is gone. Waiting for it."

    def __init__(self):
        self.left, self.closed = threading.Event(), False

    def read(self):
        self.left.wait()

    def interrupt(self):
        self.left.set()

    def close(self):
        self.closed = True


class Tools:
    def __init__(self):
        self.source = Waiting()

    def open_source(self, key, began_again):
        return self.source

    def open_free(self):
        return Performer(Tracker(), None)


class Tracker:
    def reset(self):
        pass


@pytest.fixture
def played(qtbot):
    """A player and what it opens; it goes when all that it began has gone."""
    tools = Tools()
    player = Player(tools, lambda *_: None)
    yield player, tools
    player.stop()
    qtbot.wait(1)
    player.deleteLater()


def test_a_source_that_waits_for_its_camera_says_so_and_is_left_at_once(qtbot, played):
    player, tools = played
    failed = []
    player.failed.connect(failed.append)
    assert player.trouble == ""
    player.play(Wanted("camera:0", ""))
    qtbot.waitUntil(lambda: "Waiting for it" in player.trouble)
    # Without an interruption this would wait for ever.
    player.stop()
    assert tools.source.closed and not player.busy
    assert player.trouble == "" and not failed


def test_another_wish_does_not_wait_for_a_camera_that_is_gone(qtbot, played):
    player, tools = played
    player.play(Wanted("camera:0", ""))
    qtbot.waitUntil(lambda: player.trouble != "")
    first, tools.source = tools.source, Waiting()
    player.play(Wanted("camera:1", ""))
    qtbot.waitUntil(lambda: first.closed and player.trouble != "")
