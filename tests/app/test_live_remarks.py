"""What the live window says beside its pictures: invitation, troubles, numbers, profiles' deeds."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QDesktopServices

from app.controllers.cpu_share import CpuShare
from app.controllers.desk import open_desk
from app.controllers.inviting import Inviting
from app.controllers.remarks import state_name
from app.errors import AppError
from app.views.choice import Choice
from app.views.message_bar import MessageBar
from app.views.status_row import LiveNumbers, StatusRow
from core.live import resting_state
from tests.app.live_fakes import CAMERA, FakeEditor, FakeToolbox, make_state


@pytest.fixture
def live(qtbot):
    opened = []

    def open_live(toolbox):
        window, controller = open_desk(toolbox)
        qtbot.addWidget(window)
        window.show()
        controller.start()
        opened.append(window)
        return window

    yield open_live
    for window in opened:
        window.close()


def test_who_has_no_profile_is_invited_with_one_button_until_that_is_put_away(live, qtbot):
    toolbox, begun = FakeToolbox(), []
    toolbox.guided_setup = lambda source: begun.append(source) or FakeEditor("")
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.card.isVisible() and window.avatar_pane.has_picture)
    assert window.card.button.text().replace("&", "") == "Set up my face (10 minutes)"
    qtbot.mouseClick(window.card.button, Qt.MouseButton.LeftButton)
    assert begun == [CAMERA]


def test_nobody_is_told_to_be_tracked_before_a_face_is_seen(live, qtbot):
    shown = []
    window = live(FakeToolbox())
    invite = Inviting(window, lambda: True)
    lost, seen = resting_state("free"), make_state(0)
    for state in (None, lost, seen, lost, None):
        invite.look("", False, False, state)
        shown.append(not window.card.isHidden())
    assert shown == [False, False, True, True, True]


def test_an_invitation_put_away_does_not_come_back_at_the_next_start(live, qtbot):
    window = live(FakeToolbox())
    qtbot.waitUntil(lambda: window.card.isVisible())
    qtbot.mouseClick(window.card.close_button, Qt.MouseButton.LeftButton)
    qtbot.wait(300)
    assert not window.card.isVisible()
    window.close()
    again = live(FakeToolbox())
    qtbot.waitUntil(lambda: again.source_pane.has_picture)
    qtbot.wait(300)
    assert not again.card.isVisible()


def test_who_has_a_profile_and_does_without_it_is_not_invited(live, qtbot):
    window = live(FakeToolbox(profiles=["anna"]))
    window.profile_chosen.emit("")
    qtbot.waitUntil(lambda: window.status.state == "Tracking, training-free")
    assert not window.card.isVisible() and window.hint.text() == ""


def test_a_camera_that_is_gone_is_told_and_goes_on_by_itself(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    toolbox.trouble = "The camera Camera 0 is gone. Waiting for it."
    qtbot.waitUntil(lambda: window.source_pane.notice.text.endswith("Waiting for it."))
    assert not window.source_pane.has_picture
    qtbot.waitUntil(lambda: window.status.state == "Camera gone: waiting for it")
    toolbox.trouble = ""
    qtbot.waitUntil(lambda: window.source_pane.has_picture)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    assert toolbox.opened == [CAMERA] and window.message_bar.text == ""


def test_closing_does_not_wait_for_a_camera_that_is_gone(live, qtbot):
    toolbox = FakeToolbox()
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.source_pane.has_picture)
    toolbox.trouble = "The camera is gone."
    qtbot.wait(50)
    window.close()
    assert not toolbox.open_now


def test_the_list_of_profiles_offers_what_can_be_done_with_them(live, qtbot, monkeypatch):
    toolbox, shown = FakeToolbox(profiles=["anna", "bert"]), []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: shown.append(url.toLocalFile()))
    window = live(toolbox)
    assert window.profiles.keys == ("", "anna", "bert", "?guided", "?edit", "?folder")
    window.profiles.chosen.emit("?edit")
    assert [editor.name for editor in toolbox.editors] == ["anna"]
    assert window.profiles.currentData() == "anna"
    window.profiles.chosen.emit("?edit")
    assert len(toolbox.editors) == 1 and toolbox.editors[0].shown == 1
    window.profiles.chosen.emit("?folder")
    assert shown == ["/profiles/anna"]
    window.profile_chosen.emit("")
    assert not window.deeds["edit"].isEnabled() and not window.deeds["folder"].isEnabled()


def test_a_profile_trained_anew_in_the_editor_is_used_at_once(live, qtbot):
    toolbox, loaded = FakeToolbox(profiles=["anna"]), []
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    open_profile = toolbox.open_profile
    toolbox.open_profile = lambda key: loaded.append(key) or open_profile(key)
    window.deeds["edit"].trigger()
    toolbox.editors[0].finished.emit(False)
    window.deeds["edit"].trigger()
    assert loaded == [] and len(toolbox.editors) == 2
    toolbox.editors[1].finished.emit(True)
    qtbot.waitUntil(lambda: loaded == ["anna"])
    assert window.source_pane.has_picture


def test_an_editor_that_cannot_be_shown_says_why(live):
    toolbox = FakeToolbox(profiles=["anna"])
    window = live(toolbox)
    window.deeds["edit"].trigger()
    toolbox.editors[0].failed.emit(AppError("its pictures were deleted"))
    assert "pictures were deleted" in window.message_bar.text
    window.close()
    assert not toolbox.editors[0].closed


def test_an_offer_has_buttons_that_put_it_away_and_the_next_message_has_none(qtbot):
    bar = MessageBar()
    qtbot.addWidget(bar)
    bar.offer("the light has changed", [Choice("shots.add", "Add shots"), Choice("shots.no", "No")])
    assert [button.text() for button in bar.buttons] == ["Add shots", "No"]
    with qtbot.waitSignal(bar.chosen) as chosen:
        qtbot.mouseClick(bar.buttons[0], Qt.MouseButton.LeftButton)
    assert chosen.args == ["shots.add"] and bar.text == ""
    bar.tell("no camera")
    assert bar.buttons == () and bar.text == "No camera"


def test_the_processor_share_is_that_of_all_processors():
    now = {"clock": 0.0, "used": 0.0}
    share = CpuShare(lambda: now["clock"], lambda: now["used"], n_processors=4)
    assert share.look() == 0
    for _ in range(40):
        now["clock"] += 0.25
        now["used"] += 0.5
        found = share.look()
    assert found == pytest.approx(0.5)


def test_the_status_line_tells_all_numbers(qtbot):
    row = StatusRow()
    qtbot.addWidget(row)
    row.show_numbers(LiveNumbers("trained", 0.91, 29.7, 4.25, 11.6, 3, 0.42, 0.8))
    shown = {name: row.field(name) for name in ("confidence", "rate", "solve", "latency")}
    assert shown == {
        "confidence": "confidence 91 %", "rate": "30 fps", "solve": "solve 4.2 ms",
        "latency": "latency 12 ms",
    }  # fmt: skip
    assert row.field("dropped") == "3 dropped" and row.field("cpu") == "CPU 42 %"
    assert row.field("quality") == "avatar 80 %"
    row.show_numbers(LiveNumbers("gone"))
    assert row.field("confidence") == "" and row.field("quality") == ""


@pytest.mark.parametrize(
    ("busy", "gone", "picture", "state", "confidence", "name"),
    [
        (False, False, False, None, 0, "off"),
        (True, True, True, make_state(), 0.9, "gone"),
        (True, False, False, None, 0, "opening"),
        (True, False, True, make_state(lost=True), 0.9, "searching"),
        (True, False, True, make_state(mode="free"), 0.9, "free"),
        (True, False, True, make_state(), 0.1, "trained_unsure"),
    ],
)
def test_one_state_at_a_time_is_told(busy, gone, picture, state, confidence, name):
    assert state_name(busy, gone, picture, state, confidence) == name
