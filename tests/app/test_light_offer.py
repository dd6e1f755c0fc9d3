"""Facts about the offer to add pictures in another light."""

import numpy as np
import pytest
from PySide6.QtCore import QObject, Signal

from app.controllers.desk import open_desk
from app.controllers.light_offer import ADD, LightOffer, read_light
from app.workers.job import Job
from core.light_change import LightChange, LightReference
from core.records import Progress
from tests.app.live_fakes import FakeToolbox
from tests.core.synthetic_fit import result_of

DARK = LightChange("dark", "It is much darker than in the setup pictures.", 1.0)


class FakeWatch:
    """Tells of a change as long as it is told to."""

    change = None
    steps = 0

    def __init__(self, reference):
        self.reference = reference

    def step(self, frame, state):
        FakeWatch.steps += 1
        return FakeWatch.change

    def reset(self):
        pass


class FakeGuided(QObject):
    finished = Signal(str)

    def __init__(self):
        super().__init__()
        self.asked = []

    def show(self):
        pass

    def add_pictures(self, profile, key):
        self.asked.append((profile, key))

    def close(self):
        self.finished.emit("")


def reference(profile):
    yield Progress(0, 1, "Reading")
    return LightReference(np.zeros((3, 15)))


@pytest.fixture
def desk(qtbot, monkeypatch):
    monkeypatch.setattr("app.controllers.light_offer.LightWatch", FakeWatch)
    FakeWatch.change, FakeWatch.steps = None, 0
    toolbox = FakeToolbox(profiles=["anna", "bert"])
    window, controller = open_desk(toolbox)
    qtbot.addWidget(window)
    controller.findChild(LightOffer)._read = reference
    window.show()
    controller.start()
    qtbot.waitUntil(lambda: FakeWatch.steps > 5, timeout=10000)
    yield window, controller, toolbox
    window.close()
    assert not any(job.isRunning() for job in controller.findChildren(Job))


def test_a_lasting_change_is_told_once_and_leads_to_the_setup(desk, qtbot):
    window, _, toolbox = desk
    assert window.message_bar.text == ""
    FakeWatch.change = DARK
    qtbot.waitUntil(lambda: "much darker" in window.message_bar.text, timeout=10000)
    (button,) = window.message_bar.buttons
    assert button.text() == ADD.text
    made = []
    toolbox.guided_setup = lambda source: made.append(FakeGuided()) or made[-1]
    button.click()
    qtbot.waitUntil(lambda: len(made) == 1 and bool(made[0].asked), timeout=10000)
    assert made[0].asked == [("anna", "light")]
    made[0].finished.emit("")
    steps = FakeWatch.steps
    qtbot.waitUntil(lambda: FakeWatch.steps > steps + 20, timeout=10000)
    assert window.message_bar.text == ""


def test_each_profile_is_told_of_its_own_light(desk, qtbot):
    window, _, _ = desk
    FakeWatch.change = DARK
    qtbot.waitUntil(lambda: "much darker" in window.message_bar.text, timeout=10000)
    window.message_bar.tell("")
    window.profile_chosen.emit("bert")
    qtbot.waitUntil(lambda: "much darker" in window.message_bar.text, timeout=10000)


def test_a_stranger_is_told_nothing(desk, qtbot, monkeypatch):
    window, _, toolbox = desk
    monkeypatch.setattr("app.controllers.light_offer.OWN_S", 0.05)
    toolbox.stranger = True
    qtbot.wait(300)
    steps = FakeWatch.steps
    FakeWatch.change = DARK
    numbers = len(toolbox.wishes)
    qtbot.waitUntil(lambda: len(toolbox.wishes) > numbers + 20, timeout=10000)
    assert FakeWatch.steps == steps and window.message_bar.text == ""


def test_the_light_of_a_profile_that_cannot_be_read_is_not_known():
    assert result_of(read_light("nobody")) is None
    assert result_of(read_light("a?b")) is None
