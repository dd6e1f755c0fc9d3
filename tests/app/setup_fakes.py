"""The guided setup on real widgets, with a camera and a face of our own."""

import time
from queue import SimpleQueue
from types import SimpleNamespace

import numpy as np

from app.capture.holding import Held, knobs
from app.controllers import capture_tools
from app.controllers.setup_wizard import SetupController
from app.errors import CameraLostError, NoCameraError
from app.first_fit import first_fit
from app.setup_memory import SetupChoices
from app.shelf import Shelf
from app.views.choice import Choice
from app.views.setup.setup_window import SetupWindow
from app.workbook import Workbook
from core.capture_judge import Judgement, Taken
from core.landmark_refit import Refitter
from core.records import Frame, Progress
from core.setup_plan import SHOTS
from core.shot_match import Match
from core.shutter import ShutterState
from tests.app.live_fakes import CAMERA, FRAME_S, FakeToolbox, make_state
from tests.core.held_out_person import face_model, filmed, person


def seen_people():
    """Landmarks of somebody who follows each prompt that the network could see."""
    seen = [shot for shot in SHOTS if abs(shot.yaw) < 1.2]
    film = filmed(person(0), seen, np.random.default_rng(3), noise_px=0.3)
    return dict(zip((shot.name for shot in seen), film.landmarks, strict=True))


class FakeCaptureTracker:
    """Judges as the test wants: takes a picture in each frame while `obeys`."""

    def __init__(self, tools, judge):
        self.tools, self.judge = tools, judge
        self.taken, self.judged = SimpleQueue(), self

    def take(self):
        return self.last

    def step(self, frame):
        shot = self.judge._shot
        turn = Match(np.deg2rad(self.tools.turn_deg), False, True, 1.0)
        state = ShutterState("holding", 0.4, False)
        ghost = self.tools.ghost
        self.last = Judgement(self.tools.advice, turn if shot else None, state, None, ghost)
        if shot is not None and (self.tools.obeys or self.judge._now_wanted):
            self.judge._now_wanted = False
            if not self.judge._paused:
                marks = self.tools.landmarks.get(shot.name)
                self.taken.put(Taken(shot, frame, marks, dict(self.tools.quality)))
                self.judge.ask(None)
        return make_state(frame.time_s)

    def reset(self):
        pass


class FakeCamera:
    """A source whose pictures show something, and that may be unplugged."""

    def __init__(self, source):
        self.source, self.unplugged = source, False
        self.trouble = ""
        self.name, self.size_px, self.fps, self.live = "fake", (64, 48), 250.0, True
        self.holds = []
        source.toolbox.cameras_open[source.key] = self

    def read(self):
        # One that waits for its device gives nothing and says why.
        while self.trouble:
            time.sleep(FRAME_S)
        frame = self.source.read()
        if self.unplugged:
            raise CameraLostError(self.name, frame.index)
        gray = frame.gray + (np.arange(64, dtype=np.uint8) % 16)
        rgb = np.repeat(gray[..., None], 3, axis=2)
        return Frame(rgb, gray, frame.time_s, frame.index)

    def hold(self):
        self.holds.append("hold")
        knobs_here = knobs("linux")
        return tuple(Held(knob, knob.name != "focus", 1.0, 1.0) for knob in knobs_here)

    def let_go(self):
        self.holds.append("let go")

    def interrupt(self):
        self.trouble = ""

    def close(self):
        self.source.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class FakeSpeaker:
    """Remembers what was to be heard."""

    def __init__(self):
        self.muted, self.played = False, []

    def play(self, name):
        if not self.muted:
            self.played.append(name)

    def close(self):
        pass


class FakeTools(FakeToolbox):
    def __init__(self, root, landmarks, cameras=(CAMERA,)):
        super().__init__(cameras)
        self.root, self.landmarks = root, landmarks
        self.obeys, self.turn_deg, self.advice, self.quality = False, (0.0, 0.0, 0.0), "", {}
        self.prompted, self.trained_with = [], []
        self.chosen, self.held = SetupChoices(), {}
        self.speaker, self.ghost = FakeSpeaker(), None
        self.names, self.flat, self.cameras_open = {}, set(), {}

    def cameras(self):
        known = super().cameras()
        return [Choice(one.key, self.names.get(one.key, one.text)) for one in known]

    def open_source(self, key, began_again=None):
        source = super().open_source(key, began_again)
        return source if key in self.flat else FakeCamera(source)

    def open_preview(self, key):
        if key.startswith("camera") and key not in self.camera_keys:
            raise NoCameraError(int(key[-1]), [])
        return self.open_source(key)

    def keep_held(self, key, held):
        self.held[key] = held

    def make_speaker(self):
        return self.speaker

    def choices(self):
        return self.chosen

    def keep_choices(self, choices):
        self.chosen = choices

    def prompt(self, name):
        self.prompted.append(name)

    def shelf(self):
        return Shelf(self.root)

    def open_book(self, name):
        return Workbook(self.root / name, lambda rgb: None)

    def first_fit(self, book):
        camera, user = yield from first_fit(face_model(), book)
        return Refitter(face_model(), user, camera)

    def train(self, book):
        self.trained_with.append(book.names)
        yield Progress(1, 2, "Calibrating", {"focal_px": 600.0, "error": 2.0})
        return "Trained."


def open_setup(qtbot, root, people, monkeypatch, cameras=(CAMERA,)):
    root.mkdir(exist_ok=True)
    tools = FakeTools(root, people, cameras)
    monkeypatch.setattr(
        capture_tools, "CaptureTracker",
        lambda tracker, rivals, judge: FakeCaptureTracker(tools, judge),
    )  # fmt: skip
    tools.capture_tracker = lambda: (None, None)
    window = SetupWindow()
    qtbot.addWidget(window)
    controller = SetupController(window, tools)
    window.resize(1280, 720)
    window.show()
    controller.start()
    found = SimpleNamespace(window=window, controller=controller, tools=tools, root=root)
    return found


def begin(qtbot, setup, name="me"):
    """Go from the first page to that of the pictures, by way of the camera if need be."""
    setup.window.start.name.setText(name)
    setup.window.start.begin_button.click()
    if setup.controller.step == "camera":
        qtbot.waitUntil(setup.window.next_button.isEnabled, timeout=5000)
        setup.window.next_button.click()
    page = setup.window.capture
    qtbot.waitUntil(lambda: page.live._image is not None, timeout=5000)
    return page


def shoot(qtbot, setup, count):
    setup.tools.obeys = True
    qtbot.waitUntil(
        lambda: sum(s != "missing" for s in setup.window.capture.sheet.states().values()) >= count,
        timeout=20000,
    )
    setup.tools.obeys = False


def close(setup):
    setup.window.close()
