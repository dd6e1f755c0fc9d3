"""How the live window is laid out, and that it stays so until the next start."""

import json

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QApplication, QLabel, QTabBar

from app.controllers.desk import open_desk
from app.views.avatar_window import AvatarWindow
from app.views.help_dialogs import TextDialog
from app.window_file import WindowSettings, load_window, save_window, window_file
from tests.app.live_fakes import AVATAR_LEVELS, CAMERA, OTHER_CAMERA, FakeToolbox


@pytest.fixture
def desk(qtbot):
    """Opens the live window as a start of the program does; closes what is left open."""
    opened = []

    def open_window(toolbox=None):
        window, controller = open_desk(toolbox or FakeToolbox())
        qtbot.addWidget(window)
        window.show()
        controller.start()
        opened.append(window)
        return window

    yield open_window
    for window in opened:
        window.close()


def alone():
    """The avatar's own window, None while it is closed."""
    shown = [one for one in QApplication.topLevelWidgets() if isinstance(one, AvatarWindow)]
    return next((one for one in shown if one.isVisible()), None)


def test_views_change_sides_and_one_of_them_always_stays(desk):
    window = desk()
    pair = window.pair
    assert pair.widget(0) is window.source_pane
    window.deeds["swap"].trigger()
    assert pair.widget(0) is window.avatar_pane and pair.swapped
    window.deeds["source"].trigger()
    assert not window.source_pane.isVisible() and window.avatar_pane.isVisible()
    window.deeds["avatar"].trigger()
    assert window.source_pane.isVisible() and not window.avatar_pane.isVisible()
    assert window.deeds.on("source") and not window.deeds.on("avatar")


def test_full_screen_shows_nothing_but_pictures_and_keeps_its_keys(desk, qtbot):
    window = desk()
    qtbot.waitUntil(lambda: window.card.isVisible())
    qtbot.waitUntil(window.isActiveWindow)
    qtbot.keyClick(window, Qt.Key.Key_F11)
    assert window.isFullScreen() and not window.card.isVisible() and not window.choices.isVisible()
    assert not window.status.isVisible() and window.menuBar().height() == 0
    qtbot.keyClick(window, Qt.Key.Key_F6)
    assert window.pair.swapped
    qtbot.keyClick(window, Qt.Key.Key_Escape)
    assert not window.isFullScreen() and window.choices.isVisible() and window.status.isVisible()
    assert window.menuBar().height() > 0 and not window.deeds.on("full")


def test_the_avatar_alone_has_no_frame_shows_the_avatar_and_closes_with_esc(desk, qtbot):
    window = desk()
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture)
    window.deeds["alone"].trigger()
    lone = alone()
    assert lone.windowFlags() & Qt.WindowType.FramelessWindowHint
    assert lone.testAttribute(Qt.WidgetAttribute.WA_TranslucentBackground)

    def level():
        image = lone.grab().toImage()
        return image.pixelColor(image.width() // 2, image.height() // 2).red()

    qtbot.waitUntil(lambda: level() == AVATAR_LEVELS["own"])
    qtbot.keyClick(lone, Qt.Key.Key_Escape)
    assert not lone.isVisible() and not window.deeds.on("alone")
    assert window.isVisible()


def test_the_avatar_alone_is_dragged_and_grows_and_is_where_it_was(desk, qtbot):
    window = desk()
    window.deeds["alone"].trigger()
    lone = alone()
    lone.setGeometry(100, 120, 300, 200)
    centre = QPoint(150, 100)
    qtbot.mousePress(lone, Qt.MouseButton.LeftButton, pos=centre)
    qtbot.mouseMove(lone, centre + QPoint(40, 30))
    qtbot.mouseRelease(lone, Qt.MouseButton.LeftButton, pos=centre)
    assert lone.pos() == QPoint(140, 150)
    qtbot.keyClick(lone, Qt.Key.Key_Plus)
    assert lone.width() == 330 and lone.height() == 220
    assert lone.geometry().center() == QPoint(289, 249)
    place = lone.geometry()
    window.deeds["alone"].trigger()
    window.deeds["alone"].trigger()
    assert alone().geometry() == place


def test_always_on_top_is_for_the_window_and_for_the_avatar_alone(desk, qtbot):
    window = desk()
    window.deeds["alone"].trigger()
    lone, on_top = alone(), Qt.WindowType.WindowStaysOnTopHint
    window.deeds["top"].trigger()
    assert window.windowFlags() & on_top and lone.windowFlags() & on_top
    assert window.isVisible() and lone.isVisible()
    window.deeds["top"].trigger()
    assert not window.windowFlags() & on_top and not lone.windowFlags() & on_top


def test_the_layout_is_remembered_between_starts(desk):
    window = desk(FakeToolbox(cameras=[CAMERA, OTHER_CAMERA], profiles=["anna", "bert"]))
    window.add_panel("notes", "Notes", QLabel("a panel"))
    for key in ("swap", "avatar", "top", "axes", "landmarks", "blank"):
        window.deeds[key].trigger()
    window.source_chosen.emit(OTHER_CAMERA)
    window.profile_chosen.emit("bert")
    window.avatar_chosen.emit("nora")
    window.resize(1100, 701)
    window.close()
    again = desk(FakeToolbox(cameras=[CAMERA, OTHER_CAMERA], profiles=["anna", "bert"]))
    assert again.pair.swapped and not again.avatar_pane.isVisible()
    assert again.deeds.on("axes") and not again.deeds.on("landmarks") and again.deeds.on("blank")
    assert not again.landmarks_box.isChecked()
    assert again.windowFlags() & Qt.WindowType.WindowStaysOnTopHint
    assert again.height() == 701
    assert again.sources.currentData() == OTHER_CAMERA
    assert again.profiles.currentData() == "bert" and again.avatars.currentData() == "nora"


@pytest.mark.parametrize(
    "content",
    ["", "{", "[]", '{"version": 99}', '{"version": 1, "switches": {"full": 3}, "swapped": 7}'],
)
def test_a_broken_file_means_the_defaults(desk, content):
    window_file().parent.mkdir(parents=True)
    window_file().write_text(content)
    assert load_window() == WindowSettings()
    assert desk().source_pane.isVisible()


def test_what_is_kept_is_kept_as_a_whole_and_unknown_switches_are_nothing(desk):
    kept = WindowSettings(switches={"axes": True, "from_the_future": True}, swapped=True)
    save_window(kept)
    assert load_window() == kept
    assert json.loads(window_file().read_text())["version"] == 1
    assert [one.name for one in window_file().parent.iterdir()] == ["window.json"]
    assert desk().deeds.on("axes")


def test_a_camera_that_is_gone_at_the_next_start_is_not_waited_for(desk):
    save_window(WindowSettings(source=OTHER_CAMERA, profile="bert", avatar="nobody"))
    window = desk(FakeToolbox(cameras=[CAMERA], profiles=["anna"]))
    assert window.sources.currentData() == CAMERA and window.profiles.currentData() == "anna"


def test_a_panel_is_in_the_menu_hidden_at_first_and_has_its_key(desk, qtbot):
    window = desk()
    action = window.add_panel("notes", "Notes", QLabel("a panel"), "Ctrl+J")
    other = window.add_panel("more", "More", QLabel("another"))
    assert action in window.menu("View").actions() and not window.panels.dock("notes").isVisible()
    qtbot.waitUntil(window.isActiveWindow)
    qtbot.keyClick(window, Qt.Key.Key_J, Qt.KeyboardModifier.ControlModifier)
    assert window.panels.dock("notes").isVisible() and action.isChecked()
    other.trigger()
    # Both share a place, as tabs: the pictures keep their room.
    assert window.tabifiedDockWidgets(window.panels.dock("notes"))


def test_no_tab_covers_the_menus_while_all_panels_are_hidden(desk):
    desk().close()
    window = desk()
    bars = [bar for bar in window.findChildren(QTabBar) if bar.parent() is window]
    assert bars and all(bar.accessibleName() for bar in bars)
    assert not [bar for bar in bars if bar.isVisible() and bar.geometry().intersects(window.rect())]


def test_the_list_of_keys_names_every_entry_of_the_menus_with_a_key(desk, qtbot):
    window = desk()
    window.add_panel("notes", "My notes", QLabel("a panel"), "Ctrl+J")
    window.deeds["keys"].trigger()
    dialog = window.findChild(TextDialog)
    texts = [label.text() for label in dialog.findChildren(QLabel)]
    assert {"F11", "Full screen", "Ctrl+J", "My notes", "Space", "Pause"} <= set(texts)
    dialog.close()
    qtbot.waitUntil(lambda: window.findChild(TextDialog) is None)
    window.deeds["about"].trigger()
    text = window.findChild(TextDialog).findChild(QLabel).text()
    assert "Apache-2.0" in text and "CC0" in text
    window.findChild(TextDialog).close()


def test_the_tab_of_a_panel_that_is_alone_at_its_place_covers_no_menu(desk, qtbot):
    window = desk()
    window.panels.show("control")
    qtbot.wait(50)
    window.close()
    again, _ = open_desk(FakeToolbox())
    qtbot.addWidget(again)
    bars = again.findChildren(QTabBar, options=Qt.FindChildOption.FindDirectChildrenOnly)
    alone_bars = [bar for bar in bars if bar.count() == 1]
    assert alone_bars
    assert not any(bar.geometry().intersects(again.rect()) for bar in alone_bars)
    again.close()


def test_the_tabs_of_two_panels_at_one_place_come_back(desk, qtbot):
    window = desk()
    window.panels.show("control")
    window.panels.show("avatar_look")
    qtbot.wait(50)
    window.close()
    again = desk()
    bars = again.findChildren(QTabBar, options=Qt.FindChildOption.FindDirectChildrenOnly)
    (row,) = (bar for bar in bars if bar.count() == 2)
    qtbot.waitUntil(lambda: again.rect().contains(row.geometry()))
    again.panels.dock("control").hide()
    again.panels.show("control")
    qtbot.waitUntil(lambda: again.rect().contains(row.geometry()))
