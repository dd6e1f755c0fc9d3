"""Facts about the camera page of the guided setup, with cameras of our own."""

import json
import re

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from app.controllers.camera_check import BLANK, FINE
from app.controllers.camera_hold import CHANGED, GOOD_S, NEEDS_NONE, Patience
from app.controllers.camera_words import GONE
from app.setup_memory import SetupChoices, load_choices, save_choices
from core.shot_quality import ADVICE
from tests.app.live_fakes import CAMERA, OTHER_CAMERA, STILL
from tests.app.setup_fakes import close, open_setup


@pytest.fixture
def setup(qtbot, tmp_path, monkeypatch):
    found = open_setup(qtbot, tmp_path / "profiles", {}, monkeypatch, (CAMERA, OTHER_CAMERA))
    yield found
    close(found)


def enter(qtbot, setup):
    setup.window.start.name.setText("me")
    setup.window.start.begin_button.click()
    return setup.window.camera


def live(qtbot, setup, key=CAMERA):
    """Go to the page and wait for the picture of a camera."""
    page = enter(qtbot, setup)
    qtbot.waitUntil(lambda: setup.controller.camera.ready, timeout=5000)
    qtbot.waitUntil(lambda: "fps" in card(page, key).facts, timeout=5000)
    return page


def card(page, key):
    return next(one for one in page.cameras.cards if one.key == key)


def test_all_cameras_are_shown_live_with_size_and_measured_speed(qtbot, setup):
    page = live(qtbot, setup)
    assert [one.key for one in page.cameras.cards] == [CAMERA, OTHER_CAMERA, STILL]
    for key in (CAMERA, OTHER_CAMERA):
        qtbot.waitUntil(lambda key=key: "fps" in card(page, key).facts, timeout=5000)
        size, fps = re.match(r"64 × 48, ([\d.]+) (fps)", card(page, key).facts).groups()
        # The fake's frames are 4 ms apart on its own clock.
        assert float(size) == pytest.approx(250, rel=0.02) and fps
    assert setup.controller.camera.chosen == CAMERA
    assert {one.key for one in setup.tools.open_now} == {CAMERA, OTHER_CAMERA}


def test_the_performer_is_offered_and_only_opened_when_chosen(qtbot, setup):
    page = live(qtbot, setup)
    assert STILL not in setup.tools.opened
    page.cameras.setFocus()
    QTest.keyClick(page.cameras, Qt.Key.Key_End)
    assert setup.controller.camera.chosen == STILL
    qtbot.waitUntil(lambda: setup.controller.camera.ready, timeout=5000)
    QTest.keyClick(page.cameras, Qt.Key.Key_Home)
    qtbot.waitUntil(
        lambda: {one.key for one in setup.tools.open_now} == {CAMERA, OTHER_CAMERA}, timeout=5000
    )


def test_a_click_chooses_the_camera_that_takes_the_pictures(qtbot, setup):
    page = live(qtbot, setup, OTHER_CAMERA)
    place = page.cameras.visualItemRect(page.cameras.item(1)).center()
    QTest.mouseClick(page.cameras.viewport(), Qt.MouseButton.LeftButton, pos=place)
    qtbot.waitUntil(lambda: setup.controller.camera.chosen == OTHER_CAMERA, timeout=5000)
    qtbot.waitUntil(setup.window.next_button.isEnabled, timeout=5000)
    setup.window.next_button.click()
    assert setup.controller.capturing.source == OTHER_CAMERA
    assert setup.tools.chosen.camera == "Camera 2"


def test_a_click_on_the_chosen_camera_changes_nothing(qtbot, setup):
    page = live(qtbot, setup)
    qtbot.waitUntil(lambda: page.verdict.text() == FINE, timeout=8000)
    place = page.cameras.visualItemRect(page.cameras.item(0)).center()
    QTest.mouseClick(page.cameras.viewport(), Qt.MouseButton.LeftButton, pos=place)
    assert setup.controller.camera.ready and page.verdict.text() == FINE


def test_all_cameras_are_closed_before_the_pictures_are_taken(qtbot, setup):
    live(qtbot, setup)
    setup.window.next_button.click()
    qtbot.waitUntil(lambda: setup.window.capture.live._image is not None, timeout=5000)
    assert {one.key for one in setup.tools.open_now} == {CAMERA}


def test_a_busy_camera_says_so_and_the_next_one_is_taken(qtbot, setup):
    setup.tools.busy = {CAMERA}
    page = enter(qtbot, setup)
    qtbot.waitUntil(lambda: setup.controller.camera.ready, timeout=5000)
    assert setup.controller.camera.chosen == OTHER_CAMERA
    assert "another program" in card(page, CAMERA).trouble


def test_a_busy_camera_that_becomes_free_is_shown(qtbot, setup):
    setup.tools.busy = {CAMERA, OTHER_CAMERA}
    page = enter(qtbot, setup)
    qtbot.waitUntil(lambda: bool(card(page, OTHER_CAMERA).trouble), timeout=5000)
    assert "another program" in page.live.guide.advice
    assert not setup.window.next_button.isEnabled()
    setup.tools.busy = set()
    setup.controller.camera.look_again()
    qtbot.waitUntil(setup.window.next_button.isEnabled, timeout=5000)
    qtbot.waitUntil(lambda: not card(page, CAMERA).trouble, timeout=5000)


def test_a_camera_that_cannot_run_beside_others_is_opened_alone(qtbot, setup):
    page = enter(qtbot, setup)
    setup.tools.busy = {OTHER_CAMERA}
    qtbot.waitUntil(lambda: bool(card(page, OTHER_CAMERA).trouble), timeout=5000)
    setup.tools.busy = set()
    page.cameras.setCurrentRow(1)
    qtbot.waitUntil(
        lambda: {one.key for one in setup.tools.open_now} == {OTHER_CAMERA}, timeout=5000
    )
    qtbot.waitUntil(lambda: setup.controller.camera.ready, timeout=5000)


def test_a_camera_without_a_picture_says_so(qtbot, setup):
    setup.tools.flat = {CAMERA, OTHER_CAMERA}
    page = enter(qtbot, setup)
    qtbot.waitUntil(lambda: card(page, CAMERA).trouble == BLANK, timeout=5000)
    assert page.live.guide.advice == BLANK
    qtbot.waitUntil(lambda: card(page, OTHER_CAMERA).trouble == BLANK, timeout=5000)
    assert setup.controller.camera.chosen == CAMERA


def test_a_camera_with_a_picture_is_preferred_to_one_without(qtbot, setup):
    setup.tools.flat = {CAMERA}
    enter(qtbot, setup)
    qtbot.waitUntil(lambda: setup.controller.camera.chosen == OTHER_CAMERA, timeout=5000)


def test_a_camera_that_is_plugged_in_appears(qtbot, setup):
    page = live(qtbot, setup)
    setup.tools.camera_keys.append("camera:4")
    setup.controller.camera.look_again()
    assert "camera:4" in [one.key for one in page.cameras.cards]
    qtbot.waitUntil(lambda: "fps" in card(page, "camera:4").facts, timeout=5000)
    assert setup.controller.camera.chosen == CAMERA


def test_a_camera_that_is_unplugged_vanishes(qtbot, setup):
    page = live(qtbot, setup, OTHER_CAMERA)
    setup.tools.camera_keys.remove(OTHER_CAMERA)
    setup.controller.camera.look_again()
    assert OTHER_CAMERA not in [one.key for one in page.cameras.cards]
    qtbot.waitUntil(lambda: {one.key for one in setup.tools.open_now} == {CAMERA}, timeout=5000)


def test_the_chosen_camera_that_is_unplugged_is_waited_for(qtbot, setup):
    page = live(qtbot, setup, OTHER_CAMERA)
    page.cameras.setCurrentRow(1)
    qtbot.waitUntil(lambda: setup.controller.camera.ready, timeout=5000)
    setup.tools.camera_keys.remove(OTHER_CAMERA)
    setup.tools.cameras_open[OTHER_CAMERA].unplugged = True
    qtbot.waitUntil(lambda: not setup.controller.camera.ready, timeout=5000)
    setup.controller.camera.look_again()
    assert card(page, OTHER_CAMERA).trouble == GONE
    assert not setup.window.next_button.isEnabled()
    setup.tools.camera_keys.append(OTHER_CAMERA)
    setup.controller.camera.look_again()
    qtbot.waitUntil(lambda: setup.controller.camera.ready, timeout=5000)
    assert setup.controller.camera.chosen == OTHER_CAMERA


def test_advice_is_one_sentence_over_the_picture(qtbot, setup):
    setup.tools.advice = "far"
    page = live(qtbot, setup)
    qtbot.waitUntil(lambda: page.live.guide.advice == ADVICE["far"], timeout=5000)
    assert page.verdict.text() == ""
    setup.tools.advice = ""
    qtbot.waitUntil(lambda: page.verdict.text() == FINE, timeout=8000)
    assert page.live.guide.advice == ""


def test_the_camera_is_held_when_all_is_well_and_let_go_when_the_light_changes(qtbot, setup):
    page = live(qtbot, setup)
    qtbot.waitUntil(lambda: "exposure and white balance" in page.held.text(), timeout=8000)
    assert "does not let itself be told its focus" in page.held.text()
    camera = setup.tools.cameras_open[CAMERA]
    assert camera.holds[-1] == "hold" and len(setup.tools.held[CAMERA]) == 3
    setup.tools.advice = "dark"
    qtbot.waitUntil(lambda: camera.holds[-1] == "let go", timeout=5000)
    assert page.held.text() == CHANGED and setup.tools.held[CAMERA] == ()
    setup.tools.advice = ""
    qtbot.waitUntil(lambda: camera.holds[-1] == "hold", timeout=8000)
    page.hold_box.click()
    qtbot.waitUntil(lambda: camera.holds[-1] == "let go", timeout=5000)
    assert page.held.text() == "" and setup.tools.held[CAMERA] == ()


def test_a_source_with_nothing_to_hold_says_so(qtbot, setup):
    setup.tools.flat = {STILL}
    page = live(qtbot, setup)
    page.camera_chosen.emit(STILL)
    # The flat fake cannot be held; its pictures of one grey are no matter here.
    qtbot.waitUntil(lambda: setup.controller.camera.ready, timeout=5000)
    setup.controller.camera._hold.step("", 0.0)
    setup.controller.camera._hold.step("", GOOD_S + 60.0)
    qtbot.waitUntil(lambda: page.held.text() == NEEDS_NONE, timeout=5000)


def test_patience_waits_until_all_has_been_well_for_some_time():
    patience = Patience()
    assert not patience.good
    wishes = [patience.step("", n / 10) for n in range(round(10 * GOOD_S) + 5)]
    assert wishes.index("hold") == round(10 * GOOD_S) and wishes.count("hold") == 1
    assert patience.good
    assert patience.step("far", 9.0) == "" and not patience.good
    assert patience.step("backlit", 9.1) == "let go"
    assert patience.step("backlit", 9.2) == ""


def test_choices_are_kept_and_a_damaged_file_is_as_the_first_time(tmp_path):
    path = tmp_path / "settings" / "setup.json"
    assert load_choices(path) == SetupChoices()
    save_choices(path, SetupChoices("Laptop camera", False, False))
    assert load_choices(path) == SetupChoices("Laptop camera", False, False)
    path.write_text(json.dumps({"camera": 3, "sound": False, "more": 1}))
    assert load_choices(path) == SetupChoices("", True, False)
    for text in ("[1]", "{", "null"):
        path.write_text(text)
        assert load_choices(path) == SetupChoices()
    save_choices(tmp_path / "settings" / "setup.json" / "no", SetupChoices())


def test_choices_that_cannot_be_written_to_their_end_leave_those_before(tmp_path, monkeypatch):
    path = tmp_path / "setup.json"
    kept = SetupChoices("Laptop camera", False, False)
    save_choices(path, kept)

    def full(self, *content, **settings):
        with self.open("wb") as file:
            file.write(b"{")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_text", full)
    save_choices(path, SetupChoices())
    assert load_choices(path) == kept


def test_the_camera_of_the_last_time_is_chosen(qtbot, tmp_path, monkeypatch):
    setup = open_setup(qtbot, tmp_path / "profiles", {}, monkeypatch, (CAMERA, OTHER_CAMERA))
    setup.controller._choices = SetupChoices("Camera 2")
    live(qtbot, setup, OTHER_CAMERA)
    assert setup.controller.camera.chosen == OTHER_CAMERA
    close(setup)


def test_every_control_of_the_page_has_a_name(qtbot, setup):
    page = live(qtbot, setup)
    for widget in (page.cameras, page.live, page.verdict, page.held):
        assert widget.accessibleName()
    told = page.cameras.item(0).data(Qt.ItemDataRole.AccessibleTextRole)
    assert "Camera 0" in told and "64 × 48" in told
