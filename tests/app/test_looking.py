import json

import cv2
import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication, QColorDialog, QFileDialog

from app.controllers.desk import open_desk
from app.controllers.looking import IN_SOFTWARE, Looking, quality_text
from app.look_files import KeptLook, load_looks, looks_file, save_looks
from app.render.look import AvatarLook, Background
from app.render.quality import Drawn
from app.views.avatar_panel import AvatarPanel
from app.workers.job import Job
from tests.app.live_fakes import FakeToolbox


@pytest.fixture
def toolbox():
    return FakeToolbox()


@pytest.fixture
def desk(qtbot, toolbox):
    """A live window that plays, and what changes how its avatar is seen."""
    window, controller = open_desk(toolbox)
    qtbot.addWidget(window)
    window.show()
    controller.start()
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture)
    yield window, controller, controller.findChild(Looking)
    window.close()


def last_look(toolbox):
    return toolbox.wishes[-1].look


def send_mouse(widget, kind, place, button=Qt.MouseButton.LeftButton):
    at = QPointF(place)
    buttons = button if kind != QEvent.Type.MouseButtonRelease else Qt.MouseButton.NoButton
    modifiers = Qt.KeyboardModifier.NoModifier
    globally = QPointF(widget.mapToGlobal(place))
    QApplication.sendEvent(widget, QMouseEvent(kind, at, globally, button, buttons, modifiers))


def drag(widget, way, button=Qt.MouseButton.LeftButton):
    start = widget.rect().center()
    send_mouse(widget, QEvent.Type.MouseButtonPress, start, button)
    send_mouse(widget, QEvent.Type.MouseMove, start + way, button)
    send_mouse(widget, QEvent.Type.MouseButtonRelease, start + way, button)


def turn_wheel(widget, place, units):
    QApplication.sendEvent(
        widget,
        QWheelEvent(
            QPointF(place), QPointF(widget.mapToGlobal(place)), QPoint(), QPoint(0, units),
            Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier,
            Qt.ScrollPhase.NoScrollPhase, False,
        ),
    )  # fmt: skip


def test_dragging_turns_the_avatar_the_way_the_mouse_goes(desk, toolbox, qtbot):
    window, _, looking = desk
    picture = window.avatar_pane.picture
    window.mirror_box.setChecked(False)
    drag(picture, QPoint(60, 30))
    assert looking.look.yaw_rad < 0 < looking.look.pitch_rad
    qtbot.waitUntil(lambda: last_look(toolbox).yaw_rad == looking.look.yaw_rad)
    looking.reset_view()
    window.mirror_box.setChecked(True)
    drag(picture, QPoint(60, 0))
    assert looking.look.yaw_rad > 0
    drag(picture, QPoint(40, -20), Qt.MouseButton.RightButton)
    assert looking.look.pan[0] > 0 > looking.look.pan[1]


def test_the_wheel_zooms_about_the_cursor(desk, toolbox):
    window, _, looking = desk
    picture = window.avatar_pane.picture
    area = picture.picture_rect()
    place = area.center() + QPointF(0.25 * area.height(), 0)
    turn_wheel(picture, place.toPoint(), 480)
    look = looking.look
    assert look.zoom > 1.5
    # What was at the cursor before is there still: a quarter of the height right of the middle.
    at = 0.25 * look.zoom + look.pan[0]
    assert at == pytest.approx(0.25, abs=0.01)


def test_keys_do_what_the_mouse_does_and_home_takes_it_back(desk, qtbot):
    window, _, looking = desk
    picture = window.avatar_pane.picture
    for key, modifier in (
        (Qt.Key.Key_Left, Qt.KeyboardModifier.NoModifier),
        (Qt.Key.Key_Up, Qt.KeyboardModifier.NoModifier),
        (Qt.Key.Key_Right, Qt.KeyboardModifier.ShiftModifier),
        (Qt.Key.Key_Plus, Qt.KeyboardModifier.NoModifier),
    ):
        qtbot.keyClick(picture, key, modifier)
    look = looking.look
    assert look.yaw_rad != 0 and look.pitch_rad < 0 and look.pan[0] > 0 and look.zoom > 1
    qtbot.keyClick(picture, Qt.Key.Key_Home)
    assert looking.look.changed(mirrored=False) == AvatarLook()
    drag(picture, QPoint(50, 0))
    send_mouse(picture, QEvent.Type.MouseButtonDblClick, picture.rect().center())
    assert looking.look.changed(mirrored=False) == AvatarLook()


def test_the_picture_changes_although_the_source_stands_still(desk, toolbox, qtbot):
    window, controller, looking = desk
    controller.player.play(None)
    qtbot.waitUntil(lambda: not controller.player.busy)
    qtbot.wait(50)
    before = len(toolbox.wishes)
    qtbot.keyClick(window.avatar_pane.picture, Qt.Key.Key_Left)
    qtbot.waitUntil(lambda: len(toolbox.wishes) > before)
    wish = toolbox.wishes[-1]
    assert wish.look == looking.look
    # It tells nothing of how long a frame took.
    assert wish.delivered_s is None


def test_the_avatar_mirrors_as_the_webcam_picture_does_or_always_or_never(desk, toolbox, qtbot):
    window, _, looking = desk
    panel = looking.panel
    for mirror, box, mirrored in (
        ("source", True, True), ("source", False, False), ("yes", False, True), ("no", True, False),
    ):  # fmt: skip
        window.mirror_box.setChecked(box)
        panel.mirror_wanted.emit(mirror)
        qtbot.waitUntil(lambda mirrored=mirrored: last_look(toolbox).mirrored is mirrored)


def test_the_window_never_turns_over_the_avatars_finished_picture(desk, toolbox):
    window, *_ = desk
    window.mirror_box.setChecked(True)
    # Text in a background picture would be turned over with it.
    assert not window.avatar_pane.picture._mirrored
    assert window.source_pane.picture._mirrored


def test_each_avatar_keeps_its_own_look(desk, toolbox, qtbot):
    window, _, looking = desk
    looking.see(looking.look.changed(lights="neon"))
    window.avatar_chosen.emit("nora")
    assert looking.look.lights == "studio"
    assert looking.panel.lights.currentData() == "studio"
    looking.see(looking.look.changed(lights="night"))
    window.avatar_chosen.emit("own")
    assert looking.look.lights == "neon"
    qtbot.waitUntil(lambda: last_look(toolbox).lights == "neon")


def test_looks_are_there_again_after_a_restart(desk, qtbot):
    window, _, looking = desk
    look = AvatarLook(0.3, 0.2, 2.0, (0.1, -0.2), "bust", Background("color", (1, 2, 3)), "ring")
    looking.see(look)
    looking.panel.mirror_wanted.emit("no")
    window.close()
    again, controller = open_desk(FakeToolbox())
    qtbot.addWidget(again)
    kept = controller.findChild(Looking)
    assert kept.look == look
    assert kept.panel.mirror.currentData() == "no"
    kept.reset_all()
    assert kept.look.changed(mirrored=False) == AvatarLook()


def test_the_panel_shows_what_the_mouse_did_and_wishes_what_its_controls_say(qtbot):
    panel = AvatarPanel(("studio", "ring"))
    qtbot.addWidget(panel)
    wishes = []
    panel.look_wanted.connect(wishes.append)
    panel.show_look(AvatarLook(yaw_rad=0.5, zoom=2.0, pan=(0.2, 0.0)), "source")
    assert not wishes
    assert (panel.turn.value, panel.zoom.value) == (29, 200)
    panel.turn.slider.setValue(-90)
    assert wishes[-1].yaw_rad == pytest.approx(-np.pi / 2)
    panel.zoom.slider.setValue(100)
    assert wishes[-1].zoom == pytest.approx(1.0)
    assert wishes[-1].pan == pytest.approx((0.1, 0.0))
    for chooser, row, read in (
        (panel.framing, 2, lambda look: look.framing == "close"),
        (panel.lights, 1, lambda look: look.lights == "ring"),
        (panel.background, 5, lambda look: look.background.kind == "transparent"),
        (panel.samples, 0, lambda look: look.samples == 0),
    ):
        chooser.activated.emit(row)
        assert read(wishes[-1])
    panel.brightness.slider.setValue(150)
    assert wishes[-1].brightness == 1.5


def test_a_colour_is_seen_while_it_is_being_chosen_and_taken_back_on_cancel(qtbot):
    panel = AvatarPanel(("studio",))
    qtbot.addWidget(panel)
    wishes = []
    panel.look_wanted.connect(wishes.append)
    panel.show_look(AvatarLook(background=Background("key")), "source")
    dialog = panel.ask_for_color()
    assert isinstance(dialog, QColorDialog)
    dialog.setCurrentColor(Qt.GlobalColor.blue)
    assert wishes[-1].background.key == (0, 0, 255)
    assert wishes[-1].background.color == Background().color
    dialog.reject()
    assert wishes[-1].background.key == (0, 255, 0)


def test_a_chosen_picture_is_put_behind_the_avatar(desk, toolbox, tmp_path, qtbot):
    looking = desk[2]
    path = tmp_path / "wall.png"
    cv2.imwrite(str(path), np.zeros((20, 30, 3), np.uint8))
    looking.panel.background.activated.emit(3)  # nothing chosen yet: a dialog asks
    dialog = looking.panel.findChild(QFileDialog)
    dialog.fileSelected.emit(str(path))
    dialog.close()
    qtbot.waitUntil(lambda: last_look(toolbox).background.kind == "picture")
    assert last_look(toolbox).background.picture == str(path)


def test_a_picture_goes_to_the_avatar_for_which_it_was_chosen(desk, tmp_path, qtbot):
    window, _, looking = desk
    path = tmp_path / "wall.png"
    cv2.imwrite(str(path), np.zeros((20, 30, 3), np.uint8))
    looking.use_picture(str(path))
    window.avatar_chosen.emit("nora")
    qtbot.waitUntil(lambda: not looking.findChildren(Job))
    assert looking.look.background.kind == "studio"
    window.avatar_chosen.emit("own")
    assert looking.look.background.picture == str(path)


def test_the_wheel_scrolls_the_panel_and_changes_only_what_was_clicked(qtbot):
    panel = AvatarPanel(("studio", "ring"))
    qtbot.addWidget(panel)
    panel.show()
    wishes = []
    panel.look_wanted.connect(wishes.append)
    for control in (panel.turn.slider, panel.lights):
        turn_wheel(control, control.rect().center(), -120)
        assert not wishes
        control.setFocus()
        qtbot.waitUntil(control.hasFocus)
        turn_wheel(control, control.rect().center(), -120)
        # A slider that was clicked moves; a list is never chosen from without being open.
        assert bool(wishes) == (control is panel.turn.slider)
        wishes.clear()


def test_a_file_without_a_picture_is_named_and_the_background_stays(desk, tmp_path, qtbot):
    window, _, looking = desk
    looking.see(looking.look.changed(background=Background("color", (9, 9, 9))))
    path = tmp_path / "notes.txt"
    path.write_text("no picture")
    looking.use_picture(str(path))
    qtbot.waitUntil(lambda: "no picture inside" in window.message_bar.text)
    assert str(path) in window.message_bar.text
    assert looking.look.background == Background("color", (9, 9, 9))
    assert looking.panel.background.currentData() == "color"
    looking.see(looking.look.changed(background=Background("studio")))
    assert window.message_bar.text == ""


def test_a_picture_that_is_gone_since_the_last_time_is_told(qtbot, tmp_path):
    gone = str(tmp_path / "gone.png")
    save_looks({"own": KeptLook(AvatarLook(background=Background("picture", picture=gone)))})
    window, controller = open_desk(FakeToolbox())
    qtbot.addWidget(window)
    controller.start()
    qtbot.waitUntil(lambda: gone in window.message_bar.text)
    window.close()


def test_a_transparent_picture_lies_on_a_chequered_ground(desk, qtbot):
    window, _, looking = desk
    picture = window.avatar_pane.picture
    looking.see(looking.look.changed(background=Background("transparent")))
    qtbot.waitUntil(lambda: picture._checkered)
    looking.see(looking.look.changed(background=Background("key")))
    qtbot.waitUntil(lambda: not picture._checkered)


def test_the_menu_frames_the_avatar_and_takes_the_view_back(desk):
    window, _, looking = desk
    actions = {action.text(): action for action in window.menu("Avatar").actions()}
    looking.see(looking.look.turned(1.0, 0.2))
    actions["Close-up of the face"].trigger()
    assert looking.look.framing == "close" and looking.look.yaw_rad == 0
    looking.see(looking.look.zoomed(2.0))
    actions["&Reset view"].trigger()
    assert looking.look.zoom == 1.0 and looking.look.framing == "close"


def test_the_panel_is_in_the_menu_and_every_control_has_a_name(desk):
    window, _, looking = desk
    assert any("Avatar" in action.text() for action in window.menu("View").actions())
    panel = looking.panel
    for control in (panel.framing, panel.mirror, panel.background, panel.lights, panel.samples):
        assert control.accessibleName()
    for slider in (panel.turn, panel.tilt, panel.zoom, panel.brightness):
        assert slider.slider.accessibleName()


def test_the_panel_tells_how_the_avatar_is_drawn():
    assert quality_text(Drawn(0.65, 0, True)).startswith("Drawn at 65 %")
    assert quality_text(Drawn(1.0, 0, True)) == IN_SOFTWARE
    assert quality_text(Drawn(1.0, 4, False)) == "Drawn with 4 samples per pixel."
    assert quality_text(Drawn(1.0, 0, False)) == ""


def test_damaged_settings_cost_only_what_is_damaged():
    assert load_looks() == {}
    save_looks({"nora": KeptLook(AvatarLook(zoom=2.0), "yes")})
    content = json.loads(looks_file().read_text())
    content["avatars"]["nora"] |= {"lights": "moon", "yaw_rad": "left", "samples": True}
    content["avatars"]["leo"] = {"zoom": 1e9, "pan": [0, 9], "background": {"key": [1, 2, 300]}}
    content["avatars"]["mei"] = 3
    looks_file().write_text(json.dumps(content))
    looks = load_looks()
    assert looks["nora"] == KeptLook(AvatarLook(zoom=2.0), "yes")
    assert looks["leo"].look == AvatarLook(zoom=6.0, pan=(0.0, 1.5))
    assert "mei" not in looks
    looks_file().write_text("{")
    assert load_looks() == {}


def test_a_folder_that_cannot_be_written_to_costs_a_habit_only(home):
    home.mkdir(parents=True)
    (home / "settings").write_text("a file in the way")
    save_looks({"nora": KeptLook()})
    assert load_looks() == {}
