"""Cameras that are unplugged, plugged in, in use elsewhere, or hang."""

import threading
import time
from contextlib import suppress

import numpy as np
import pytest

from app.capture.patient import PatientCamera, same_camera
from app.capture.webcam import CameraEntry
from app.errors import CameraBusyError, CameraLostError, NoCameraError
from core.records import Frame

FIRST = CameraEntry(0, "Desk camera", "/dev/video0")
MOVED = CameraEntry(2, "Desk camera", "/dev/video2")
OTHER = CameraEntry(0, "Another camera", "/dev/video0")


class Device:
    """A camera whose frames are given out one by one by the test."""

    def __init__(self, size_px=(64, 48)):
        self.size_px, self.fps, self.name, self.live = size_px, 30.0, "Desk camera", True
        self.tickets, self.unplugged, self.closed = threading.Semaphore(0), False, False
        self.n_read = 0

    def read(self):
        self.tickets.acquire()
        if self.unplugged:
            raise CameraLostError(self.name, self.n_read)
        width, height = self.size_px
        self.n_read += 1
        gray = np.zeros((height, width), np.uint8)
        return Frame(np.zeros((height, width, 3), np.uint8), gray, time.perf_counter(), 0)

    def hold(self):
        return ("exposure",)

    def let_go(self):
        pass

    def close(self):
        self.closed = True

    def unplug(self):
        self.unplugged = True
        self.tickets.release()


class Desk:
    """What is plugged in, and what opening it gives."""

    def __init__(self, *entries):
        self.entries, self.opened, self.devices, self.busy = list(entries), [], [], False
        self.failing = False

    def cameras(self):
        if self.failing:
            raise RuntimeError("the driver lists nothing now")
        return list(self.entries)

    def open(self, entry, held):
        self.held = held
        if self.busy:
            raise CameraBusyError(entry.name, "in use")
        self.opened.append(entry)
        self.devices.append(Device((64, 48) if len(self.opened) == 1 else (128, 96)))
        return self.devices[-1]

    def camera(self, **settings):
        return PatientCamera(0, cameras=self.cameras, open_camera=self.open, **settings)


def give(device):
    device.tickets.release()


def eventually(condition):
    """Wait for a thread's work, a second at most."""
    for _ in range(200):
        if condition():
            return True
        time.sleep(0.005)
    return False


@pytest.fixture
def desk():
    desk = Desk(FIRST)
    yield desk
    for device in desk.devices:
        with suppress(ValueError):
            device.unplug()


def test_a_camera_that_comes_back_goes_on_under_another_number(desk):
    with desk.camera(retry_s=0.01) as camera:
        first = desk.devices[0]
        give(first)
        frames = [camera.read()]
        desk.entries.clear()
        first.unplug()
        assert eventually(lambda: "Desk camera is gone" in camera.trouble)
        assert eventually(lambda: first.closed)
        # Another camera has taken its number: that one is left alone.
        desk.entries[:] = [OTHER]
        time.sleep(0.05)
        assert desk.opened == [FIRST]
        desk.entries[:] = [OTHER, MOVED]
        assert eventually(lambda: desk.opened == [FIRST, MOVED])
        give(desk.devices[1])
        frames.append(camera.read())
        assert camera.trouble == ""
    assert [frame.index for frame in frames] == [0, 1]
    # It came back with another size: a source keeps its own.
    assert {frame.rgb.shape for frame in frames} == {(48, 64, 3)}
    assert {frame.gray.shape for frame in frames} == {(48, 64)}


def test_a_camera_that_another_program_took_meanwhile_says_so(desk):
    with desk.camera(retry_s=0.01) as camera:
        desk.busy = True
        desk.devices[0].unplug()
        assert eventually(lambda: "there but gives no picture" in camera.trouble)
        desk.busy = False
        assert eventually(lambda: len(desk.devices) == 2)
        assert eventually(lambda: camera.trouble == "")


def test_a_driver_that_fails_to_list_cameras_does_not_end_the_waiting(desk):
    with desk.camera(retry_s=0.01) as camera:
        desk.failing = True
        desk.devices[0].unplug()
        assert eventually(lambda: "Desk camera is gone" in camera.trouble)
        time.sleep(0.05)
        desk.failing = False
        assert eventually(lambda: len(desk.devices) == 2)
        assert eventually(lambda: camera.trouble == "")


def test_waiting_for_a_camera_can_be_left_at_once(desk):
    camera = desk.camera(retry_s=60.0)
    desk.entries.clear()
    desk.devices[0].unplug()
    assert eventually(lambda: camera.trouble != "")
    got = []
    reader = threading.Thread(target=lambda: got.append(camera.read()))
    reader.start()
    camera.interrupt()
    reader.join(2.0)
    assert got == [None]
    camera.close()
    assert eventually(lambda: not camera._thread.is_alive())


def test_a_camera_that_hangs_holds_nobody_up(desk):
    camera = desk.camera()
    # The device's read returns only when the test is over.
    camera.close()
    assert camera.read() is None
    assert not desk.devices[0].closed
    give(desk.devices[0])
    assert eventually(lambda: desk.devices[0].closed)


def test_a_camera_that_hangs_is_told(desk, monkeypatch):
    monkeypatch.setattr("app.capture.patient.HANGS_S", 0.02)
    with desk.camera() as camera:
        assert eventually(lambda: "gives no pictures" in camera.trouble)


def test_a_camera_must_be_there_in_the_beginning(desk):
    desk.busy = True
    with pytest.raises(CameraBusyError):
        desk.camera()
    desk.entries.clear()
    with pytest.raises(NoCameraError):
        desk.camera()


def test_a_slow_reader_gets_the_newest_picture(desk):
    with desk.camera() as camera:
        for _ in range(3):
            give(desk.devices[0])
        assert eventually(lambda: desk.devices[0].n_read == 3)
        assert eventually(lambda: camera._index == 3)
        assert camera.read().index == 2


def test_a_held_camera_is_held_again_when_it_is_back(desk):
    with desk.camera(retry_s=0.01) as camera:
        give(desk.devices[0])
        assert camera.hold() == ("exposure",)
        desk.devices[0].unplug()
        assert eventually(lambda: len(desk.devices) == 2)
        assert desk.held == ("exposure",)
        give(desk.devices[1])
        camera.let_go()
        desk.devices[1].unplug()
        assert eventually(lambda: len(desk.devices) == 3)
        assert desk.held == ()


@pytest.mark.parametrize(
    "found, expected",
    [
        ([OTHER], None),
        ([OTHER, MOVED], MOVED),
        ([MOVED, FIRST], FIRST),
        ([CameraEntry(1, "Desk camera", ""), CameraEntry(0, "Desk camera", "")],
         CameraEntry(0, "Desk camera", "")),
    ],
)  # fmt: skip
def test_the_same_camera_has_the_name_and_best_the_path(found, expected):
    assert same_camera(FIRST, found) == expected
