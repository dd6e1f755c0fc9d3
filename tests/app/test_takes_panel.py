"""Facts about takes in the live window: recorded, played, trimmed, solved again and exported."""

import os
import time

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAction
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMessageBox

from app.controllers import takes as takes_controller
from app.controllers.correcting import CorrectingController
from app.controllers.desk import open_desk
from app.controllers.take_work import film_look
from app.controllers.takes import TakesController
from app.render.look import AvatarLook, Background
from app.takes.completing import SILENT_S
from app.takes.library import HEADER, part_folder, takes
from app.takes.rows import read_columns
from app.views.choice import Choice
from app.views.takes.export_dialog import ExportDialog, ExportWish
from app.views.takes.name_dialog import NameDialog
from app.views.takes.player_box import fine_clock
from app.views.takes.record_row import clock
from app.views.takes.solve_dialog import SolveDialog
from app.workers.job import Job
from app.workers.playback import Playback
from core.arkit import EXPRESSION_NAMES
from core.records import Progress
from tests.app.live_fakes import CAMERA, OTHER_CAMERA, FakeToolbox
from tests.app.test_takes import fail_to_write, level_of, number_of, recorded

JAW = EXPRESSION_NAMES.index("jawOpen")


class Desk:
    """A live window with its takes."""

    def __init__(self, qtbot, toolbox):
        self.qtbot, self.toolbox = qtbot, toolbox
        self.window, self.controller = open_desk(toolbox)
        qtbot.addWidget(self.window)
        self.takes = self.controller.findChild(TakesController)
        self.panel = self.takes.panel
        self.window.show()
        self.window.panels.show("takes")
        self.controller.start()

    def until(self, done):
        self.qtbot.waitUntil(done, timeout=15000)

    def live(self):
        self.until(lambda: self.window.status.state.startswith("Tracking"))

    def click(self, button):
        self.qtbot.mouseClick(button, Qt.MouseButton.LeftButton)

    def listed(self, n):
        self.until(lambda: len(self.panel.list.entries) == n and not self.takes.shelf.busy)

    def record(self, seconds=0.1, video=False):
        self.panel.record.video_box.setChecked(video)
        self.click(self.panel.record.record_button)
        self.until(lambda: self.takes.recording.seconds > seconds)
        self.click(self.panel.record.record_button)
        self.until(lambda: self.takes.recording.state == "off")

    def play(self):
        self.listed(1)
        self.panel.list.setCurrentRow(0)
        self.click(self.panel.buttons["play"])
        self.until(lambda: self.takes.playing.take is not None)
        self.until(lambda: not self.toolbox.open_now)


@pytest.fixture
def open_takes(qtbot):
    """Opens live windows; afterwards nothing runs."""
    desks = []

    def make(toolbox=None):
        desks.append(Desk(qtbot, toolbox or FakeToolbox(profiles=["anna"])))
        return desks[-1]

    yield make
    for desk in desks:
        desk.window.close()
        threads = [*desk.controller.findChildren(Job), *desk.controller.findChildren(Playback)]
        assert not any(thread.isRunning() for thread in threads)
        assert not desk.toolbox.open_now


def test_a_key_records_and_ends_and_it_is_always_to_be_seen(open_takes):
    desk = open_takes()
    desk.live()
    assert desk.takes.badge.shown == "" and not desk.takes.pause_action.isEnabled()
    desk.window.activateWindow()
    QTest.keyClick(desk.window, Qt.Key.Key_R)
    desk.until(lambda: desk.takes.badge.shown.startswith("● Recording 0:00"))
    assert desk.panel.record.record_button.text() == "&Stop"
    assert desk.takes.dot.isVisible() and desk.takes.dot.text().startswith("● 0:0")
    desk.window.panels.dock("takes").hide()
    assert desk.takes.badge.isVisible()
    desk.until(lambda: desk.takes.recording.seconds > 0.1)
    QTest.keyClick(desk.window, Qt.Key.Key_R)
    desk.until(lambda: desk.takes.badge.shown == "")
    desk.listed(1)
    (take,) = takes()
    assert "Recorded" in desk.window.message_bar.text and take.name in desk.window.message_bar.text
    assert (take.facts.source, take.facts.profile) == ("fake", "anna")
    assert take.facts.avatar == desk.controller.scene.avatar and take.facts.fps == 250.0
    assert (
        "anna" in desk.panel.list.entries[0].details and "MB" in desk.panel.list.entries[0].details
    )


def test_no_two_actions_of_the_window_share_a_key(open_takes):
    desk = open_takes()
    keys = [
        key.toString() for action in desk.window.findChildren(QAction) for key in action.shortcuts()
    ]
    assert len(keys) > 30 and {key for key in keys if keys.count(key) > 1} == set()


def test_what_happens_in_a_pause_is_not_in_the_take(open_takes):
    desk = open_takes()
    desk.live()
    desk.click(desk.panel.record.record_button)
    desk.until(lambda: desk.takes.recording.seconds > 0.05)
    desk.window.activateWindow()
    QTest.keyClick(desk.window, Qt.Key.Key_P)
    desk.until(lambda: "paused" in desk.takes.badge.shown)
    before_s = desk.takes.recording.seconds
    frames = len(desk.toolbox.wishes)
    desk.until(lambda: len(desk.toolbox.wishes) > frames + 20)
    assert desk.takes.recording.seconds == before_s
    desk.click(desk.panel.record.pause_button)
    desk.until(lambda: desk.takes.recording.seconds > before_s + 0.05)
    desk.click(desk.panel.record.record_button)
    desk.listed(1)
    (take,) = takes()
    rows = take.rows()
    jumps = np.diff(rows["frame_index"])
    assert jumps.max() > 15 and np.diff(rows["play_s"])[jumps.argmax()] < 0.01


def test_a_live_thread_with_a_recorder_keeps_its_rate(open_takes):
    desk = open_takes()
    desk.live()
    desk.record(0.3, video=True)
    desk.listed(1)
    (take,) = takes()
    rows = take.rows()
    assert np.median(np.diff(rows["frame_index"])) == 1
    assert take.film is not None and (rows["video_index"] >= 0).mean() > 0.5


def test_without_a_picture_nothing_is_recorded(open_takes):
    desk = open_takes(FakeToolbox(cameras=()))
    desk.click(desk.panel.record.record_button)
    assert "no picture to record" in desk.window.message_bar.text
    assert desk.takes.recording.state == "off"


def test_another_source_ends_the_recording_and_the_take_is_kept(open_takes):
    desk = open_takes(FakeToolbox(cameras=[CAMERA, OTHER_CAMERA]))
    desk.live()
    desk.click(desk.panel.record.record_button)
    desk.until(lambda: desk.takes.recording.seconds > 0.05)
    desk.window.source_chosen.emit(OTHER_CAMERA)
    desk.listed(1)
    assert desk.takes.recording.state == "off"


def test_closing_the_window_keeps_the_take(open_takes):
    desk = open_takes()
    desk.live()
    desk.click(desk.panel.record.record_button)
    desk.until(lambda: desk.takes.recording.seconds > 0.05)
    desk.window.close()
    assert len(takes()) == 1


def test_a_full_disk_is_told_and_the_take_so_far_listed(open_takes, monkeypatch):
    monkeypatch.setattr("app.takes.recorder.SPARE_BYTES", 1 << 60)
    monkeypatch.setattr("app.takes.recorder.SIGN_EVERY_S", 0.05)
    desk = open_takes()
    desk.live()
    desk.click(desk.panel.record.record_button)
    desk.until(lambda: "almost full" in desk.window.message_bar.text)
    desk.listed(1)
    assert "is kept" in desk.window.message_bar.text and desk.takes.badge.shown == ""


def test_a_recording_broken_off_by_a_crash_is_listed_at_the_next_start(open_takes):
    broken = part_folder("evening")
    recorded(20).folder.rename(broken)
    rows = broken / "states.bin"
    rows.write_bytes(read_columns(broken / "track.npz").tobytes())
    (broken / "track.npz").unlink()
    old = time.time() - SILENT_S - 1
    os.utime(broken / HEADER, (old, old))
    desk = open_takes()
    desk.listed(1)
    assert desk.panel.list.entries[0].name == "evening"
    desk.until(lambda: "broken off" in desk.window.message_bar.text)


def test_a_take_is_played_at_its_times_by_the_avatar_beside_its_pictures(open_takes):
    recorded(12)
    desk = open_takes()
    desk.live()
    desk.play()
    desk.until(lambda: not desk.toolbox.open_now)
    wishes = desk.toolbox.wishes
    desk.until(lambda: wishes[-1].state.expression[JAW] > 0)
    del wishes[:]
    desk.until(lambda: len(wishes) > 8)
    wish = next(one for one in wishes if one.solved is not None)
    number = number_of(wish.frame.gray.mean())
    assert wish.state.expression[JAW] == pytest.approx(0.02 * number, abs=1e-6)
    assert wish.solved.expression[JAW] == pytest.approx(0.01 * number, abs=1e-6)
    assert desk.takes.badge.shown.startswith("Playing") and desk.window.source_pane.has_picture
    desk.until(lambda: desk.window.status.state == "Playing a take")
    desk.click(desk.panel.player.live_button)
    desk.live()
    assert desk.takes.playing.take is None and desk.panel.player.isHidden()
    assert desk.toolbox.opened == [CAMERA, CAMERA]


def test_the_time_line_scrubs_and_keys_step_frame_by_frame(open_takes):
    recorded(12)
    desk = open_takes()
    desk.play()
    slider = desk.panel.player.slider
    QTest.keyClick(slider, Qt.Key.Key_Space)
    assert not desk.takes.playing.playing
    slider.moved.emit(6.2 / 30)
    wishes = desk.toolbox.wishes
    desk.until(lambda: len(wishes) > 0 and wishes[-1].state.expression[JAW] == pytest.approx(0.12))
    for key, number in ((Qt.Key.Key_Right, 7), (Qt.Key.Key_Period, 8), (Qt.Key.Key_Comma, 7),
                        (Qt.Key.Key_Left, 6)):  # fmt: skip
        QTest.keyClick(slider, key)
        desk.until(lambda n=number: wishes[-1].state.expression[JAW] == pytest.approx(0.02 * n))
        assert number_of(wishes[-1].frame.gray.mean()) == number
    desk.until(lambda: slider.position_s == pytest.approx(6 / 30))
    desk.qtbot.wait(100)
    assert wishes[-1].state.expression[JAW] == pytest.approx(0.12)
    QTest.keyClick(slider, Qt.Key.Key_Space)
    desk.until(lambda: wishes[-1].state.expression[JAW] != pytest.approx(0.12))


def test_trim_marks_are_set_kept_and_played_between(open_takes):
    recorded(12)
    desk = open_takes()
    desk.play()
    player, slider = desk.panel.player, desk.panel.player.slider
    desk.click(player.buttons["toggle"])
    slider.moved.emit(3 / 30)
    desk.until(lambda: slider.position_s == pytest.approx(3 / 30))
    QTest.keyClick(slider, Qt.Key.Key_I)
    slider.moved.emit(6 / 30)
    desk.until(lambda: slider.position_s == pytest.approx(6 / 30))
    QTest.keyClick(slider, Qt.Key.Key_O)
    (take,) = takes()
    assert take.range_s == pytest.approx((3 / 30, 6 / 30), abs=1e-6)
    desk.until(lambda: "kept" in desk.panel.list.entries[0].details)
    desk.click(player.buttons["toggle"])
    desk.qtbot.wait(60)
    del desk.toolbox.wishes[:]
    desk.until(lambda: len(desk.toolbox.wishes) > 12)
    shown = {round(wish.state.expression[JAW] * 50) for wish in desk.toolbox.wishes}
    assert shown <= {3, 4, 5, 6} and {3, 4, 5} <= shown
    desk.click(player.whole_button)
    assert takes()[0].facts.trim_s is None


def test_a_mark_is_dragged_with_the_mouse(open_takes):
    recorded(12)
    desk = open_takes()
    desk.play()
    slider = desk.panel.player.slider
    low, end = slider.height() - 3, slider.width() - 9
    QTest.mousePress(slider, Qt.MouseButton.LeftButton, pos=QPoint(end, low))
    QTest.mouseMove(slider, QPoint(slider.width() // 2, low))
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=QPoint(slider.width() // 2, low))
    assert takes()[0].range_s == pytest.approx((0.0, 0.2), abs=0.01)


def test_a_take_is_renamed_and_a_bad_name_is_said_while_typed(open_takes):
    recorded(), recorded()
    desk = open_takes()
    desk.listed(2)
    first, second = (entry.name for entry in desk.panel.list.entries)
    desk.panel.list.setCurrentRow(1)
    desk.panel.list.setFocus()
    desk.panel.list.activateWindow()
    QTest.keyClick(desk.panel.list, Qt.Key.Key_F2)
    dialog = desk.window.findChild(NameDialog)
    dialog.name.setText(first)
    assert "already" in dialog.remark
    dialog.name.setText("a/b")
    assert "no name" in dialog.remark
    dialog.name.setText("best")
    dialog.accept()
    desk.until(lambda: {entry.name for entry in desk.panel.list.entries} == {"best", first})
    assert desk.panel.list.current == "best" and second not in {take.name for take in takes()}


def test_a_take_is_deleted_only_after_a_question(open_takes):
    recorded()
    desk = open_takes()
    desk.play()
    for text, left in (("&Keep", 1), ("&Delete", 0)):
        desk.click(desk.panel.buttons["delete"])
        (box,) = [one for one in desk.window.findChildren(QMessageBox) if one.isVisible()]
        button = next(one for one in box.buttons() if one.text() == text)
        desk.click(button)
        desk.until(lambda n=left: len(takes()) == n)
    desk.listed(0)
    assert desk.takes.playing.take is None and not desk.panel.buttons["play"].isEnabled()
    assert desk.panel.empty_label.isVisible()


def test_the_folder_of_a_take_is_opened(open_takes, monkeypatch):
    opened = []
    monkeypatch.setattr(
        takes_controller.QDesktopServices, "openUrl", lambda url: opened.append(url.toLocalFile())
    )
    take = recorded()
    desk = open_takes()
    desk.listed(1)
    desk.panel.list.setCurrentRow(0)
    desk.click(desk.panel.buttons["folder"])
    assert opened == [str(take.folder)]


class SlowTools:
    """Work on takes that goes on until it is let go."""

    def __init__(self):
        self.wishes, self.go = [], False

    def user(self, profile):
        return None

    def solve(self, take, wish, drive):
        self.wishes.append(wish)
        while not self.go:
            time.sleep(0.005)
            yield Progress(1, 4, "Solving")
        return recorded()

    def film(self, take, path, wish, avatar, look):
        self.wishes.append((path, wish, avatar, look))
        yield Progress(1, 2, "Drawing")
        return path


def test_a_video_is_solved_again_in_the_background_with_progress_and_cancel(open_takes):
    recorded()
    desk = open_takes()
    tools = desk.takes.work._tools = SlowTools()
    desk.listed(1)
    desk.panel.list.setCurrentRow(0)
    for done in (False, True):
        desk.click(desk.panel.buttons["solve"])
        dialog = [one for one in desk.window.findChildren(SolveDialog) if one.isVisible()][-1]
        dialog.profiles.setCurrentText("anna")
        dialog.modes.setCurrentIndex(1)
        dialog.accept()
        desk.until(lambda: desk.panel.work.text.startswith("Solving"))
        assert not desk.panel.buttons["solve"].isEnabled()
        tools.go = done
        if not done:
            desk.click(desk.panel.work.cancel_button)
        desk.until(lambda: desk.panel.work.text == "")
    assert [(wish.profile, wish.mode) for wish in tools.wishes] == 2 * [("anna", "trained")]
    desk.listed(2)
    assert "Solved again" in desk.window.message_bar.text


def test_without_a_profile_only_the_mode_without_one_is_offered(qtbot):
    dialog = SolveDialog("t", ["anna"], "", {"auto": "A", "trained": "T", "free": "F"})
    qtbot.addWidget(dialog)
    assert [dialog.modes.itemData(n) for n in range(dialog.modes.count())] == ["free"]
    dialog.profiles.setCurrentIndex(1)
    assert dialog.modes.count() == 3
    with qtbot.waitSignal(dialog.wanted) as wanted:
        dialog.accept()
    assert wanted.args == ["anna", "auto"]


def test_a_take_without_video_cannot_be_solved_again(open_takes):
    recorded(video=False)
    desk = open_takes()
    desk.listed(1)
    desk.panel.list.setCurrentRow(0)
    assert desk.panel.buttons["export"].isEnabled()
    assert not desk.panel.buttons["solve"].isEnabled()
    assert "no video" in desk.panel.buttons["solve"].toolTip()


@pytest.mark.parametrize("form", [".npz", ".csv"])
def test_a_take_is_exported_through_the_dialog(open_takes, tmp_path, form):
    recorded()
    desk = open_takes()
    desk.listed(1)
    desk.panel.list.setCurrentRow(0)
    desk.click(desk.panel.buttons["export"])
    dialog = desk.window.findChild(ExportDialog)
    next(one for one in dialog.forms.buttons() if form in one.text()).click()
    dialog.accept()
    saving = desk.window.findChild(QFileDialog)
    saving.fileSelected.emit(str(tmp_path / "out"))
    saving.reject()
    desk.until((tmp_path / f"out{form}").exists)
    desk.until(lambda: "Exported" in desk.window.message_bar.text)


class Wardrobe(SlowTools):
    """Knows that the take's profile has a head."""

    def user(self, profile):
        return f"the head of {profile}"


def test_a_profile_chosen_while_a_take_plays_is_used_when_the_source_is_back(open_takes):
    recorded(12)
    desk = open_takes(FakeToolbox(profiles=["anna", "bert"]))
    desk.live()
    desk.takes.playing._user_of = Wardrobe().user
    desk.play()
    desk.until(lambda: desk.toolbox.wishes[-1].cast.user == "the head of anna")
    desk.controller.use_profile("bert")
    assert desk.controller.wanted.profile == "bert"
    desk.qtbot.wait(200)
    assert desk.takes.playing.take is not None
    assert desk.toolbox.wishes[-1].cast.user == "the head of anna"
    with desk.qtbot.waitSignal(desk.controller.player.opened) as opened:
        desk.click(desk.panel.player.live_button)
    assert opened.args[0].wanted.profile == "bert"
    desk.live()
    assert desk.toolbox.wishes[-1].cast.user is None


def test_a_frame_of_a_take_is_not_offered_as_one_of_the_profile(open_takes):
    recorded(12)
    desk = open_takes()
    desk.live()
    corrections = desk.controller.findChild(CorrectingController)
    desk.play()
    solved = []
    desk.controller.solved.connect(solved.append)
    del desk.toolbox.wishes[:]
    desk.until(lambda: len(desk.toolbox.wishes) > 8)
    desk.qtbot.wait(50)
    assert desk.window.source_pane.has_picture and solved == []
    corrections.correct()
    assert not corrections.busy and corrections.editor is None
    assert "take" in desk.window.message_bar.text
    desk.click(desk.panel.player.live_button)
    desk.live()
    assert desk.window.message_bar.text == "" and not desk.controller.lent


def test_marks_and_names_that_cannot_be_kept_are_told(open_takes, monkeypatch):
    take = recorded(12)
    desk = open_takes()
    desk.play()
    monkeypatch.setattr("os.replace", fail_to_write)
    desk.click(desk.panel.player.buttons["toggle"])
    desk.panel.player.trim_wanted.emit(0.1, 0.2)
    assert "no space" in desk.window.message_bar.text
    assert desk.takes.playing.take.facts.trim_s is None
    desk.window.message_bar.tell("")
    desk.takes._rename(take, "other")
    assert "Cannot rename" in desk.window.message_bar.text
    assert [one.name for one in takes()] == [take.name]


def test_a_name_that_gets_its_ending_replaces_no_file_unasked(open_takes, tmp_path):
    take = recorded()
    desk = open_takes()
    desk.listed(1)
    old = tmp_path / "v1.2.csv"
    old.write_text("old")
    wish = ExportWish(".csv", "", (64, 48), 30.0, False, True)
    desk.takes.work._ask_where(take, wish)
    saving = desk.window.findChild(QFileDialog)
    assert saving.defaultSuffix() == "csv" and "(*.csv)" in saving.nameFilters()[0]
    saving.fileSelected.emit(str(tmp_path / "v1.2"))
    assert str(old) in desk.window.message_bar.text and old.read_text() == "old"
    assert not desk.takes.work.busy
    # Here the dialog has asked.
    saving.fileSelected.emit(str(old))
    saving.reject()
    desk.until(lambda: "Exported" in desk.window.message_bar.text)
    assert old.read_text() != "old"


def test_a_take_that_cannot_be_completed_is_told_once(open_takes):
    part = part_folder("newer")
    recorded().folder.rename(part)
    (part / HEADER).write_text("{}")
    old = time.time() - SILENT_S - 1
    os.utime(part / HEADER, (old, old))
    desk = open_takes()
    desk.until(lambda: "cannot be completed" in desk.window.message_bar.text)
    desk.window.message_bar.tell("")
    for _ in range(2):
        with desk.qtbot.waitSignal(desk.takes.shelf.changed):
            desk.takes.shelf.refresh()
    assert desk.window.message_bar.text == "" and part.exists()


def test_a_film_shows_the_chosen_avatar_in_the_chosen_way(open_takes, tmp_path):
    take = recorded()
    desk = open_takes()
    tools = desk.takes.work._tools = SlowTools()
    wish = ExportWish(".mp4", "nora", (640, 480), 60.0, beside=True, driven=True, background="key")
    desk.takes.work.export(take, wish, tmp_path / "a.mp4")
    desk.until(lambda: "Exported" in desk.window.message_bar.text)
    ((path, film, avatar, look),) = tools.wishes
    assert look.background.kind == "key"
    assert (path.name, film.size_px, film.fps, film.beside, avatar) == (
        "a.mp4", (640, 480), 60.0, True, "nora",
    )  # fmt: skip


def test_a_film_has_the_background_of_the_live_window_but_no_transparency():
    clear, blurred = (
        AvatarLook(background=Background(kind=kind)) for kind in ("transparent", "blurred")
    )
    kinds = [(clear, ""), (blurred, ""), (blurred, "studio")]
    assert [film_look(*one).background.kind for one in kinds] == ["key", "blurred", "studio"]


@pytest.mark.parametrize("has_video", [True, False])
def test_the_export_offers_what_the_take_has(qtbot, has_video):
    dialog = ExportDialog("A take", [Choice("nora", "Nora")], "nora", has_video)
    qtbot.addWidget(dialog)
    kinds = [dialog.backgrounds.itemData(n) for n in range(dialog.backgrounds.count())]
    assert ("blurred" in kinds) == has_video and dialog.beside_box.isEnabled() == has_video
    assert dialog.wish() == ExportWish(".mp4", "nora", (1280, 720), 30.0, False, True, "")


def test_times_are_told_as_a_clock():
    assert [clock(s) for s in (0.4, 61, 3661)] == ["0:00", "1:01", "1:01:01"]
    assert [fine_clock(s) for s in (0.4, 61.25, 12 / 30)] == ["0:00.4", "1:01.2", "0:00.4"]


def test_levels_survive_a_video():
    assert [number_of(level_of(n)) for n in range(12)] == list(range(12))
