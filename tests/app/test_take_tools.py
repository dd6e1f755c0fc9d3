"""Facts about work on takes with the real models: solved again from the video, drawn as a film."""

import cv2
import numpy as np
import pytest

from app.controllers.take_tools import TakeWorkshop
from app.models import load_models
from app.performer.opening import Scenario, open_performer
from app.render.look import AvatarLook
from app.takes.exporting import FilmWish
from app.takes.library import TakeFacts, free_name, part_folder, with_trim
from app.takes.recorder import Recorder
from app.takes.solving import SolveWish, tracker_for
from core.drive import Drive
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.live import resting_state
from tests.app.gl import renderer_or_skip

N_FRAMES = 45


@pytest.fixture
def take():
    """The performer turning the head, recorded without states."""
    renderer_or_skip().release()
    facts = TakeFacts("", "performer", "", "nora", "free", 30.0, (640, 480), 620.0, video=True)
    endings = []
    recorder = Recorder(part_folder(free_name("turns")), facts, endings.append)
    recorder.start()
    with open_performer(Scenario("head_turns")) as performer:
        for _ in range(N_FRAMES):
            frame, state = performer.read(), resting_state("free")
            recorder.take(frame, state, state)
    recorder.stop()
    recorder.wait()
    return endings[0].take


@pytest.mark.gl
@pytest.mark.slow
def test_a_recorded_performer_is_solved_again_and_drawn_as_a_film(take, tmp_path):
    assert take.rows()["lost"].all()
    workshop = TakeWorkshop()
    made = last_of(workshop.solve(take, SolveWish("", "free", "again"), Drive()))
    rows = made.rows()
    assert len(rows) == N_FRAMES and not rows["lost"][5:].any() and made.facts.mode == "free"
    yaw = [head_yaw(rotation) for rotation in rows["driven_rotation_wxyz"].astype(float)]
    assert np.ptp(yaw[5:]) > 0.02
    made = with_trim(made, (0.5, 1.0))
    steps = workshop.film(
        made, tmp_path / "a.mp4", FilmWish((320, 240), 30.0), "nora", AvatarLook()
    )
    path = last_of(steps)
    pictures = read_all(path)
    assert len(pictures) in (15, 16) and pictures[0].shape == (240, 320, 3)
    assert pictures[0].std() > 20 and np.abs(pictures[0].astype(int) - pictures[-1]).max() > 40


def test_each_mode_has_its_tracker():
    models = load_models()
    assert tracker_for(models, None, "trained").camera.size_px == (640, 480)


def last_of(steps):
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def head_yaw(rotation):
    return head_angles_from_matrix(matrix_from_quaternion(rotation))[0]


def read_all(path):
    video, pictures = cv2.VideoCapture(str(path)), []
    while (read := video.read())[0]:
        pictures.append(read[1])
    return pictures
