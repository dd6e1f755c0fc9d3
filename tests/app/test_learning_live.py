"""A correction from end to end: the virtual performer, a real training, the new regressor live."""

import os
import threading

import numpy as np
import pytest
from PySide6.QtCore import Qt

from app import setup_steps
from app.controllers import correction_tools
from app.controllers.correcting import CorrectingController
from app.controllers.desk import open_desk
from app.controllers.takes import TakesController
from app.controllers.toolbox import Toolbox
from app.performer.opening import Scenario
from app.performer.opening import setup_pictures as performed
from app.profiles import encoded_pictures, profile_folder
from app.setup_steps import Pictures, make_profile
from app.takes.library import takes
from app.workers.live_loop import LiveLoop
from core.landmarks import NAMES
from core.pipeline import BuildSettings, build
from core.records import SetupImages
from core.regressor_trainer import TrainSettings
from core.setup_plan import standard_for
from core.store import load, save
from tests.app.gl import renderer_or_skip
from tests.app.test_editor import drag
from tests.core.synthetic_fit import result_of

EVERY, FOCAL_PX = 5, 620.0
CORNER = NAMES.index("R_mouth_corner")


@pytest.fixture
def trained(monkeypatch):
    """A small profile of the performer, made as every later one in this test."""
    renderer_or_skip().release()
    settings = BuildSettings(train=TrainSettings(n_stages=3, n_ferns=40))

    def quick_build(model, images, landmarks, _focal_px, rng, _settings=None):
        return build(model, images, landmarks, FOCAL_PX, rng, settings)

    monkeypatch.setattr(setup_steps, "build", quick_build)
    toolbox = Toolbox()
    models = toolbox.models()
    shots = performed(Scenario())[::EVERY]
    found = [models.aligner.first(frame.rgb) for _, frame, _ in shots]
    seen = [(shot, one.landmarks) for shot, one in zip(shots, found, strict=True) if one]
    names = tuple(shot[0] for shot, _ in seen)
    images = SetupImages(
        tuple(shot[1].rgb for shot, _ in seen), names,
        np.stack([standard_for(name) for name in names]),
    )  # fmt: skip
    pictures = Pictures(images, tuple(marks for _, marks in seen), ())
    steps = make_profile(models.face_model, pictures, FOCAL_PX, np.random.default_rng(1))
    profile, used = result_of(steps)
    save(profile_folder("mara"), profile, encoded_pictures(used))
    return toolbox


@pytest.mark.gl
@pytest.mark.slow
def test_a_correction_is_learned_and_used_while_the_performer_is_live(trained, qtbot, monkeypatch):
    niceness = []
    originally = correction_tools.errors_px

    def note(*args):
        niceness.append(priority())
        return originally(*args)

    monkeypatch.setattr(correction_tools, "errors_px", note)
    window, controller = open_desk(trained)
    qtbot.addWidget(window)
    window.show()
    controller.start()
    window.take("performer:talking")
    correcting = controller.findChild(CorrectingController)
    qtbot.waitUntil(lambda: window.status.state.startswith("Tracking"), timeout=60_000)
    qtbot.waitUntil(lambda: window.avatar_pane.has_picture, timeout=30_000)
    (loop,) = [one for one in controller.findChildren(LiveLoop) if one.isRunning()]
    correcting.action.trigger()
    qtbot.waitUntil(lambda: correcting.editor is not None, timeout=30_000)
    editor = correcting.editor
    x, y = editor.canvas.scene.points_px[CORNER]
    drag(editor, editor.canvas.zoom.to_widget(float(x), float(y)).toPoint(), (6, -4))
    n_before = len(load(profile_folder("mara")).names)
    qtbot.mouseClick(editor.use_button, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: "has learned" in window.message_bar.text, timeout=120_000)
    assert "In live-0001 the landmarks are" in window.message_bar.text
    profile = load(profile_folder("mara"))
    assert len(profile.names) == n_before + 1 and "live-0001" in profile.names
    assert profile.landmarks[profile.names.index("live-0001")].edited[CORNER]
    assert loop.isRunning() and niceness and niceness[0] >= priority()
    qtbot.waitUntil(lambda: window.status.state.startswith("Tracking"), timeout=30_000)
    record_a_little(controller, qtbot)
    window.close()


def record_a_little(controller, qtbot):
    """The performer, its pictures and the avatar's states go into a take."""
    desk = controller.findChild(TakesController)
    desk.panel.record.video_box.setChecked(True)
    desk.toggle()
    qtbot.waitUntil(lambda: desk.recording.seconds > 0.4, timeout=30_000)
    desk.toggle()
    qtbot.waitUntil(lambda: desk.recording.state == "off", timeout=30_000)
    (take,) = takes()
    rows = take.rows()
    assert take.film is not None and not rows["lost"].all()
    assert take.facts.focal_px == pytest.approx(FOCAL_PX, rel=0.2)
    assert np.ptp(rows["expression"], axis=0).max() > 0


def priority():
    """How much the calling thread gives way; 0 where nobody knows."""
    if not hasattr(os, "getpriority"):
        return 0
    return os.getpriority(os.PRIO_PROCESS, threading.get_native_id())
