import re
from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QAbstractButton, QComboBox, QFileDialog

from app.controllers import remarks
from app.controllers.desk import open_desk
from app.controllers.remarks import (
    BROKEN,
    GETTING_READY,
    MAKING,
    STRANGER,
    UNUSABLE,
)
from app.controllers.scene import AvatarScene
from app.controllers.toolbox import Toolbox
from app.errors import CameraLostError, SeveralFacesError
from app.sources import PERFORMER
from app.views.live_window import NO_PROFILE, OPEN_FILE
from app.views.new_profile import NewProfileDialog
from app.workers.job import Job
from app.workers.live_loop import LiveLoop
from app.workers.probe import GuiProbe
from tests.app.gl import renderer_or_skip
from tests.app.live_fakes import AVATAR_LEVELS, CAMERA, OTHER_CAMERA, STILL, FakeToolbox, no_opengl


@pytest.fixture
def live(qtbot):
    """Opens live windows on toolboxes; afterwards nothing may run or be open."""
    opened = []

    def open_live(toolbox):
        window, controller = open_desk(toolbox)
        qtbot.addWidget(window)
        window.show()
        controller.start()
        opened.append((window, controller, toolbox))
        return window

    yield open_live
    for window, controller, toolbox in opened:
        window.close()
        threads = [*controller.findChildren(LiveLoop), *controller.findChildren(Job)]
        assert not any(thread.isRunning() for thread in threads)
        if isinstance(toolbox, FakeToolbox):
            assert not toolbox.open_now and not toolbox.render_threads


def somebody():
    return SimpleNamespace(rest_wxyz=np.array([1.0, 0, 0, 0]))


def shown_level(pane):
    """The grey level in the middle of a pane's picture, None without one."""
    if not pane.has_picture:
        return None
    image = pane.grab().toImage()
    return image.pixelColor(image.width() // 2, image.height() // 2).red()


def pixels_of(widget):
    """(H, W, 3) RGB as it is on the screen."""
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGBX8888)
    pixels = np.frombuffer(image.constBits(), np.uint8)
    return pixels.reshape(image.height(), -1, 4)[..., :3].astype(int)


def most_blue(widget):
    pixels = pixels_of(widget)
    return (pixels[..., 2] - pixels[..., 0]).max()


def level_of(key):
    return sum(key.encode()) % 200 + 20


def plays(window, key):
    return lambda: (
        window.source_pane.has_picture
        and (abs(shown_level(window.source_pane) - level_of(key)) <= 1)
    )


def button(pane, text):
    return next(one for one in pane.notice.buttons if one.text().startswith(text))


def choose(box, key):
    box.setCurrentIndex(box.findData(key))
    box.activated.emit(box.currentIndex())


def test_without_a_camera_performer_and_file_are_offered(live, qtbot):
    toolbox = FakeToolbox(cameras=())
    window = live(toolbox)
    assert "No camera was found" in window.source_pane.notice.text
    texts = [one.text() for one in window.source_pane.notice.buttons]
    assert texts == ["Virtual performer: still", "Video file…"]
    assert window.status.state == "No source" and not toolbox.opened
    qtbot.mouseClick(window.source_pane.notice.buttons[0], Qt.MouseButton.LeftButton)
    qtbot.waitUntil(plays(window, STILL))
    assert window.sources.currentData() == STILL and toolbox.opened == [STILL]


def test_a_camera_plugged_in_later_is_in_the_list_when_it_drops_down(live):
    toolbox = FakeToolbox(cameras=())
    window = live(toolbox)
    assert CAMERA not in window.sources.keys
    toolbox.camera_keys.append(CAMERA)
    window.sources.showPopup()
    assert CAMERA in window.sources.keys
    window.sources.hidePopup()


def test_without_a_profile_the_avatar_moves_at_once_above_an_invitation(live, qtbot):
    window = live(FakeToolbox())
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture)
    qtbot.waitUntil(plays(window, CAMERA))
    qtbot.waitUntil(lambda: window.status.state == "Tracking, training-free")
    qtbot.waitUntil(lambda: window.card.isVisible())
    assert "10 minutes" in window.card.button.text()
    qtbot.waitUntil(lambda: window.status.field("rate").endswith("fps"))
    qtbot.waitUntil(lambda: most_blue(window.source_pane.picture) > 150)


def test_a_first_start_that_takes_its_time_is_told(live, qtbot):
    toolbox = FakeToolbox()
    toolbox.ready.clear()
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.source_pane.notice.text == GETTING_READY)
    toolbox.ready.set()
    qtbot.waitUntil(plays(window, CAMERA))


def test_the_avatar_takes_on_the_head_that_was_learned_meanwhile_and_only_once(live, qtbot):
    toolbox = FakeToolbox()
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture)
    assert {wish.cast.user for wish in toolbox.wishes} == {None}
    toolbox.learned = learned = somebody()
    qtbot.waitUntil(lambda: toolbox.wishes[-1].cast.user is learned)
    cast = toolbox.wishes[-1].cast
    toolbox.learned = somebody()
    qtbot.wait(600)
    assert toolbox.wishes[-1].cast is cast


def test_a_profile_that_does_not_fit_the_face_is_told_without_fuss(live, qtbot, monkeypatch):
    monkeypatch.setattr(remarks, "LASTING_S", 0.3)
    toolbox = FakeToolbox(profiles=["anna"])
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    assert window.hint.text() == ""
    toolbox.stranger = True
    qtbot.waitUntil(lambda: window.status.state == "Tracking, training-free")
    qtbot.waitUntil(lambda: window.hint.text() == STRANGER)
    assert window.message_bar.text == "" and window.avatar_pane.has_picture
    toolbox.stranger = False
    qtbot.waitUntil(lambda: window.hint.text() == "")


def test_with_a_profile_avatar_landmarks_and_numbers_are_shown(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    assert window.profiles.currentData() == "anna"
    qtbot.waitUntil(lambda: window.status.field("dropped") == "0 dropped")
    qtbot.waitUntil(lambda: window.status.field("latency") != "")
    assert window.status.field("confidence") == "confidence 90 %"
    qtbot.waitUntil(lambda: most_blue(window.source_pane.picture) > 150)
    window.landmarks_box.click()
    qtbot.waitUntil(lambda: most_blue(window.source_pane.picture) < 10)


def test_a_lost_face_is_said_over_the_picture(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.source_pane.has_picture)
    assert window.source_pane.picture.badge == ""
    toolbox.lost = True
    qtbot.waitUntil(lambda: window.source_pane.picture.badge.startswith("Searching"))
    qtbot.waitUntil(lambda: window.status.state == "Searching for the face")
    assert window.avatar_pane.has_picture and window.status.field("confidence") == ""


def test_lasting_doubt_is_told(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    toolbox.confidence = 0.05
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.status.state.startswith("Unsure"))


def test_a_damaged_profile_is_told_and_the_face_tracked_without_it(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna", "bert"])
    toolbox.damaged = {"anna"}
    window = live(toolbox)
    qtbot.waitUntil(plays(window, CAMERA))
    assert "make it anew" in window.message_bar.text
    qtbot.waitUntil(lambda: window.hint.text() == UNUSABLE)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, training-free")
    choose(window.profiles, "bert")
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    assert window.message_bar.text == "" and window.hint.text() == ""


def test_a_busy_camera_can_be_tried_again(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    toolbox.busy = {CAMERA}
    window = live(toolbox)
    qtbot.waitUntil(lambda: "close other programs" in window.message_bar.text)
    assert window.message_bar.text.startswith("The camera Camera 0")
    assert not window.source_pane.has_picture and not window.avatar_pane.has_picture
    qtbot.waitUntil(lambda: window.status.state == "No source")
    toolbox.busy = set()
    qtbot.mouseClick(button(window.source_pane, "Try again"), Qt.MouseButton.LeftButton)
    qtbot.waitUntil(plays(window, CAMERA))
    assert window.message_bar.text == ""


def test_an_unplugged_camera_is_told_and_its_last_picture_does_not_stay(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture)
    toolbox.read_error = CameraLostError("Camera 0", 7)
    qtbot.waitUntil(lambda: "plug it in again" in window.message_bar.text)
    assert not window.source_pane.has_picture and not window.avatar_pane.has_picture
    assert not toolbox.open_now


def test_of_quick_choices_only_the_last_is_opened_and_never_two_at_once(live, qtbot):
    toolbox = FakeToolbox(cameras=[CAMERA, OTHER_CAMERA])
    toolbox.gate.clear()
    window = live(toolbox)
    qtbot.waitUntil(lambda: toolbox.opened == [CAMERA])
    for key in (STILL, CAMERA, OTHER_CAMERA, STILL, OTHER_CAMERA):
        choose(window.sources, key)
    assert window.source_pane.notice.text == "Opening Camera 2…"
    toolbox.gate.set()
    qtbot.waitUntil(plays(window, OTHER_CAMERA))
    assert toolbox.opened == [CAMERA, OTHER_CAMERA]
    assert toolbox.most_open == 1
    assert {source.key for source in toolbox.open_now} == {OTHER_CAMERA}


def test_another_profile_takes_over_while_the_picture_goes_on(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna", "bert"])
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    choose(window.profiles, NO_PROFILE.key)
    for _ in range(20):
        assert window.source_pane.has_picture and window.avatar_pane.has_picture
        qtbot.wait(5)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, training-free")
    choose(window.profiles, "bert")
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    assert toolbox.opened == [CAMERA] and window.profiles.currentData() == "bert"


def test_a_damaged_profile_is_told_while_the_picture_goes_on_without_one(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna", "bert"])
    toolbox.damaged = {"bert"}
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    choose(window.profiles, "bert")
    qtbot.waitUntil(lambda: "make it anew" in window.message_bar.text)
    qtbot.waitUntil(lambda: window.hint.text() == UNUSABLE)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, training-free")
    assert toolbox.opened == [CAMERA]


def test_a_camera_is_free_before_it_is_opened_again(live, qtbot):
    toolbox = FakeToolbox(cameras=[CAMERA, OTHER_CAMERA])
    window = live(toolbox)
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture)
    for key in (OTHER_CAMERA, CAMERA):
        choose(window.sources, key)
        assert not window.source_pane.has_picture and not window.avatar_pane.has_picture
        qtbot.waitUntil(plays(window, key))
    assert toolbox.most_open == 1 and window.status.field("dropped") in ("", "0 dropped")


def test_another_avatar_takes_over_from_the_last_picture_of_the_old_one(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    window = live(toolbox)
    qtbot.waitUntil(lambda: shown_level(window.avatar_pane) == AVATAR_LEVELS["own"])
    choose(window.avatars, "nora")
    levels = []
    for _ in range(20):
        levels.append(shown_level(window.avatar_pane))
        qtbot.wait(5)
    # The old picture stays until the new avatar's comes, and never comes back.
    assert set(levels) <= {AVATAR_LEVELS["own"], AVATAR_LEVELS["nora"]}
    assert levels == sorted(levels) and levels[-1] == AVATAR_LEVELS["nora"]
    assert toolbox.opened == [CAMERA] and toolbox.render_threads == 1


def test_a_machine_that_cannot_draw_still_shows_landmarks(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    toolbox.render_error = no_opengl()
    window = live(toolbox)
    qtbot.waitUntil(lambda: "no OpenGL" in window.message_bar.text)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    toolbox.render_error = None
    choose(window.avatars, "nora")
    qtbot.waitUntil(lambda: shown_level(window.avatar_pane) == AVATAR_LEVELS["nora"])


def test_an_error_of_the_program_is_told_and_the_window_goes_on(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    toolbox.tracker_error = ZeroDivisionError()
    with qtbot.capture_exceptions() as caught:
        window = live(toolbox)
        qtbot.waitUntil(lambda: window.message_bar.text[1:] == BROKEN[1:])
    assert [kind for kind, *_ in caught] == [ZeroDivisionError]
    toolbox.tracker_error = None
    choose(window.profiles, NO_PROFILE.key)
    qtbot.waitUntil(plays(window, CAMERA))


def test_closing_while_a_source_is_being_opened_closes_it(live, qtbot):
    toolbox = FakeToolbox()
    toolbox.gate.clear()
    window = live(toolbox)
    qtbot.waitUntil(lambda: toolbox.opened == [CAMERA])
    toolbox.gate.set()
    window.close()
    assert not toolbox.open_now and not window.isVisible()


def test_closing_while_everything_runs_ends_everything(live, qtbot):
    toolbox = FakeToolbox(profiles=["anna"])
    window = live(toolbox)
    window.new_profile_wanted.emit("bert", "clip.mp4")
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture and window.job_row.text != "")
    window.close()
    assert not toolbox.open_now and toolbox.profile_names == ["anna"]
    window.close()


def test_a_video_is_played_under_its_name(live, qtbot):
    window = live(FakeToolbox())
    window.take("/home/anna/my clip.mp4")
    qtbot.waitUntil(plays(window, "/home/anna/my clip.mp4"))
    assert window.sources.currentText() == "my clip.mp4"
    assert window.sources.toolTip() == "/home/anna/my clip.mp4"
    assert window.sources.keys[-1] == OPEN_FILE.key


def test_a_file_dialog_that_is_cancelled_changes_nothing(live, qtbot):
    toolbox = FakeToolbox()
    window = live(toolbox)
    qtbot.waitUntil(plays(window, CAMERA))
    choose(window.sources, OPEN_FILE.key)
    dialog = window.findChild(QFileDialog)
    assert dialog.isVisible()
    dialog.reject()
    assert window.sources.currentData() == CAMERA and toolbox.opened == [CAMERA]


def test_a_camera_is_mirrored_from_the_start_and_a_video_is_not(live, qtbot):
    window = live(FakeToolbox())
    assert window.mirror_box.isChecked()
    window.take("clip.mp4")
    assert not window.mirror_box.isChecked()
    window.mirror_box.setChecked(True)
    choose(window.profiles, NO_PROFILE.key)
    assert window.mirror_box.isChecked()


def open_dialog(window, qtbot):
    qtbot.mouseClick(window.new_profile_button, Qt.MouseButton.LeftButton)
    return window.findChild(NewProfileDialog)


def test_a_new_profile_is_made_beside_the_live_picture_and_then_used(live, qtbot, tmp_path):
    toolbox = FakeToolbox()
    window = live(toolbox)
    qtbot.waitUntil(plays(window, CAMERA))
    dialog = open_dialog(window, qtbot)
    dialog.source.setText(str(tmp_path))
    dialog.name.setText("anna")
    dialog.accept()
    qtbot.waitUntil(lambda: window.job_row.text.startswith("Training the regressor"))
    assert not window.new_profile_button.isEnabled() and toolbox.made_from == [str(tmp_path)]
    assert window.hint.text() == MAKING
    assert plays(window, CAMERA)() and window.avatar_pane.has_picture
    toolbox.making_gate.set()
    qtbot.waitUntil(lambda: window.profiles.currentData() == "anna")
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained")
    assert window.message_bar.text == "The profile anna was made."
    assert window.job_row.text == "" and window.new_profile_button.isEnabled()


def test_making_a_profile_can_be_cancelled(live, qtbot):
    toolbox = FakeToolbox()
    window = live(toolbox)
    window.new_profile_wanted.emit("anna", "clip.mp4")
    qtbot.waitUntil(lambda: window.job_row.text.startswith("Training"))
    qtbot.mouseClick(window.job_row.cancel_button, Qt.MouseButton.LeftButton)
    assert window.job_row.text.startswith("Stopping")
    qtbot.waitUntil(lambda: window.job_row.text == "")
    assert toolbox.profile_names == [] and window.message_bar.text == ""
    assert window.new_profile_button.isEnabled()
    assert window.hint.text() == "" and window.card.isVisible()


def test_a_video_that_gives_no_profile_is_told_with_what_to_do(live, qtbot):
    toolbox = FakeToolbox(profiles=["bert"])
    toolbox.making_error = SeveralFacesError("most frames of clip.mp4", 2)
    toolbox.making_gate.set()
    window = live(toolbox)
    window.new_profile_wanted.emit("anna", "clip.mp4")
    qtbot.waitUntil(lambda: "crop the others away" in window.message_bar.text)
    qtbot.waitUntil(lambda: window.job_row.text == "")
    assert window.profiles.currentData() == "bert" and "anna" not in window.profiles.keys


def test_the_dialog_says_what_is_missing_and_suggests_a_name(live, qtbot, tmp_path):
    toolbox = FakeToolbox(profiles=["anna"])
    window = live(toolbox)
    video = tmp_path / "anna.mp4"
    video.write_bytes(b"\0")
    dialog = open_dialog(window, qtbot)
    ok = dialog.buttons.buttons()[0]
    assert not ok.isEnabled()
    dialog.source.setText(str(tmp_path / "nothing.mp4"))
    assert "no file or folder" in dialog.remark and not ok.isEnabled()
    dialog.source.setText(str(video))
    assert dialog.name.text() == "anna" and "will be replaced" in dialog.remark
    assert ok.isEnabled()
    dialog.name.clear()
    qtbot.keyClicks(dialog.name, "what?")
    assert "'?'" in dialog.remark and not ok.isEnabled()
    dialog.name.clear()
    qtbot.keyClicks(dialog.name, "bert")
    dialog.source.setText("Virtual performer")
    assert dialog.name.text() == "bert" and ok.isEnabled()
    with qtbot.waitSignal(window.new_profile_wanted) as wanted:
        dialog.accept()
    assert wanted.args == ["bert", PERFORMER]


def test_every_control_has_a_name_and_is_reached_by_the_keyboard(live, qtbot):
    window = live(FakeToolbox(cameras=()))
    window.resize(1240, 600)

    def controls():
        found = [*window.findChildren(QComboBox), *window.findChildren(QAbstractButton)]
        return [one for one in found if one.isVisible()]

    # Three lists, two boxes, the new profile, and the notice's two buttons.
    qtbot.waitUntil(lambda: len(controls()) == 8)
    for control in controls():
        assert control.accessibleName() or getattr(control, "text", str)(), control
        assert control.focusPolicy() & Qt.FocusPolicy.TabFocus, control
    reached = set()
    for _ in range(20):
        reached.add(window.focusWidget())
        qtbot.keyClick(window.focusWidget() or window, Qt.Key.Key_Tab)
    assert set(controls()) <= reached


@pytest.mark.slow
@pytest.mark.gl
def test_the_virtual_performer_gets_a_profile_and_moves_an_avatar(live, qtbot, monkeypatch):
    renderer_or_skip().release()
    quicken(monkeypatch)
    window = live(Toolbox())
    window.take("performer:talking")
    # The kernels may have to be compiled first.
    qtbot.waitUntil(lambda: window.source_pane.has_picture, timeout=120_000)
    qtbot.waitUntil(lambda: window.status.state == "Tracking, training-free", timeout=30_000)
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture, timeout=30_000)
    probe = GuiProbe()
    probe.start()
    window.new_profile_wanted.emit("mara", PERFORMER)
    qtbot.waitUntil(lambda: window.profiles.currentData() == "mara", timeout=120_000)
    assert re.search(r"made from 1\d pictures", window.message_bar.text)
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture, timeout=30_000)
    # So quick a profile may not be good enough to be used.
    qtbot.waitUntil(lambda: window.status.state.startswith("Tracking"), timeout=40_000)
    probe.stop()
    # While a profile was trained, loaded and taken up, the window went on painting.
    long_ms = [round(turn.cpu_ms) for turn in probe.spells if turn.cpu_ms > 16]
    assert len(probe.spells) > 200 and len(long_ms) < 0.02 * len(probe.spells), long_ms
    pictures = []
    window.findChild(AvatarScene).painted.connect(lambda one: pictures.append(one.picture))
    qtbot.waitUntil(
        lambda: len(pictures) > 1 and moved(pictures[0], pictures[-1]) > 1e-3, timeout=20_000
    )


def quicken(monkeypatch):
    """Train on a quarter of the pictures, with a known camera and a small regressor."""
    from functools import partial

    from app import setup_steps
    from app.controllers import filming
    from core.pipeline import BuildSettings, build
    from core.regressor_trainer import TrainSettings

    settings = BuildSettings(train=TrainSettings(n_stages=4, n_ferns=80))

    def quick_build(model, images, landmarks, _focal_px, rng, _settings=None):
        return build(model, images, landmarks, 620.0, rng, settings)

    monkeypatch.setattr(setup_steps, "build", quick_build)
    film = filming.film_performer
    monkeypatch.setattr(filming, "film_performer", partial(film, every=4))


def moved(before, now):
    """Share of the pixels that have changed clearly."""
    return (np.abs(before.astype(int) - now).max(axis=2) > 24).mean()


class FakeGuided(QObject):
    finished = Signal(str)

    def __init__(self, source):
        super().__init__()
        self.source, self.shown, self.closed = source, 0, False

    def show(self):
        self.shown += 1

    def close(self):
        self.closed = True
        self.finished.emit("")


def test_the_guided_setup_gets_the_camera_and_gives_it_back(live, qtbot):
    toolbox, made = FakeToolbox(), []
    toolbox.guided_setup = lambda source: made.append(FakeGuided(source)) or made[-1]
    window = live(toolbox)
    qtbot.waitUntil(plays(window, CAMERA), timeout=5000)
    window.guided_wanted.emit()
    qtbot.waitUntil(lambda: not toolbox.open_now, timeout=5000)
    assert made[0].source == CAMERA and made[0].shown == 1
    window.guided_wanted.emit()
    assert len(made) == 1 and made[0].shown == 2
    toolbox.profile_names.append("me")
    made[0].finished.emit("me")
    qtbot.waitUntil(plays(window, CAMERA), timeout=5000)
    assert window.profiles.currentText() == "me"


def test_closing_the_live_window_closes_the_guided_setup(live, qtbot):
    toolbox, made = FakeToolbox(), []
    toolbox.guided_setup = lambda source: made.append(FakeGuided(source)) or made[-1]
    window = live(toolbox)
    window.guided_wanted.emit()
    window.close()
    assert made[0].closed


def test_the_dialog_of_new_profiles_offers_the_guided_setup_first(live, qtbot):
    toolbox = FakeToolbox()
    toolbox.guided_setup = FakeGuided
    window = live(toolbox)
    window.ask_for_profile()
    dialog = window.findChild(NewProfileDialog)
    (guided,) = [one for one in dialog.findChildren(QAbstractButton) if "Guided" in one.text()]
    with qtbot.waitSignal(window.guided_wanted, timeout=2000):
        guided.click()
