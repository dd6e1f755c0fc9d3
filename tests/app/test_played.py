"""Videos and the performer as sources: paused, stepped, moved, looped."""

import threading
import time

import cv2
import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QApplication

from app.capture.played import Played
from app.capture.video import GRABBED_AT_MOST, VideoSource
from app.controllers.desk import open_desk
from app.controllers.toolbox import Toolbox
from app.views.choice import Choice
from app.views.seek_slider import SeekSlider
from app.views.transport_row import clock_text
from core.records import Frame
from tests.app.live_fakes import FakeToolbox

FPS = 200.0


class Recording:
    """Ten frames that tell their number."""

    size_px, fps, name, skips = (64, 48), FPS, "clip.mp4", True

    def __init__(self, n_frames=10, claimed=None):
        self.n_frames = n_frames if claimed is None else claimed
        self.true, self.next, self.closed, self.reads = n_frames, 0, False, []

    def read(self):
        if not self.next < self.true:
            return None
        self.reads.append(self.next)
        gray = np.full((48, 64), (20 + 4 * self.next) % 250, np.uint8)
        frame = Frame(np.repeat(gray[..., None], 3, 2), gray, self.next / FPS, self.next)
        self.next += 1
        return frame

    def seek(self, index):
        self.next = index

    def close(self):
        self.closed = True


def level(frame):
    return (int(frame.gray[0, 0]) - 20) // 4


def played(recording=None, skips=False):
    recording, cuts = recording or Recording(), []
    recording.skips = skips
    return Played(recording, lambda: cuts.append(recording.reads[-1])), cuts


def test_a_loop_goes_on_counting_and_tells_each_turn():
    source, cuts = played()
    frames = [source.read() for _ in range(25)]
    assert [level(frame) for frame in frames] == [n % 10 for n in range(25)]
    assert [frame.index for frame in frames] == list(range(25))
    np.testing.assert_allclose([frame.time_s for frame in frames], np.arange(25) / FPS)
    assert len(cuts) == 2


def test_it_is_played_at_its_own_rate_and_at_another_speed():
    source, _ = played()
    started_s = time.perf_counter()
    for _ in range(5):
        source.read()
    assert time.perf_counter() - started_s >= 4 / FPS
    source.set_speed(0.25)
    source.read()
    started_s = time.perf_counter()
    frames = [source.read() for _ in range(2)]
    assert time.perf_counter() - started_s >= 2 / (0.25 * FPS)
    # Slow motion is for the eye: the tracker counts in the time of the recording.
    assert frames[1].time_s - frames[0].time_s == pytest.approx(1 / FPS)


def test_a_slow_reader_of_a_video_gets_what_is_due_and_the_performer_plays_slower():
    for skips in (True, False):
        source, cuts = played(skips=skips)
        source.read()
        time.sleep(4.5 / FPS)
        late, after = source.read(), source.read()
        assert (level(late) >= 4) == skips and level(after) == level(late) + 1
        assert cuts == [] and late.index == level(late)


def test_while_paused_only_steps_give_frames_and_steps_back_are_cuts():
    source, cuts = played()
    for _ in range(4):
        source.read()
    source.pause(True)
    source.step(1)
    assert level(source.read()) == 4 and cuts == []
    source.step(-1)
    back = source.read()
    assert level(back) == 3 and len(cuts) == 1 and back.index == 5
    source.step(-1)
    assert level(source.read()) == 2 and source.position == 2
    read = []
    reader = threading.Thread(target=lambda: read.append(source.read()))
    reader.start()
    reader.join(0.05)
    assert reader.is_alive() and read == []
    source.interrupt()
    reader.join(5)
    assert read == [None] and not reader.is_alive()


def test_the_slider_goes_anywhere_within_the_recording():
    source, cuts = played()
    source.read()
    for index, expected in ((7, 7), (99, 9), (-3, 0)):
        source.go_to(index)
        assert level(source.read()) == expected
    assert level(source.read()) == 1 and len(cuts) == 3


def test_without_loop_it_holds_at_the_end_and_begins_again_when_wished():
    source, _ = played()
    source.set_loop(False)
    frames = [source.read() for _ in range(10)]
    reader = threading.Thread(target=lambda: frames.append(source.read()))
    reader.start()
    reader.join(0.05)
    assert len(frames) == 10 and source.paused
    source.pause(False)
    reader.join(5)
    assert level(frames[-1]) == 0 and not source.paused
    source.close()


@pytest.mark.parametrize("claimed", [0, 30])
def test_a_recording_shorter_than_it_says_loops_where_it_really_ends(claimed):
    source, _ = played(Recording(6, claimed))
    assert [level(source.read()) for _ in range(8)] == [0, 1, 2, 3, 4, 5, 0, 1]
    assert source.n_frames == 6


def test_an_empty_recording_ends():
    source, _ = played(Recording(0))
    assert source.read() is None


def test_a_video_gives_the_frame_that_is_asked_for(tmp_path):
    path = tmp_path / "clip.mp4"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 25.0, (64, 48))
    for n in range(60):
        writer.write(np.full((48, 64, 3), 4 * n, np.uint8))
    writer.release()
    with VideoSource(path) as video:
        for index in (0, 5, 6, 3, 5 + GRABBED_AT_MOST, 59, 20, 0):
            video.seek(index)
            frame = video.read()
            assert abs(int(frame.gray.mean()) - 4 * index) <= 3
            assert frame.index == index and frame.time_s == pytest.approx(index / 25, abs=0.002)
        video.seek(60)
        assert video.read() is None


@pytest.mark.gl
def test_the_performer_can_be_stepped_back(tmp_path):
    with Toolbox().open_source("performer:still", lambda: None) as source:
        first = source.read()
        source.pause(True)
        source.step(5)
        later = source.read()
        source.go_to(0)
        again = source.read()
    np.testing.assert_array_equal(first.rgb, again.rgb)
    assert (later.rgb != first.rgb).any() and again.time_s > later.time_s > first.time_s


class PlayedToolbox(FakeToolbox):
    def open_source(self, key, began_again):
        if not key.endswith(".mp4"):
            return super().open_source(key, began_again)
        return Played(Recording(0 if "empty" in key else 500), began_again)


@pytest.fixture
def window(qtbot):
    window, controller = open_desk(PlayedToolbox())
    qtbot.addWidget(window)
    window.show()
    controller.start()
    yield window
    window.close()


def test_buttons_are_there_for_a_video_and_not_for_a_camera(window, qtbot):
    qtbot.waitUntil(lambda: window.source_pane.has_picture)
    assert not window.transport.isVisible() and not window.deeds["pause"].isEnabled()
    window.take("clip.mp4")
    qtbot.waitUntil(lambda: window.source_pane.has_picture)
    assert window.transport.isVisible() and window.deeds["pause"].isEnabled()
    window.take("camera:0")
    qtbot.waitUntil(lambda: window.source_pane.has_picture)
    assert not window.transport.isVisible()


def test_keys_pause_and_step_a_video(window, qtbot):
    window.take("clip.mp4")
    qtbot.waitUntil(lambda: window.transport.slider.value() > 3)
    qtbot.waitUntil(window.isActiveWindow)
    qtbot.keyClick(window, Qt.Key.Key_Space)
    assert window.deeds.on("pause")
    qtbot.wait(150)
    held = window.transport.slider.value()
    qtbot.keyClick(window, Qt.Key.Key_Period)
    qtbot.waitUntil(lambda: window.transport.slider.value() == held + 1)
    qtbot.keyClick(window, Qt.Key.Key_Comma)
    qtbot.keyClick(window, Qt.Key.Key_Comma)
    qtbot.waitUntil(lambda: window.transport.slider.value() in (held - 1, held))
    window.transport.slider.setValue(400)
    qtbot.wait(150)
    assert window.transport.slider.value() == 400
    assert window.transport.time.text() == "0:02.0 / 0:02.5"
    qtbot.keyClick(window, Qt.Key.Key_Space)
    qtbot.waitUntil(lambda: window.transport.slider.value() not in (400, held))


def test_space_presses_the_button_that_has_the_focus(window, qtbot):
    window.take("clip.mp4")
    qtbot.waitUntil(lambda: window.source_pane.has_picture)
    qtbot.waitUntil(window.isActiveWindow)
    window.resize(1240, 600)
    qtbot.waitUntil(window.mirror_box.isVisible)
    window.mirror_box.setFocus()
    before = window.mirror_box.isChecked()
    qtbot.keyClick(window.mirror_box, Qt.Key.Key_Space)
    assert window.mirror_box.isChecked() != before and not window.deeds.on("pause")


def test_letters_and_the_space_key_are_those_of_a_list_that_has_the_focus(window, qtbot):
    qtbot.waitUntil(window.isActiveWindow)
    assert window.focusWidget() is not window.sources
    window.show_avatars([Choice("nora", "Nora"), Choice("own", "Leo")], "nora")
    chosen = []
    window.avatar_chosen.connect(chosen.append)
    before = window.deeds.on("landmarks")
    qtbot.keyClick(window, Qt.Key.Key_L)
    assert window.deeds.on("landmarks") != before
    window.avatars.setFocus()
    qtbot.keyClick(window.avatars, "l")
    assert chosen == ["own"] and window.deeds.on("landmarks") != before
    qtbot.keyClick(window.avatars, Qt.Key.Key_Space)
    assert window.avatars.view().isVisible() and not window.deeds.on("pause")
    qtbot.keyClick(window.avatars.view(), "n")
    assert window.avatars.view().currentIndex().row() == 0
    window.avatars.hidePopup()


def test_the_wheel_over_a_list_chooses_nothing(window, qtbot):
    window.show_avatars([Choice("nora", "Nora"), Choice("own", "Leo")], "nora")
    chosen = []
    window.avatar_chosen.connect(chosen.append)
    window.avatars.setFocus()
    spot = QPointF(10, 10)
    wheel = QWheelEvent(
        spot, window.avatars.mapToGlobal(spot), QPoint(), QPoint(0, -120),
        Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase,
        False,
    )  # fmt: skip
    QApplication.sendEvent(window.avatars, wheel)
    assert chosen == [] and window.avatars.currentData() == "nora"


def test_a_click_on_the_seek_bar_goes_there_and_can_be_dragged_on(qtbot):
    slider = SeekSlider()
    qtbot.addWidget(slider)
    slider.resize(400, 24)
    slider.setMaximum(1000)
    slider.show()
    qtbot.mousePress(slider, Qt.MouseButton.LeftButton, pos=QPoint(300, 12))
    assert slider.value() == pytest.approx(750, abs=15) and slider.isSliderDown()
    qtbot.mouseMove(slider, QPoint(100, 12))
    assert slider.value() == pytest.approx(250, abs=15)
    qtbot.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=QPoint(100, 12))
    assert slider.value() == pytest.approx(250, abs=15)


def test_closing_while_paused_does_not_wait(window, qtbot):
    window.take("clip.mp4")
    qtbot.waitUntil(lambda: window.source_pane.has_picture)
    window.deeds["pause"].trigger()
    qtbot.wait(50)
    window.close()
    assert not window.isVisible()


def test_buttons_go_with_a_video_that_can_no_longer_be_read(window, qtbot):
    window.take("clip.mp4")
    qtbot.waitUntil(lambda: window.source_pane.has_picture)
    window.take("empty.mp4")
    qtbot.waitUntil(lambda: "no more pictures" in window.message_bar.text)
    assert not window.transport.isVisible() and not window.deeds["next"].isEnabled()


@pytest.mark.parametrize(("time_s", "text"), [(0, "0:00.0"), (61.25, "1:01.2"), (-1, "0:00.0")])
def test_times_are_minutes_seconds_and_tenths(time_s, text):
    assert clock_text(time_s) == text
