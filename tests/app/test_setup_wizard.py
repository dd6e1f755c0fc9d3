"""Facts about the guided setup, on real widgets with a camera and a face of our own."""

import re

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from app.controllers.capturing import ORDER, QUICK, told
from app.errors import CameraLostError
from app.views.setup.setup_window import STEPS
from app.workbook import Workbook
from core.generations import ProfileUnwritableError
from core.ghost import Ghost
from core.setup_plan import SHOTS
from tests.app.live_fakes import CAMERA
from tests.app.setup_fakes import begin, close, open_setup, seen_people, shoot

SPACE, BACKSPACE = Qt.Key.Key_Space, Qt.Key.Key_Backspace
BY_NAME = {shot.name: shot for shot in SHOTS}


@pytest.fixture(scope="module")
def people():
    return seen_people()


@pytest.fixture
def setup(qtbot, tmp_path, people, monkeypatch):
    return open_setup(qtbot, tmp_path / "profiles", people, monkeypatch)


def test_a_name_is_needed_and_wrong_ones_are_explained(setup):
    start = setup.window.start
    assert not start.begin_button.isEnabled()
    start.name.setText("a?b")
    assert not start.begin_button.isEnabled() and "'?'" in start.remark.text()
    start.name.setText("me")
    assert start.begin_button.isEnabled() and start.remark.text() == ""
    assert str(setup.root) in start.stored.text()


def test_steps_unlock_in_order(qtbot, setup):
    window = setup.window
    enabled = [bool(window.steps.item(n).flags() & Qt.ItemFlag.ItemIsEnabled) for n in range(5)]
    assert enabled == [True, False, False, False, False]
    begin(qtbot, setup)
    assert setup.controller.step == "capture" and not window.next_button.isEnabled()
    setup.controller.show("train")
    assert setup.controller.step == "capture"
    shoot(qtbot, setup, 14)
    assert window.next_button.isEnabled()
    close(setup)


def test_the_first_prompt_is_the_front_and_profiles_come_after_smaller_turns():
    names = [shot.name for shot in ORDER]
    assert names[0] == "pose_yaw+0" and len(set(names)) == 60
    assert names.index("pose_yaw-30") < names.index("pose_yaw-90")
    assert names.index("pose_roll+30") < names.index("smile_yaw+0")
    assert len(QUICK) == 20 and set(QUICK) <= set(names)


def test_prompts_are_told_in_short_and_in_full():
    assert told(BY_NAME["pose_yaw-90"])[0] == "Turn your head 90° to your right"
    title, more = told(BY_NAME["smile_yaw+30"])
    assert title == "Smile broadly with your lips closed"
    assert more == "Meanwhile, turn your head 30° to your left."


def test_what_was_taken_is_kept_and_the_next_prompt_asked(qtbot, setup):
    page = begin(qtbot, setup)
    assert setup.tools.prompted == ["pose_yaw+0"]
    shoot(qtbot, setup, 3)
    names = Workbook(setup.root / "me", lambda rgb: None).names
    assert {shot.name for shot in ORDER[:3]} <= set(names)
    assert page.sheet.states()["pose_yaw+0"] == "good"
    assert page.progress.value() >= 3 and "of 60" in page.progress.format()
    close(setup)


def test_a_setup_that_was_closed_goes_on_where_it_stopped(qtbot, setup, people, monkeypatch):
    begin(qtbot, setup)
    shoot(qtbot, setup, 4)
    close(setup)
    qtbot.waitUntil(lambda: not setup.tools.open_now, timeout=5000)
    taken = len(Workbook(setup.root / "me", lambda rgb: None).names)
    again = open_setup(qtbot, setup.root, people, monkeypatch)
    assert again.window.start.profiles.names == ["me"]
    begin(qtbot, again)
    assert again.controller.capturing.shot.name == ORDER[taken].name
    close(again)


def test_the_keys_shoot_skip_pause_and_retake(qtbot, setup):
    page = begin(qtbot, setup)
    capturing = setup.controller.capturing
    QTest.keyClick(setup.window, Qt.Key.Key_S)
    assert capturing.shot.name == ORDER[1].name
    QTest.keyClick(setup.window, SPACE)
    qtbot.waitUntil(lambda: page.sheet.states()[ORDER[1].name] == "good", timeout=5000)
    assert capturing.shot.name == ORDER[2].name
    QTest.keyClick(setup.window, BACKSPACE)
    assert capturing.shot.name == ORDER[1].name
    QTest.keyClick(setup.window, Qt.Key.Key_P)
    setup.tools.obeys = True
    qtbot.wait(150)
    assert page.sheet.states()[ORDER[2].name] == "missing"
    assert "Paused" in page.live.guide.advice and page.buttons["pause"].text() == "&Go on"
    setup.tools.obeys = False
    close(setup)


def test_a_click_on_a_cell_takes_that_picture_again(qtbot, setup):
    page = begin(qtbot, setup)
    name = "grin_yaw+0"
    row = [shot.name for shot in ORDER].index(name)
    page.sheet.itemClicked.emit(page.sheet.item(row))
    assert setup.controller.capturing.shot.name == name
    close(setup)


def test_a_weak_picture_says_why(qtbot, setup):
    page = begin(qtbot, setup)
    setup.tools.quality = {"trouble": "dark"}
    setup.tools.obeys = True
    qtbot.waitUntil(lambda: "too dark" in page.live.guide.news, timeout=5000)
    setup.tools.obeys = False
    assert page.sheet.states()["pose_yaw+0"] == "weak"
    assert "too dark" in page.sheet.item(0).toolTip()
    assert page.sheet.cells()[0].why == "too dark" and page.sheet.cells()[-1].why == ""
    assert not page.live.guide.good
    assert re.search(r"\d weak", page.progress.format()) and "weak" in setup.tools.speaker.played
    close(setup)


def test_the_quick_subset_leaves_the_rest_for_later(qtbot, setup):
    page = begin(qtbot, setup)
    page.plan_chosen.emit("quick")
    shoot(qtbot, setup, 20)
    qtbot.waitUntil(lambda: setup.controller.capturing.shot is None, timeout=5000)
    states = page.sheet.states()
    assert {name for name, state in states.items() if state != "missing"} == set(QUICK)
    assert page.title.text() == "All pictures are taken"
    page.plan_chosen.emit("all")
    assert setup.controller.capturing.shot is not None
    close(setup)


def test_arrows_say_which_way_to_turn_in_the_mirror(qtbot, setup):
    page = begin(qtbot, setup)
    for turn in ((30.0, 0, 0), (-30.0, 0, 0), (0, 20.0, 0), (0, 0, 20.0)):
        setup.tools.turn_deg = turn
        qtbot.waitUntil(
            lambda turn=turn: (page.live.guide.yaw_deg, page.live.guide.pitch_deg,
                               page.live.guide.roll_deg) == pytest.approx(turn),
            timeout=5000,
        )  # fmt: skip
        image = page.live.grab().toImage()
        area = page.live.picture_rect()
        yellow = [
            (x, y) for x in range(0, image.width(), 3) for y in range(0, image.height(), 3)
            if image.pixelColor(x, y).getRgb()[:3] == (255, 220, 80)
        ]  # fmt: skip
        x, y = np.mean(yellow, axis=0) - [area.center().x(), area.center().y()]
        assert (x < 0) == (turn[0] > 0 or turn[2] > 0) if turn[0] or turn[2] else y < 0
    close(setup)


def test_a_small_turn_waits_for_a_large_one(qtbot, setup):
    page = begin(qtbot, setup)
    columns = []
    for turn in ((60.0, 0, 0), (60.0, 20.0, 0), (60.0, 50.0, 0)):
        setup.tools.turn_deg = turn
        qtbot.waitUntil(lambda turn=turn: page.live.guide.pitch_deg == pytest.approx(turn[1]),
                        timeout=5000)  # fmt: skip
        image, area = page.live.grab().toImage(), page.live.picture_rect()
        x, top = round(area.center().x()), round(area.top())
        column = [image.pixelColor(x, y).getRgb()[:3] for y in range(top, top + 80)]
        columns.append((255, 220, 80) in column)
    assert columns == [False, False, True]
    close(setup)


def test_advice_is_shown_in_words(qtbot, setup):
    page = begin(qtbot, setup)
    setup.tools.advice = "dark"
    qtbot.waitUntil(lambda: "too dark" in page.live.guide.advice, timeout=5000)
    close(setup)


def test_a_camera_that_is_lost_is_told_and_comes_back(qtbot, setup):
    page = begin(qtbot, setup)
    shoot(qtbot, setup, 2)
    kept = sum(state != "missing" for state in page.sheet.states().values())
    setup.tools.read_error = CameraLostError("Laptop camera", 90)
    qtbot.waitUntil(lambda: "plug it in again" in page.live.guide.advice, timeout=5000)
    assert setup.tools.speaker.played[-1] == "trouble"
    setup.tools.read_error = None
    # Nobody touches anything: it goes on by itself.
    qtbot.waitUntil(lambda: page.live._image is not None, timeout=5000)
    assert sum(state != "missing" for state in page.sheet.states().values()) >= kept
    shoot(qtbot, setup, kept + 3)
    close(setup)


def test_a_camera_that_is_waited_for_is_told_of_and_goes_on_by_itself(qtbot, setup):
    page = begin(qtbot, setup)
    camera = setup.tools.cameras_open[CAMERA]
    camera.trouble = "The camera is gone. Waiting for it."
    qtbot.waitUntil(lambda: page.live.guide.advice == camera.trouble, timeout=5000)
    assert setup.tools.speaker.played.count("trouble") == 1
    camera.trouble = ""
    qtbot.waitUntil(lambda: "gone" not in page.live.guide.advice, timeout=5000)
    shoot(qtbot, setup, 1)
    close(setup)


def test_sounds_say_to_hold_still_and_that_a_picture_was_taken(qtbot, setup):
    page = begin(qtbot, setup)
    qtbot.waitUntil(lambda: setup.tools.speaker.played == ["hold"], timeout=5000)
    setup.tools.obeys = True
    qtbot.waitUntil(lambda: page.live.guide.news == "✓ Taken", timeout=5000)
    setup.tools.obeys = False
    assert "taken" in setup.tools.speaker.played and page.live.guide.good
    page.sound_box.click()
    before = list(setup.tools.speaker.played)
    shoot(qtbot, setup, 4)
    assert setup.tools.speaker.played == before
    close(setup)
    assert not setup.tools.chosen.sound


def test_a_ghost_shows_how_the_head_is_to_be_held(qtbot, setup):
    page = begin(qtbot, setup)
    left = np.array([[8.0, 10.0], [20.0, 10.0], [20.0, 30.0], [8.0, 30.0]])
    setup.tools.ghost = Ghost(left, (left[:2] + 3,))
    qtbot.waitUntil(lambda: len(page.live.guide.ghost) == 2, timeout=5000)
    with_ghost, area = page.live.grab().toImage(), page.live.picture_rect()
    setup.tools.ghost = None
    qtbot.waitUntil(lambda: page.live.guide.ghost == (), timeout=5000)
    without = page.live.grab().toImage()
    changed = [
        x for x in range(0, without.width(), 2) for y in range(0, without.height(), 2)
        if without.pixelColor(x, y).lightness() + 60 < with_ghost.pixelColor(x, y).lightness()
    ]  # fmt: skip
    # The lines on the left of the picture are on the right of the mirror.
    assert changed and min(changed) > area.center().x()
    close(setup)


def test_more_pictures_are_asked_for_by_sets(qtbot, setup):
    page = begin(qtbot, setup)
    row = page.plans.keys.index("glasses")
    page.plans.setCurrentIndex(row)
    page.plans.activated.emit(row)
    names = [cell.name for cell in page.sheet.cells()]
    assert names[0] == "glasses~pose_yaw+0" and len(names) < 20
    assert "With glasses: put them on." in page.instruction.text()
    assert page.sheet.cells()[0].title.startswith("glasses: ")
    assert setup.tools.prompted[-1] == "pose_yaw+0"
    setup.tools.obeys = True
    qtbot.waitUntil(lambda: setup.controller.capturing.shot is None, timeout=20000)
    setup.tools.obeys = False
    assert set(Workbook(setup.root / "me", lambda rgb: None).names) >= set(names)
    assert setup.tools.speaker.played[-1] == "done"
    close(setup)


def test_without_a_camera_the_performer_is_offered(qtbot, tmp_path, people, monkeypatch):
    setup = open_setup(qtbot, tmp_path / "p", people, monkeypatch, cameras=())
    setup.window.start.name.setText("me")
    setup.window.start.begin_button.click()
    page = setup.window.camera
    assert "No camera" in page.live.guide.advice
    assert "performer" in page.cameras.cards[0].name
    assert not setup.window.next_button.isEnabled()
    QTest.keyClick(page.cameras, Qt.Key.Key_Down)
    qtbot.waitUntil(setup.window.next_button.isEnabled, timeout=5000)
    close(setup)


def test_the_quick_choice_lists_its_pictures_and_those_that_are_there(qtbot, setup):
    page = begin(qtbot, setup)
    page.sheet.chosen.emit("smile_yaw+30")
    QTest.keyClick(setup.window, SPACE)
    qtbot.waitUntil(lambda: page.sheet.states()["smile_yaw+30"] == "good", timeout=5000)
    page.plan_chosen.emit("quick")
    assert page.sheet.names == [*QUICK, "smile_yaw+30"]
    close(setup)


def test_a_line_below_the_sheet_says_why_a_picture_is_weak(qtbot, setup):
    page = begin(qtbot, setup)
    setup.tools.quality = {"trouble": "dark"}
    QTest.keyClick(setup.window, SPACE)
    qtbot.waitUntil(lambda: page.sheet.states()["pose_yaw+0"] == "weak", timeout=5000)
    assert "not taken yet" in page.note.text()
    page.sheet.itemEntered.emit(page.sheet.item(0))
    assert page.note.text() == "straight ahead: too dark; click to take it again"
    page.note.resize(60, 16)
    assert page.note.shown_text().endswith("…")
    close(setup)


def test_the_source_that_was_used_is_used_again_and_live(qtbot, setup, people, monkeypatch):
    begin(qtbot, setup)
    key, text = setup.tools.performances()[0].key, setup.tools.performances()[0].text
    setup.window.capture.source_chosen.emit(key)
    assert setup.controller.source == "performer:mixed"
    close(setup)
    assert setup.tools.chosen.camera == text
    again = open_setup(qtbot, setup.root, people, monkeypatch)
    again.tools.chosen = setup.tools.chosen
    again.controller._choices = setup.tools.chosen
    shown = again.controller._usual_camera()
    assert shown == key
    close(again)


def test_live_goes_on_with_the_camera_of_the_setup(qtbot, setup):
    begin(qtbot, setup)
    assert setup.controller.source == CAMERA
    close(setup)


def test_a_full_disk_is_told_and_the_prompt_stays(qtbot, setup, monkeypatch):
    page = begin(qtbot, setup)

    def full(*_):
        raise ProfileUnwritableError(setup.root, "no space left on device")

    put, bar = Workbook.put, setup.window.message_bar
    monkeypatch.setattr(Workbook, "put", full)
    QTest.keyClick(setup.window, SPACE)
    qtbot.waitUntil(lambda: "no space" in bar.text, timeout=5000)
    qtbot.wait(100)
    # The message stays, and nothing is taken until the user says so.
    assert "no space" in bar.text and page.buttons["pause"].text() == "&Go on"
    assert page.sheet.states()["pose_yaw+0"] == "missing"
    assert setup.controller.capturing.shot.name == "pose_yaw+0"
    monkeypatch.setattr(Workbook, "put", put)
    page.buttons["pause"].click()
    assert bar.text == ""
    shoot(qtbot, setup, 1)
    assert page.sheet.states()["pose_yaw+0"] == "good"
    close(setup)


def test_a_profile_that_cannot_be_written_is_told_before_the_first_picture(setup):
    (setup.root / "me").write_text("no folder")
    setup.window.start.chosen.emit("me")
    assert setup.controller.step == "start"
    assert "cannot write the profile" in setup.window.message_bar.text.lower()


def test_a_book_whose_folder_cannot_be_read_is_told(setup, monkeypatch):
    def denied(name):
        raise OSError(36, "File name too long", name)

    monkeypatch.setattr(setup.tools, "open_book", denied)
    setup.window.start.chosen.emit("me")
    assert "File name too long" in setup.window.message_bar.text


def test_landmarks_can_be_put_right_before_the_training(qtbot, setup):
    begin(qtbot, setup)
    shoot(qtbot, setup, 14)
    setup.window.next_button.click()
    qtbot.waitUntil(lambda: setup.controller.editor is not None, timeout=10000)
    assert setup.controller.step == "check" and not setup.tools.open_now
    name = setup.controller.editor.name
    # Keys work once the page has been shown.
    qtbot.wait(100)
    QTest.keyClick(setup.window, Qt.Key.Key_K)
    editor = setup.controller.editor
    assert editor.selected == {0}
    QTest.keyClick(setup.window.check.layout().itemAt(0).widget().canvas, Qt.Key.Key_Left)
    assert Workbook(setup.root / "me", lambda rgb: None).landmarks(name).edited[0]
    close(setup)


def test_training_begins_with_all_pictures_and_plots_the_focal_length(qtbot, setup, monkeypatch):
    begin(qtbot, setup)
    shoot(qtbot, setup, 14)
    setup.controller.show("train")
    page = setup.window.train
    plotted = []
    monkeypatch.setattr(page, "show_focal", lambda focals, errors: plotted.append(list(focals)))
    assert page.train_button.isEnabled() and not page.live_button.isEnabled()
    with qtbot.waitSignal(setup.controller.training.trained, timeout=5000):
        page.train_button.click()
    qtbot.waitUntil(lambda: page.job_row.isHidden(), timeout=5000)
    assert len(setup.tools.trained_with[0]) >= 14
    assert [600.0] in plotted
    close(setup)


def test_too_few_pictures_cannot_be_trained(qtbot, setup):
    page = begin(qtbot, setup)
    QTest.keyClick(setup.window, SPACE)
    qtbot.waitUntil(lambda: page.sheet.states()["pose_yaw+0"] == "good", timeout=5000)
    place = list(STEPS).index("train")
    assert not setup.window.steps.item(place).flags() & Qt.ItemFlag.ItemIsEnabled
    close(setup)


def test_a_picture_of_the_report_opens_in_the_editor(qtbot, setup):
    begin(qtbot, setup)
    shoot(qtbot, setup, 14)
    setup.controller.show("train")
    name = ORDER[2].name
    setup.controller.training.picture_wanted.emit(name)
    qtbot.waitUntil(lambda: setup.controller.editor is not None, timeout=10000)
    assert setup.controller.editor.name == name
    close(setup)


def test_every_control_has_a_name(setup):
    page = setup.window.capture
    for widget in (page.live, page.target, page.sheet, page.sources, page.plans, page.progress):
        assert widget.accessibleName()
    assert all(button.text() for button in page.buttons.values())


def test_target_is_mirrored_like_the_live_picture(setup):
    assert setup.window.capture.live._mirrored and setup.window.capture.target._mirrored
