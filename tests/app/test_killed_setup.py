"""A guided setup that was killed at any step goes on where it stopped, and nothing is lost."""

import os
import subprocess
import sys

import pytest

from app.controllers.capturing import ORDER
from app.workbook import Workbook
from tests.app.killed_setup import KILLED
from tests.app.setup_fakes import begin, close, open_setup, seen_people
from tests.conftest import REPOSITORY


@pytest.fixture(scope="module")
def people():
    return seen_people()


def killed_at(step, root):
    """Run a setup up to a step in a process of its own, which then dies."""
    command = [sys.executable, "-m", "tests.app.killed_setup", step, str(root)]
    ended = subprocess.run(
        command, cwd=REPOSITORY, capture_output=True, text=True, timeout=120, env=os.environ
    )
    assert ended.returncode == KILLED, ended.stderr


def taken(root):
    return [one.name for one in ORDER if one.name in Workbook(root / "me", lambda rgb: None).names]


def corrections(root):
    book = Workbook(root / "me", lambda rgb: None)
    return sum(int(book.landmarks(name).edited.sum()) for name in book.names)


@pytest.mark.parametrize("step", ["start", "camera"])
def test_killed_before_the_first_picture_it_simply_begins_again(
    qtbot, tmp_path, people, monkeypatch, step
):
    killed_at(step, tmp_path)
    setup = open_setup(qtbot, tmp_path, people, monkeypatch)
    assert setup.window.message_bar.isHidden()
    begin(qtbot, setup)
    assert setup.controller.capturing.shot.name == ORDER[0].name
    close(setup)


@pytest.mark.parametrize("step", ["capture", "check", "train"])
def test_killed_later_it_asks_for_the_next_missing_picture(
    qtbot, tmp_path, people, monkeypatch, step
):
    killed_at(step, tmp_path)
    before = taken(tmp_path)
    assert len(before) >= 14
    setup = open_setup(qtbot, tmp_path, people, monkeypatch)
    assert setup.window.start.profiles.names == ["me"]
    begin(qtbot, setup)
    assert setup.controller.step == "capture"
    assert setup.controller.capturing.shot.name == ORDER[len(before)].name
    assert taken(tmp_path) == before
    setup.controller.show("train")
    assert setup.window.train.train_button.isEnabled()
    assert corrections(tmp_path) == (1 if step == "check" else 0)
    close(setup)
