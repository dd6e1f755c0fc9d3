"""Facts about holding a camera's exposure, focus and white balance, by drivers of all kinds."""

import cv2
import numpy as np
import pytest

from app.capture.holding import hold, hold_again, release, told
from app.capture.webcam import CameraEntry, WebcamSource
from app.controllers import setup_tools

AUTO, EXPOSURE = cv2.CAP_PROP_AUTO_EXPOSURE, cv2.CAP_PROP_EXPOSURE
FOCUS_AUTO, WB_AUTO, WB = cv2.CAP_PROP_AUTOFOCUS, cv2.CAP_PROP_AUTO_WB, cv2.CAP_PROP_WB_TEMPERATURE
AUTO_LEVEL = 120.0


class Driver:
    """A camera whose pictures are as bright as its exposure makes them."""

    def __init__(self, system="linux", refuses=(), stale=None, deaf=False, sticky=()):
        self.system, self.refuses, self.sticky, self.deaf = system, set(refuses), set(sticky), deaf
        self.by_hand = 1.0 if system == "linux" else 0.0
        automatic = 3.0 if system == "linux" else 1.0
        true = 156.0 if system == "linux" else -5.0
        self.true_exposure = true
        self.values = {
            AUTO: automatic,
            EXPOSURE: true if stale is None else stale,
            FOCUS_AUTO: 1.0,
            cv2.CAP_PROP_FOCUS: 30.0,
            WB_AUTO: 1.0,
            WB: 4600.0,
        }
        self.opened = True

    def set(self, prop, value):
        if prop not in self.values or prop in self.refuses:
            return False
        if prop not in self.sticky:
            self.values[prop] = value
        return True

    def get(self, prop):
        if prop in self.refuses:
            return 0.0
        if self.system == "win32" and prop == AUTO:
            return -1.0
        return self.values.get(prop, 0.0)

    def level(self):
        if self.values[AUTO] != self.by_hand or self.deaf:
            return AUTO_LEVEL if not self.deaf or self.values[AUTO] != self.by_hand else 30.0
        now, true = self.values[EXPOSURE], self.true_exposure
        factor = now / true if self.system == "linux" else 2.0 ** (now - true)
        return float(np.clip(AUTO_LEVEL * max(factor, 1e-3) ** 0.5, 1, 255))

    def read(self):
        return True, np.full((48, 64, 3), self.level(), np.uint8)

    def isOpened(self):
        return self.opened

    def release(self):
        self.opened = False


def held_names(held):
    return [one.knob.name for one in held if one.held]


@pytest.mark.parametrize("system", ["linux", "win32"])
@pytest.mark.parametrize("stale", [None, 10, 3000])
def test_the_picture_stays_as_bright_as_it_was(system, stale):
    if system == "win32" and stale is not None:
        stale = -9 if stale == 10 else -2
    driver = Driver(system, stale=stale)
    held = hold(driver, driver.level, system)
    assert held_names(held) == ["exposure", "focus", "white balance"]
    assert driver.values[AUTO] == driver.by_hand
    assert driver.level() == pytest.approx(AUTO_LEVEL, rel=0.13 if system == "linux" else 0.36)
    assert driver.values[WB] == 4600.0
    release(driver, held)
    assert driver.values[AUTO] == (3.0 if system == "linux" else 1.0)
    assert driver.values[FOCUS_AUTO] == driver.values[WB_AUTO] == 1.0


def test_what_the_camera_refuses_is_told():
    driver = Driver(refuses=(FOCUS_AUTO,))
    held = hold(driver, driver.level, "linux")
    assert held_names(held) == ["exposure", "white balance"]
    text = told(held)
    assert "Held still: exposure and white balance." in text and "told its focus" in text


def test_a_switch_that_does_not_move_is_not_held():
    driver = Driver(sticky=(WB_AUTO,))
    assert held_names(hold(driver, driver.level, "linux")) == ["exposure", "focus"]


def test_a_camera_that_lets_itself_be_told_nothing_is_left_alone():
    driver = Driver(refuses=(AUTO, FOCUS_AUTO, WB_AUTO))
    held = hold(driver, driver.level, "darwin")
    assert held_names(held) == [] and driver.values[AUTO] == 3.0
    assert told(held).startswith("Nothing could be held still.")
    release(driver, held)
    assert driver.values[AUTO] == 3.0


def test_an_exposure_that_cannot_be_found_is_left_automatic():
    driver = Driver(deaf=True)
    held = hold(driver, driver.level, "linux")
    assert "exposure" not in held_names(held) and driver.values[AUTO] == 3.0


def open_webcam(driver, held=()):
    cameras = (CameraEntry(0, "Laptop camera", ""),)
    return WebcamSource(0, cameras=cameras, open_device=lambda *_: driver, held=held)


def test_a_webcam_holds_and_lets_go_when_it_is_closed(monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    driver = Driver(stale=20)
    source = open_webcam(driver)
    held = source.hold()
    assert "exposure" in held_names(held) and driver.values[AUTO] == 1.0
    source.close()
    assert driver.values[AUTO] == 3.0 and driver.values[WB_AUTO] == 1.0
    again = Driver(stale=20)
    with open_webcam(again, held):
        assert again.values[AUTO] == 1.0
        assert again.values[EXPOSURE] == driver.values[EXPOSURE] != 20
    assert again.values[AUTO] == 3.0


def test_a_webcam_lets_go_at_once_when_asked(monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    driver = Driver()
    with open_webcam(driver) as source:
        held = source.hold()
        source.let_go()
        assert driver.values[AUTO] == 3.0
        hold_again(driver, held)
        assert driver.values[AUTO] == 1.0
    assert driver.values[AUTO] == 1.0


def test_the_setup_holds_a_camera_wherever_it_opens_it_again(monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    drivers = []

    def open_device(*_):
        drivers.append(Driver(stale=20))
        return drivers[-1]

    def webcam(index, cameras, held):
        return WebcamSource(index, cameras=cameras, open_device=open_device, held=held)

    monkeypatch.setattr(setup_tools, "WebcamSource", webcam)
    entry, tools = CameraEntry(0, "Laptop camera", ""), setup_tools.SetupTools()
    held = hold(Driver(), Driver().level, "linux")
    tools.keep_held("camera:0", held)
    with tools._open_held("camera:0", entry):
        assert drivers[-1].values[AUTO] == 1.0
    assert drivers[-1].values[AUTO] == 3.0
    tools.keep_held("camera:0", ())
    with tools._open_held("camera:0", entry):
        assert drivers[-1].values[AUTO] == 3.0
