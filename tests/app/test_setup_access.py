"""Facts about the pages of the guided setup for those who use keys, or read with their ears."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QApplication,
    QComboBox,
    QHeaderView,
    QLabel,
    QLineEdit,
    QProgressBar,
    QTextBrowser,
)

from app.setup_steps import unseen
from app.views.setup.setup_window import STEPS
from app.workbook import Workbook
from tests.app.setup_fakes import close, open_setup
from tests.app.test_shelf import RGB

CONTROLS = (QAbstractButton, QComboBox, QLineEdit, QAbstractItemView, QTextBrowser)


@pytest.fixture
def setup(qtbot, tmp_path, monkeypatch):
    root = tmp_path / "profiles"
    root.mkdir()
    Workbook(root / "somebody", lambda rgb: None).put("pose_yaw+0", RGB, unseen(), {})
    found = open_setup(qtbot, root, {}, monkeypatch)
    yield found
    close(found)


def shown(setup, step):
    """Show a step, as far as it can be without work done before, and return its page."""
    setup.window.start.name.setText("me")
    if step != "start":
        setup.window.start.begin_button.click()
        setup.window.show_step(step)
    QApplication.processEvents()
    return setup.window.pages.currentWidget()


def widgets(page, *kinds):
    """What of some kinds is to be seen on a page."""
    return [one for kind in kinds for one in page.findChildren(kind) if one.isVisibleTo(page)]


def controls(page):
    """What can be worked with on a page, without the insides of lists and boxes."""
    insides = (QComboBox, QAbstractItemView)
    return [
        one for one in widgets(page, *CONTROLS)
        if not isinstance(one.parent(), insides) and not isinstance(one, QHeaderView)
    ]  # fmt: skip


@pytest.mark.parametrize("step", list(STEPS))
def test_every_control_has_a_name_and_takes_the_focus_by_tab(setup, step):
    page = shown(setup, step)
    # The page of the landmarks is empty until there are enough pictures.
    assert (
        len(controls(page)) >= {"start": 9, "camera": 2, "capture": 8, "check": 0, "train": 4}[step]
    )
    for one in controls(page):
        assert one.accessibleName() or getattr(one, "text", str)(), f"{one} on {step}"
        assert one.focusPolicy() & Qt.FocusPolicy.TabFocus, f"{one} on {step}"
    for bar in page.findChildren(QProgressBar):
        assert bar.accessibleName()


@pytest.mark.parametrize("step", ["start", "camera", "capture"])
def test_tab_goes_round_all_controls(qtbot, setup, step):
    page = shown(setup, step)
    wanted = {one for one in controls(page) if one.isEnabled()}
    setup.window.activateWindow()
    setup.window.steps.setFocus()
    reached = set()
    for _ in range(40):
        QTest.keyClick(QApplication.focusWidget() or setup.window, Qt.Key.Key_Tab)
        reached.add(QApplication.focusWidget())
    assert wanted <= reached, [str(one) for one in wanted - reached]


@pytest.mark.parametrize("step", ["start", "camera", "capture"])
def test_nothing_is_cut_off_on_a_small_screen(setup, step):
    page = shown(setup, step)
    window = setup.window
    least = window.minimumSizeHint()
    assert least.width() <= 1280 and least.height() <= 690
    window.resize(1280, 690)
    QApplication.processEvents()
    assert (window.width(), window.height()) == (1280, 690)
    for one in widgets(page, QLabel, QAbstractButton):
        if not one.text():
            continue
        if isinstance(one, QLabel) and one.wordWrap():
            assert one.height() >= one.heightForWidth(one.width()), one.text()
        else:
            assert one.width() >= one.sizeHint().width() - 1, one.text()


@pytest.mark.parametrize("step", ["start", "camera", "capture"])
def test_keys_with_alt_are_given_once(setup, step):
    page = shown(setup, step)
    texts = [setup.window.next_button.text()] if step != "start" else []
    texts += [
        one.text() for one in widgets(page, QLabel, QAbstractButton) if "<" not in one.text()
    ]  # fmt: skip
    keys = [text[text.index("&") + 1].lower() for text in texts if "&" in text]
    assert len(keys) == len(set(keys)), sorted(keys)
