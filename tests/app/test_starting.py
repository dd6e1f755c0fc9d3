"""The start of the live window: what is to be seen comes before what is to be loaded."""

import subprocess
import sys
from threading import Event

import pytest

from app.controllers.starting import STARTING, Starting
from app.views.live_window import LiveWindow
from app.window_file import WindowSettings, save_window
from tests.app.live_fakes import FakeToolbox

HEAVY = ("numba", "cv2", "scipy", "moderngl", "pyqtgraph")


@pytest.fixture
def toolbox(monkeypatch):
    """A quick toolbox in place of the real one; its models are loaded once `ready` is set."""
    made, allowed = FakeToolbox(profiles=["anna"]), Event()
    made.allowed, made.loaded = allowed, []
    made.models = lambda: made.loaded.append(allowed.wait(10))
    monkeypatch.setattr("app.controllers.toolbox.Toolbox", lambda: made)
    return made


def test_the_window_is_there_at_once_and_works_when_all_is_loaded(qtbot, toolbox):
    window = LiveWindow()
    qtbot.addWidget(window)
    begun = Starting(window)
    window.show()
    assert window.source_pane.notice.text == STARTING and begun.controller is None
    with qtbot.waitSignal(begun.ready, timeout=20_000):
        pass
    toolbox.allowed.set()
    qtbot.waitUntil(lambda: window.status.state == "Tracking, trained", timeout=20_000)
    window.close()
    assert toolbox.loaded == [True] and not toolbox.open_now


def test_a_window_closed_while_it_is_loading_leaves_no_thread(qtbot, toolbox):
    toolbox.allowed.set()
    window = LiveWindow()
    qtbot.addWidget(window)
    begun = Starting(window)
    window.show()
    window.close()
    assert begun._job.isFinished()
    qtbot.wait(50)
    assert begun.controller is None


def test_the_window_has_its_size_before_the_panels_are_there(qtbot, toolbox):
    toolbox.allowed.set()
    first = LiveWindow()
    first.resize(950, 712)
    geometry = bytes(first.saveGeometry().toBase64().data()).decode()
    first.deleteLater()
    save_window(WindowSettings(geometry=geometry))
    window = LiveWindow()
    qtbot.addWidget(window)
    begun = Starting(window)
    assert window.height() == 712
    with qtbot.waitSignal(begun.ready, timeout=20_000):
        pass
    window.close()


def test_showing_the_window_loads_nothing_heavy():
    """Each of these takes a good part of a second, in which nothing would be seen."""
    code = (
        "import sys, app; import app.views.live_window, app.controllers.starting; "
        f"print([name for name in {HEAVY} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
