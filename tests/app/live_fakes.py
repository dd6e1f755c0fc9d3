"""A toolbox without cameras, files, training or OpenGL, for tests of the live window."""

import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject, Signal

from app.controllers.player import Performer
from app.controllers.profile_maker import MadeProfile
from app.errors import AppError, CameraBusyError
from app.painting import LiveWish
from app.views.choice import Choice
from app.workers.avatar_loop import Painted
from core.camera import camera_for
from core.generations import ProfileDamagedError
from core.records import FaceState, Frame, Progress

CAMERA, OTHER_CAMERA = "camera:0", "camera:2"
STILL = "performer:still"
FRAME_S = 0.004
AVATAR_LEVELS = {"own": 100, "nora": 200}


def make_state(time_s=0.0, lost=False, confidence=0.9, mode="trained"):
    return FaceState(
        time_s, [1, 0, 0, 0], [0, 0, 600], np.zeros(46), np.zeros((2, 2)), np.zeros((75, 3)),
        np.full((75, 2), 20.0), confidence, mode, lost,
    )  # fmt: skip


class FakeSource:
    """Gives grey frames of one level without end, some milliseconds apart."""

    name, fps, live = "fake", 250.0, True

    def __init__(self, toolbox, key, level):
        self.toolbox, self.key, self.level, self.index = toolbox, key, level, 0
        self.interrupted, self.size_px = threading.Event(), toolbox.size_px
        toolbox.open_now.add(self)
        toolbox.most_open = max(toolbox.most_open, len(toolbox.open_now))

    def read(self):
        time.sleep(self.toolbox.frame_s)
        while self.toolbox.trouble and not self.interrupted.wait(FRAME_S):
            pass
        if self.toolbox.read_error is not None:
            raise self.toolbox.read_error
        gray = np.full(self.size_px[::-1], self.level, np.uint8)
        rgb = np.repeat(gray[..., None], 3, axis=2)
        self.index += 1
        return Frame(rgb, gray, self.index * FRAME_S, self.index - 1)

    @property
    def trouble(self):
        return self.toolbox.trouble

    def interrupt(self):
        self.interrupted.set()

    def close(self):
        self.toolbox.open_now.discard(self)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class FakeTracker:
    def __init__(self, toolbox, mode):
        self.toolbox, self.mode, self.resets = toolbox, mode, 0

    @property
    def camera(self):
        return camera_for((64, 48), 64.0)

    def step(self, frame):
        if self.toolbox.tracker_error is not None:
            raise self.toolbox.tracker_error
        mode = "free" if self.toolbox.stranger else self.mode
        state = make_state(frame.time_s, self.toolbox.lost, self.toolbox.confidence, mode)
        # The landmarks tell from which frame they are.
        places = np.full((75, 2), 20.0) + [frame.index % 1000 / 50, 0]
        return replace(state, landmarks_px=places)

    def reset(self):
        self.resets += 1


class FakeEditor(QObject):
    finished, failed = Signal(bool), Signal(object)

    def __init__(self, name):
        super().__init__()
        self.name, self.shown, self.closed = name, 0, False

    def show(self):
        self.shown += 1

    def close(self):
        self.closed = True


class FakeMesh:
    """One line across the picture."""

    def lines_px(self, state, camera):
        return np.array([[4.0, 40.0, 60.0, 40.0]])


class FakeRenderThread:
    """Draws at once, in the thread that asks, a picture whose level tells the avatar."""

    def __init__(self, toolbox, done, failed):
        self.toolbox, self.done, self.failed = toolbox, done, failed
        self.alive = False

    def start(self):
        self.alive = True
        self.toolbox.render_threads += 1
        if self.toolbox.render_error is not None:
            self.failed(self.toolbox.render_error)

    def ask(self, wish: LiveWish):
        self.toolbox.wishes.append(wish)
        if self.toolbox.render_error is None:
            picture = np.full((*self.toolbox.size_px[::-1], 4), 255, np.uint8)
            picture[..., :3] = AVATAR_LEVELS[wish.cast.avatar]
            self.done(Painted(picture, wish, time.perf_counter()))

    def stop(self):
        if self.alive:
            self.alive = False
            self.toolbox.render_threads -= 1


class FakeToolbox:
    def __init__(self, cameras=(CAMERA,), profiles=()):
        self.camera_keys, self.profile_names = list(cameras), list(profiles)
        self.opened, self.open_now, self.most_open = [], set(), 0
        self.busy, self.damaged = set(), set()
        self.gate, self.ready = threading.Event(), threading.Event()
        self.gate.set()
        self.ready.set()
        self.lost, self.confidence, self.trouble = False, 0.9, ""
        self.editors, self.size_px, self.frame_s = [], (64, 48), FRAME_S
        self.stranger, self.learned = False, None
        self.read_error = self.tracker_error = self.render_error = None
        self.wishes, self.render_threads = [], 0
        self.making_gate, self.making_error = threading.Event(), None
        self.made_from = []

    def cameras(self):
        return [Choice(key, f"Camera {key[-1]}") for key in self.camera_keys]

    def performances(self):
        return [Choice(STILL, "Virtual performer: still")]

    def avatars(self):
        return [Choice("own", "Your own head"), Choice("nora", "Nora")]

    def profiles(self):
        return list(self.profile_names)

    def open_source(self, key, began_again):
        assert threading.current_thread() is not threading.main_thread()
        self.opened.append(key)
        self.gate.wait(10)
        if key in self.busy:
            raise CameraBusyError("Camera 0", "most likely another program is using it")
        return FakeSource(self, key, sum(key.encode()) % 200 + 20)

    def open_profile(self, key):
        assert threading.current_thread() is not threading.main_thread()
        if key in self.damaged:
            raise ProfileDamagedError("profile.json", "incomplete", "a header")
        return Performer(FakeTracker(self, "trained"), None)

    def open_free(self):
        assert threading.current_thread() is not threading.main_thread()
        self.ready.wait(10)
        return Performer(FakeTracker(self, "free"), None, lambda: self.learned)

    def face_mesh(self, user):
        assert threading.current_thread() is not threading.main_thread()
        return FakeMesh()

    def profile_editor(self, name):
        self.editors.append(FakeEditor(name))
        return self.editors[-1]

    def profile_folder(self, name):
        return Path("/profiles") / name

    def name_trouble(self, name):
        return "this name has a '?' in it" if "?" in name else ""

    def profile_steps(self, name, source):
        self.made_from.append(source)
        yield Progress(1, 4, "Looking for good frames")
        while not self.making_gate.wait(0.005):
            yield Progress(2, 4, "Training the regressor")
        if self.making_error is not None:
            raise self.making_error
        self.profile_names.append(name)
        return MadeProfile(name, f"The profile {name} was made.")

    def make_render_thread(self, done, failed):
        return FakeRenderThread(self, done, failed)


def no_opengl():
    return AppError("this machine cannot draw: no OpenGL")
