"""Facts about the first page of the guided setup: profiles are made, copied, emptied, deleted."""

from types import SimpleNamespace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QDesktopServices
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMessageBox, QPushButton

from app.controllers.setup_wizard import SetupController
from app.setup_steps import unseen
from app.shelf import ShelfError
from app.views.setup.setup_window import STEPS, SetupWindow
from app.workbook import Workbook
from core.store import load
from tests.app.setup_fakes import FakeTools
from tests.app.test_editor import film, folder  # noqa: F401  fixtures

RGB = np.full((480, 640, 3), 90, np.uint8)


def nothing(rgb):
    return None


@pytest.fixture
def setup(qtbot, folder):  # noqa: F811
    """The setup with two profiles: "me" is trained, "new" has one picture."""
    Workbook(folder.parent / "new", nothing).put("pose_yaw+0", RGB, unseen(), {})
    tools = FakeTools(folder.parent, {}, cameras=())
    tools.capture_tracker = lambda: (None, None)
    window = SetupWindow()
    qtbot.addWidget(window)
    controller = SetupController(window, tools)
    window.show()
    controller.start()
    yield SimpleNamespace(window=window, page=window.start, controller=controller, tools=tools,
                          root=folder.parent)  # fmt: skip
    window.close()


def select(setup, name):
    table = setup.page.profiles
    table.setCurrentItem(table.topLevelItem(table.names.index(name)))


def answer(box, text):
    [button] = [one for one in box.findChildren(QPushButton) if one.text() == text]
    button.click()


def asked(setup, key):
    """Press a button of the page and return the question that it asks."""
    setup.page.buttons[key].click()
    [box] = setup.page.findChildren(QMessageBox)
    return box


def test_the_page_tells_what_is_stored_and_where(setup):
    page = setup.page
    assert str(setup.root) in page.stored.text() and "Nothing leaves this computer" in (
        page.stored.text()
    )
    assert page.profiles.names == ["me", "new"]
    texts = [page.profiles.topLevelItem(0).text(column) for column in range(4)]
    assert texts[:3] == ["me", "trained", str(len(load(setup.root / "me").names))]
    assert texts[3].endswith("kB") or texts[3].endswith("MB")


def test_what_cannot_be_done_is_not_offered(setup):
    enabled = {}
    for name in ("me", "new"):
        select(setup, name)
        enabled[name] = {key for key, one in setup.page.buttons.items() if one.isEnabled()}
    assert enabled["me"] == {"open", "copy", "clear", "delete", "folder"}
    assert enabled["new"] == {"open", "copy", "delete", "folder"}


def test_enter_opens_the_selected_profile(setup):
    select(setup, "me")
    setup.page.profiles.setFocus()
    QTest.keyClick(setup.page.profiles, Qt.Key.Key_Return)
    assert setup.controller.step != "start" and "me" in setup.window.windowTitle()


def test_a_name_that_is_there_goes_on_and_says_so(setup):
    setup.page.name.setText("me")
    assert "go on with it" in setup.page.remark.text() and setup.page.begin_button.isEnabled()


def test_a_copy_for_glasses_is_opened_with_all_pictures(setup):
    select(setup, "me")
    dialog = setup.controller.shelving.copy("me")
    assert "glasses" in dialog.name.text() and dialog.copy_button.isEnabled()
    for text, enabled in (("me", False), ("", False), ("a?b", False), ("me lamp", True)):
        dialog.name.setText(text)
        assert dialog.copy_button.isEnabled() == enabled
    dialog.copy_button.click()
    assert "me lamp" in setup.window.windowTitle()
    assert "as you look now" in setup.window.message_bar.text
    assert Workbook(setup.root / "me lamp", nothing).names == load(setup.root / "me").names


def test_a_copy_that_fails_is_told(setup, monkeypatch):
    def full(*_):
        raise ShelfError("copy", "me", "no space left on device")

    monkeypatch.setattr("app.shelf.Shelf.duplicate", full)
    dialog = setup.controller.shelving.copy("me")
    dialog.accept()
    assert "no space left" in setup.window.message_bar.text
    assert setup.controller.step == "start"


def test_pictures_are_deleted_only_after_a_yes(setup):
    select(setup, "me")
    box = asked(setup, "clear")
    assert "still followed" in box.informativeText()
    answer(box, "Cancel")
    assert Workbook(setup.root / "me", nothing).names


def test_a_profile_without_pictures_says_so_and_what_can_be_done(setup):
    before = load(setup.root / "me").regressor.arrays()
    select(setup, "me")
    answer(asked(setup, "clear"), "&Delete the pictures")
    page = setup.page
    assert page.profiles.topLevelItem(0).text(1) == "trained; pictures deleted"
    assert not page.buttons["clear"].isEnabled()
    after = load(setup.root / "me").regressor.arrays()
    assert all(np.array_equal(after[name], array) for name, array in before.items())
    page.buttons["open"].click()
    text = setup.window.message_bar.text
    assert "pictures of me were deleted" in text and "follows your face" in text
    unlocked = {
        key: bool(setup.window.steps.item(row).flags() & Qt.ItemFlag.ItemIsEnabled)
        for row, key in enumerate(STEPS)
    }
    # One can take pictures and see the report, but there are no landmarks to look at.
    assert unlocked["camera"] and unlocked["train"] and not unlocked["check"]


def test_a_deleted_profile_is_gone_and_its_steps_are_locked(setup):
    select(setup, "new")
    setup.page.buttons["open"].click()
    setup.controller.show("start")
    select(setup, "new")
    box = asked(setup, "delete")
    answer(box, "&Delete everything")
    assert setup.page.profiles.names == ["me"] and not (setup.root / "new").exists()
    enabled = Qt.ItemFlag.ItemIsEnabled
    assert not setup.window.steps.item(1).flags() & enabled
    assert "new" not in setup.window.windowTitle()


def test_folders_open_in_the_systems_file_manager(setup, monkeypatch):
    opened = []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: opened.append(url.toLocalFile()))
    select(setup, "new")
    setup.page.buttons["folder"].click()
    setup.page.folder_button.click()
    assert opened == [str(setup.root / "new"), str(setup.root)]
