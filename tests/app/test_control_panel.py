"""The control panel in the live window: every setting reaches the drive, is kept, and undone."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtCore import QModelIndex, Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QApplication,
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QInputDialog,
    QLineEdit,
    QSlider,
)

from app.controllers.controlling import Controlling
from app.controllers.desk import open_desk
from app.controllers.player import Performer
from app.controllers.toolbox import Toolbox
from app.drive_files import FIRST, drive_file, load_kept
from app.views.control.feel_page import CENTRE_ROWS, SECTIONS
from app.views.control.response_model import COLUMNS
from app.views.control.words import PARTS, plain_name, short_name, told_weights
from core.arkit import EXPRESSION_NAMES
from core.blink_levels import BlinkLevels
from core.drive_presets import KEYS, PRESETS
from core.drive_settings import DriveSettings
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from tests.app.gl import renderer_or_skip
from tests.app.live_fakes import FakeToolbox, FakeTracker
from tests.core.driven_faces import FPS, face, index, solved

ROWS = [row for rows in (*SECTIONS.values(), CENTRE_ROWS) for row in rows]


class Desk:
    """A live window that plays nothing; the test drives the faces."""

    def __init__(self, window, controller):
        self.window, self.controller = window, controller
        self.control = controller.findChild(Controlling)
        self.panel, self.drive = self.control.panel, controller.drive
        self.time_s = 0.0

    def solve(self, seconds=0.4, **state):
        for _ in range(round(seconds * FPS)):
            self.time_s += 1 / FPS
            driven = self.drive.step(solved(time_s=self.time_s, **state))
        return driven

    def editor(self, part, name):
        return self.panel.feel.editors[part, name]


def open_panel():
    window, controller = open_desk(FakeToolbox(cameras=(), profiles=("anna", "bert")))
    window.resize(1280, 720)
    window.show()
    controller.start()
    window.panels.show("control")
    QTest.qWaitForWindowActive(window)
    return Desk(window, controller)


@pytest.fixture(scope="module")
def shared(qapp, tmp_path_factory):
    """One window for most tests: opening it takes longer than they do."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FACEPUPPET_HOME", str(tmp_path_factory.mktemp("home")))
        one = open_panel()
        yield one
        one.window.close()


@pytest.fixture
def desk(shared):
    """The panel with the profile anna, of whom nothing is kept yet."""
    shared.window.show()
    shared.window.activateWindow()
    shared.window.panels.show("control")
    QTest.qWaitForWindowActive(shared.window)
    shared.window.profile_chosen.emit("anna")
    for key, shown in enumerate(shared.drive.keys_shown, 1):
        if shown:
            shared.drive.press(key)
            shared.drive.release(key)
    shared.solve(1.0, lost=True)
    shared.drive.reset()
    page = shared.panel.responses
    page.part.setCurrentIndex(0)
    page.table.clearSelection()
    shared.window.message_bar.tell("")
    yield shared
    # What was changed is kept now, in the folder of this test.
    shared.window.avatar_chosen.emit("own")
    shared.window.profile_chosen.emit("")
    shared.window.hide()


@pytest.fixture
def own_desk():
    one = open_panel()
    yield one
    one.window.close()


def press_key(desk, key, release=True):
    QTest.keyPress(desk.window, key, Qt.KeyboardModifier.ControlModifier)
    if release:
        QTest.keyRelease(desk.window, key, Qt.KeyboardModifier.ControlModifier)


# -- feel -------------------------------------------------------------------------------------


def change_by_key(widget):
    assert widget.focusPolicy() & Qt.FocusPolicy.TabFocus
    if isinstance(widget, QCheckBox):
        QTest.keyClick(widget, Qt.Key.Key_Space)
    elif isinstance(widget, QComboBox):
        QTest.keyClick(widget, Qt.Key.Key_Down if widget.currentIndex() == 0 else Qt.Key.Key_Up)
    else:
        QTest.keyClick(widget, Qt.Key.Key_Right)


def test_every_setting_can_be_changed_from_the_keyboard_and_undone(desk):
    for row in ROWS:
        before = desk.drive.settings
        editor = desk.editor(row.part, row.name)
        change_by_key(getattr(editor, "slider", editor))
        part, old = getattr(desk.drive.settings, row.part), getattr(before, row.part)
        assert getattr(part, row.name) != getattr(old, row.name), row
        desk.control.undo()
        assert desk.drive.settings == before


def test_the_page_shows_what_is_set_and_delete_goes_back_to_the_usual(desk):
    slider = desk.editor("head", "yaw")
    slider.slider.setValue(slider.slider.maximum())
    assert desk.drive.settings.head.yaw == 3.0
    assert slider.value_label.text() == "300\N{NO-BREAK SPACE}%"
    QTest.keyClick(slider.slider, Qt.Key.Key_Delete)
    assert desk.drive.settings.head.yaw == 1.0
    QTest.mouseDClick(slider.slider, Qt.MouseButton.LeftButton)
    assert desk.drive.settings.head.yaw == 1.0


def test_every_control_has_a_name_and_a_tip(desk):
    kinds = (QAbstractButton, QComboBox, QSlider, QLineEdit)
    checked = 0
    for widget in (w for kind in kinds for w in desk.panel.findChildren(kind)):
        inside = isinstance(widget.parent(), (QComboBox, QAbstractSpinBox))
        if inside or widget.objectName().startswith("qt_") or "Scroll" in type(widget).__name__:
            continue
        if widget.metaObject().className() in ("QTableCornerButton", "CloseButton", "QToolButton"):
            continue
        text = widget.text() if isinstance(widget, QAbstractButton) else ""
        assert widget.accessibleName() or text, widget
        if widget is not desk.panel.responses.part:
            assert widget.toolTip(), (widget.accessibleName(), text)
        checked += 1
    assert checked > 40


def test_recentre_by_its_key_and_by_its_button(desk):
    desk.solve(angles_deg=(15, 5, 0))
    press_key(desk, Qt.Key.Key_R)
    driven = desk.solve(1.0, angles_deg=(15, 5, 0))
    angles = head_angles_from_matrix(matrix_from_quaternion(driven.rotation_wxyz))
    assert np.abs(angles).max() < 1e-3
    desk.solve(angles_deg=(-10, 0, 0))
    desk.panel.feel.recentre_button.click()
    driven = desk.solve(1.0, angles_deg=(-10, 0, 0))
    angles = head_angles_from_matrix(matrix_from_quaternion(driven.rotation_wxyz))
    assert np.abs(angles).max() < 1e-3


def test_recentring_is_told_and_that_of_a_turned_head_is_doubted(desk):
    bar, menu = desk.window.message_bar, desk.control.hotkeys
    tell = desk.control._on_solved
    tell(SimpleNamespace(state=solved(lost=True)))
    desk.control.recentre()
    assert "as soon as" in bar.text
    tell(SimpleNamespace(state=solved(angles_deg=(12, 0, 0))))
    desk.control.recentre()
    assert "straight ahead" in bar.text and "Forget centre" in bar.text
    assert menu.uncentre in desk.window.menu("Face").actions()
    tell(SimpleNamespace(state=solved(angles_deg=(34, 0, 0))))
    desk.control.recentre()
    assert "34°" in bar.text
    driven = desk.solve(1.0, angles_deg=(34, 0, 0))
    bar.buttons[0].click()
    driven = desk.solve(1.0, angles_deg=(34, 0, 0))
    angles = head_angles_from_matrix(matrix_from_quaternion(driven.rotation_wxyz))
    assert np.abs(angles).max() > 0.2
    menu.uncentre.trigger()
    assert "forgotten" in bar.text


def test_a_centre_can_be_forgotten_and_a_recentring_undone(desk, qtbot):
    forget = desk.panel.feel.uncentre_button
    assert not forget.isEnabled()
    desk.control.recentre()
    desk.solve(angles_deg=(15, 0, 0))
    qtbot.waitUntil(forget.isEnabled)
    forget.click()
    desk.solve(angles_deg=(15, 0, 0))
    assert desk.drive.centre is None
    desk.control.undo()
    desk.solve(angles_deg=(15, 0, 0))
    assert desk.drive.centre is not None
    desk.control.undo()
    desk.solve(angles_deg=(15, 0, 0))
    assert desk.drive.centre is None


# -- coefficients -----------------------------------------------------------------------------


def cell(desk, name, field):
    column = 2 + [one.field for one in COLUMNS].index(field)
    return desk.panel.responses.model.index(index(name), column)


def show_page(desk, page):
    desk.panel.tabs.setCurrentWidget(page)
    page.setFocus()


def test_a_number_is_typed_into_the_table(desk, qtbot):
    page = desk.panel.responses
    show_page(desk, page)
    page.table.setFocus()
    page.table.setCurrentIndex(cell(desk, "jawOpen", "gain"))
    QTest.keyClick(page.table, Qt.Key.Key_F2)
    box = page.table.findChild(QDoubleSpinBox)
    assert box.accessibleName() == "Jaw open, gain: 1.00"
    box.selectAll()
    QTest.keyClicks(box, "1.5")
    QTest.keyClick(box, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: desk.drive.settings.responses[index("jawOpen")].gain == 1.5)
    assert desk.panel.presets.presets.currentText() == "Your own"


def test_numbers_out_of_range_are_limited(desk):
    model = desk.panel.responses.model
    assert model.setData(cell(desk, "jawOpen", "high"), 7.0) is False
    assert model.setData(cell(desk, "jawOpen", "high"), 0.0) is True
    assert desk.drive.settings.responses[index("jawOpen")].high == 0.05
    assert model.setData(model.index(0, 0), 1.0) is False


def test_bars_show_live_values_marks_and_result(desk, qtbot):
    page = desk.panel.responses
    show_page(desk, page)
    page.model.setData(cell(desk, "jawOpen", "gain"), 2.0)
    desk.solve(expression=face(jawOpen=0.4))
    desk.solve(expression=face(jawOpen=0.2))
    row = index("jawOpen")
    qtbot.waitUntil(lambda: page.model.value(row).tracked > 0)
    value = page.model.value(row)
    assert value.tracked == pytest.approx(0.2, abs=0.02)
    assert value.shown == pytest.approx(0.4, abs=0.04)
    assert value.seen == pytest.approx((0.2, 0.4), abs=0.02)
    told = page.model.index(row, 1).data(Qt.ItemDataRole.AccessibleTextRole)
    assert re.fullmatch(r"Jaw open: tracked 0\.2\d, shown 0\.4\d, seen 0\.\d\d to 0\.\d\d", told)
    page.forget_button.click()
    desk.solve(0.1, expression=face(jawOpen=0.2))
    assert desk.drive.seen[row, 1] < 0.25


def test_bars_are_painted_as_long_as_the_values(desk, qtbot):
    page = desk.panel.responses
    show_page(desk, page)
    table = page.table

    def blue(row):
        image = table.viewport().grab(table.visualRect(page.model.index(row, 1))).toImage()
        accent = table.palette().highlight().color()
        line = [image.pixelColor(x, image.height() // 3) for x in range(image.width())]
        return sum(abs(c.blue() - accent.blue()) + abs(c.red() - accent.red()) < 20 for c in line)

    lengths = []
    for value in (0.2, 0.8):
        desk.solve(1.0, expression=face(eyeBlinkLeft=value, eyeBlinkRight=value, eyeWideLeft=value))
        qtbot.waitUntil(lambda v=value: abs(page.model.value(4).tracked - v) < 0.02)
        lengths.append(blue(4))
    assert lengths[1] > 2.5 * lengths[0] > 0


def test_the_table_is_updated_ten_times_a_second_and_only_while_it_is_seen(desk, qtbot):
    page, shown = desk.panel.responses, []
    page.model.dataChanged.connect(lambda *_: shown.append(1))
    show_page(desk, desk.panel.feel)
    desk.solve(expression=face(jawOpen=0.4))
    qtbot.wait(350)
    assert not shown
    show_page(desk, page)
    qtbot.wait(1050)
    assert 3 <= len(shown) <= 12
    desk.window.panels.dock("control").hide()
    shown.clear()
    qtbot.wait(300)
    assert not shown


def test_the_face_you_make_becomes_full_and_that_can_be_undone(own_desk):
    desk = own_desk
    page = desk.panel.responses
    made = {"expression": face(jawOpen=0.5, mouthSmileLeft=0.4)}
    desk.solve(1.0, **made)
    page.face_button.click()
    driven = desk.solve(**made)
    assert driven.expression[index("jawOpen")] > 0.98
    assert driven.expression[index("mouthSmileLeft")] > 0.98
    show_page(desk, page)
    page.table.setFocus()
    QTest.keyClick(page.table, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert desk.solve(**made).expression[index("jawOpen")] == pytest.approx(0.5, abs=0.02)


def test_the_greatest_value_seen_becomes_full(desk):
    page = desk.panel.responses
    desk.solve(1.0, expression=face(jawOpen=0.7, mouthPucker=0.5))
    desk.solve(1.0)
    page.range_button.click()
    responses = desk.drive.settings.responses
    assert responses[index("jawOpen")].high == pytest.approx(0.7, abs=0.02)
    assert responses[index("mouthPucker")].high == pytest.approx(0.5, abs=0.02)
    assert responses[index("browDownLeft")].high == 1.0


def test_only_the_selected_coefficients_become_full_or_usual(desk):
    page = desk.panel.responses
    show_page(desk, page)
    assert not page.full_button.isEnabled()
    desk.solve(1.0, expression=face(jawOpen=0.5, mouthPucker=0.5))
    page.table.selectRow(index("jawOpen"))
    page.full_button.click()
    responses = desk.drive.settings.responses
    assert responses[index("jawOpen")].high == pytest.approx(0.5, abs=0.02)
    assert responses[index("mouthPucker")].high == 1.0
    page.model.setData(cell(desk, "mouthPucker", "gain"), 2.0)
    page.reset_button.click()
    assert desk.drive.settings.responses[index("jawOpen")].high == 1.0
    assert desk.drive.settings.responses[index("mouthPucker")].gain == 2.0
    page.reset_all_button.click()
    assert desk.drive.settings.responses == FIRST.responses
    desk.panel.presets.undo_button.click()
    assert desk.drive.settings.responses[index("mouthPucker")].gain == 2.0


def test_a_resting_face_as_full_is_refused_in_words(desk):
    desk.solve()
    desk.panel.responses.face_button.click()
    assert "make the face, hold it" in desk.window.message_bar.text
    desk.solve(lost=True)
    desk.panel.responses.face_button.click()
    assert "No face is tracked" in desk.window.message_bar.text
    assert desk.drive.settings.responses == FIRST.responses


def test_parts_of_the_face_can_be_shown_alone(desk):
    page = desk.panel.responses
    shown = {}
    for row, part in enumerate(PARTS):
        page.part.setCurrentIndex(row)
        shown[part] = [n for k, n in enumerate(EXPRESSION_NAMES) if not page.table.isRowHidden(k)]
    assert shown.pop("Whole face") == list(EXPRESSION_NAMES)
    assert sorted(n for names in shown.values() for n in names) == sorted(EXPRESSION_NAMES)


def test_names_are_words():
    assert plain_name("mouthSmileLeft") == "Mouth smile left"
    assert short_name("mouthSmileLeft") == "Mouth smile L"
    assert plain_name("jawOpen") == "Jaw open"
    told = told_weights(face(mouthSmileLeft=0.5, mouthSmileRight=0.5, jawOpen=0.25))
    assert told.replace("\N{NO-BREAK SPACE}", " ") == "mouth smile 50 %, jaw open 25 %"
    assert told_weights(face()) == "nothing"
    assert told_weights(np.full(46, 0.3)).endswith(", 23 more")


# -- expression keys --------------------------------------------------------------------------


def test_ctrl_and_a_digit_show_a_face_until_they_are_pressed_again(desk):
    press_key(desk, Qt.Key.Key_3)
    assert desk.solve(1.0).expression[index("eyeWideLeft")] == pytest.approx(0.85)
    press_key(desk, Qt.Key.Key_3)
    assert desk.solve(1.0).expression[index("eyeWideLeft")] == 0


@pytest.mark.parametrize("let_go", [Qt.Key.Key_2, Qt.Key.Key_Control])
def test_a_key_to_hold_shows_its_face_until_it_is_let_go(desk, let_go):
    page = desk.panel.keys
    page.list.setCurrentRow(1)
    page.hold.setCurrentIndex(0)
    page.hold.activated.emit(0)
    assert desk.drive.settings.keys[1].hold
    press_key(desk, Qt.Key.Key_2, release=False)
    assert desk.solve(1.0).expression[index("mouthSmileLeft")] == pytest.approx(0.9)
    QTest.keyRelease(desk.window, let_go)
    assert desk.solve(1.0).expression[index("mouthSmileLeft")] == 0


def test_a_key_takes_the_face_of_this_moment_and_is_kept(desk):
    page = desk.panel.keys
    page.list.setCurrentRow(4)
    desk.solve(1.0, expression=face(cheekPuffLeft=0.8))
    page.mine_button.click()
    press_key(desk, Qt.Key.Key_5)
    assert desk.solve(1.0).expression[index("cheekPuffLeft")] == pytest.approx(0.8, abs=0.02)
    assert "cheek puff left 80" in page.content.text()
    desk.control.keep()
    assert load_kept("anna", "own").settings.keys[4] == desk.drive.settings.keys[4]


def test_a_key_is_not_made_of_no_face(desk):
    desk.panel.keys.mine_button.click()
    assert "No face is tracked" in desk.window.message_bar.text
    desk.solve()
    desk.panel.keys.mine_button.click()
    assert "make the face, hold it" in desk.window.message_bar.text
    assert desk.drive.settings.keys == KEYS


def test_a_key_is_named_filled_tried_and_cleared(desk, qtbot):
    page = desk.panel.keys
    show_page(desk, page)
    page.list.setCurrentRow(0)
    page.name.setText("Hello")
    page.name.editingFinished.emit()
    assert page.list.item(0).text().startswith("Ctrl+1   Hello")
    page.face.setCurrentText("Kiss")
    page.face.activated.emit(page.face.currentIndex())
    assert desk.drive.settings.keys[0].weights == KEYS[6].weights
    page.way.activated.emit(page.way.findData("face"))
    assert desk.drive.settings.keys[0].way == "face"
    page.fade_in.slider.setValue(100)
    assert desk.drive.settings.keys[0].fade_in_s == 1.0
    QTest.mousePress(page.try_button, Qt.MouseButton.LeftButton)
    assert desk.drive.keys_shown[0]
    qtbot.waitUntil(lambda: "● on" in page.list.item(0).text())
    QTest.mouseRelease(page.try_button, Qt.MouseButton.LeftButton)
    assert not desk.drive.keys_shown[0]
    qtbot.waitUntil(lambda: "● on" not in page.list.item(0).text())
    page.clear_button.click()
    assert page.list.item(0).text() == "Ctrl+1   not used"
    assert not page.try_button.isEnabled()
    assert desk.drive.settings.keys[1] == KEYS[1]


def test_the_keys_are_in_the_menu_of_faces(desk):
    menu = desk.window.menu("Face")
    texts = [action.text() for action in menu.actions()]
    assert "&Recentre" in texts
    faces = next(a.menu() for a in menu.actions() if a.text() == "&Expression")
    keys = [action.shortcut() for action in faces.actions()]
    assert keys == [QKeySequence(f"Ctrl+{n}") for n in range(1, 10)]


# -- presets, files ---------------------------------------------------------------------------


def choose_preset(desk, name):
    box = desk.panel.presets.presets
    box.setCurrentIndex(box.findData(name))
    box.activated.emit(box.currentIndex())


def test_a_preset_replaces_everything_but_the_keys_and_can_be_undone(desk):
    desk.panel.keys.list.setCurrentRow(0)
    desk.panel.keys.clear_button.click()
    keys = desk.drive.settings.keys
    choose_preset(desk, "Calm")
    assert desk.drive.settings.head == PRESETS["Calm"][1].head
    assert desk.drive.settings.keys == keys
    assert desk.panel.presets.presets.currentData() == "Calm"
    assert not desk.panel.presets.delete_button.isEnabled()
    desk.panel.presets.undo_button.click()
    assert desk.drive.settings.head == FIRST.head
    assert desk.panel.presets.presets.currentData() == "Natural"


def test_a_preset_of_ones_own_is_saved_chosen_and_deleted(desk, qtbot):
    presets = desk.panel.presets
    desk.editor("head", "yaw").slider.setValue(30)
    mine = desk.drive.settings.head
    presets.save_button.click()
    dialog = desk.window.findChild(QInputDialog)
    dialog.setTextValue("Evening")
    dialog.accept()
    assert presets.presets.currentData() == "Evening"
    choose_preset(desk, "Natural")
    choose_preset(desk, "Evening")
    assert desk.drive.settings.head == mine
    assert presets.delete_button.isEnabled()
    presets.delete_button.click()
    assert presets.presets.findData("Evening") < 0
    presets.save_wanted.emit("Natural")
    assert "the name of a preset of the program" in desk.window.message_bar.text


def test_settings_are_kept_for_the_profile_and_the_avatar(desk, qtbot):
    slider = desk.editor("head", "yaw").slider
    slider.setValue(20)
    anna = desk.drive.settings.head.yaw
    desk.window.profile_chosen.emit("bert")
    assert desk.drive.settings.head.yaw == 1.0
    slider.setValue(150)
    bert = desk.drive.settings.head.yaw
    desk.window.avatar_chosen.emit("nora")
    assert desk.drive.settings.head.yaw == bert
    desk.window.profile_chosen.emit("anna")
    desk.window.avatar_chosen.emit("own")
    assert desk.drive.settings.head.yaw == anna
    assert not desk.panel.presets.undo_button.isEnabled()


def test_a_centre_that_waits_for_a_face_is_kept_when_it_has_come(desk, qtbot):
    desk.control.recentre()
    qtbot.wait(1200)
    assert load_kept("anna", "own").centre is None
    desk.solve(place_mm=(50, 0, 700))
    desk.window.profile_chosen.emit("bert")
    desk.window.profile_chosen.emit("")
    np.testing.assert_allclose(load_kept("anna", "own").centre.translation_mm, [50, 0, 700])
    assert load_kept("bert", "own").centre is None
    desk.window.profile_chosen.emit("anna")
    assert desk.drive.centre is not None


def test_the_lids_of_a_profile_are_known_and_those_of_a_stranger_learned(qtbot):
    levels = BlinkLevels(np.array([0.1, 0.1]), np.array([0.7, 0.8]))
    user = SimpleNamespace(rest_wxyz=np.array([0.8, 0.6, 0.0, 0.0]))
    toolbox = FakeToolbox(profiles=("anna",))
    toolbox.open_profile = lambda _: Performer(FakeTracker(toolbox, "trained"), user, levels=levels)
    window, controller = open_desk(toolbox)
    qtbot.addWidget(window)
    window.show()
    controller.start()
    qtbot.waitUntil(lambda: controller.drive.levels is levels)
    window.profile_chosen.emit("")
    qtbot.waitUntil(lambda: controller.drive.levels is not levels)
    window.close()


def test_settings_are_written_when_nothing_was_changed_for_a_second_and_at_the_end(own_desk, qtbot):
    desk = own_desk
    path = drive_file("anna", "own")
    desk.editor("idle", "breath").slider.setValue(10)
    assert not path.exists()
    qtbot.waitUntil(path.exists, timeout=4000)
    desk.editor("idle", "breath").slider.setValue(150)
    desk.window.close()
    assert load_kept("anna", "own").settings.idle.breath == desk.drive.settings.idle.breath


def test_a_broken_file_is_told_and_the_window_opens(qtbot):
    path = drive_file("", "own")
    path.parent.mkdir(parents=True)
    path.write_text("{")
    window, controller = open_desk(FakeToolbox(cameras=()))
    qtbot.addWidget(window)
    assert "is damaged, expected JSON" in window.message_bar.text
    assert controller.drive.settings == FIRST
    controller.stop()


def test_dragging_a_slider_is_one_change_to_undo(desk):
    slider = desk.editor("head", "yaw").slider
    for value in range(70, 90):
        slider.setValue(value)
    desk.panel.presets.undo_button.click()
    assert desk.drive.settings.head.yaw == 1.0
    assert not desk.panel.presets.undo_button.isEnabled()


def test_settings_are_equal_to_what_the_panel_shows_after_a_change_elsewhere(desk):
    desk.control.apply(PRESETS["Cartoon"][1], "test")
    assert desk.editor("head", "yaw").value_label.text() == "135\N{NO-BREAK SPACE}%"
    model = desk.panel.responses.model
    assert model.rowCount() == len(EXPRESSION_NAMES)
    assert model.rowCount(model.index(0, 0)) == 0
    assert cell(desk, "jawOpen", "gain").data() == "1.60"
    assert cell(desk, "jawOpen", "low").data() == "·"
    assert model.columnCount(QModelIndex()) == 6
    assert isinstance(desk.drive.settings, DriveSettings)


# -- the real window --------------------------------------------------------------------------


@pytest.mark.gl
def test_a_performer_in_the_real_window_is_recentred_and_surprised_by_keys(qtbot):
    renderer_or_skip().release()
    window, controller = open_desk(Toolbox())
    qtbot.addWidget(window)
    window.show()
    window.panels.show("control")
    driven = []
    controller.add_listener(lambda frame, solved, driven_, at: driven.append((solved, driven_)))
    controller.start()
    window.source_chosen.emit("performer:still")
    qtbot.waitUntil(lambda: any(not s.lost for s, _ in driven), timeout=60_000)
    QTest.qWaitForWindowActive(window)
    one = Desk(window, controller)
    press_key(one, Qt.Key.Key_R)
    press_key(one, Qt.Key.Key_3)
    wide, down = index("eyeWideLeft"), index("browInnerUpLeft")

    def surprised():
        expression = driven[-1][1].expression
        return expression[wide] > 0.8 and expression[down] > 0.85

    qtbot.waitUntil(surprised, timeout=20_000)
    assert controller.drive.centre is not None
    page = one.panel.responses
    show_page(one, page)
    qtbot.waitUntil(lambda: page.model.value(wide).shown > 0.8, timeout=10_000)
    window.close()
    QApplication.processEvents()
