"""Facts about taking setup pictures hands-free."""

from dataclasses import replace

import numpy as np
import pytest

from core.arkit import EXPRESSION_NAMES
from core.capture_judge import CaptureJudge, weakness
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.live import resting_state
from core.records import FaceState, Frame, Landmarks2D
from core.setup_plan import SHOTS

BY_NAME = {shot.name: shot for shot in SHOTS}
FPS = 30


def face_points():
    across, down = np.meshgrid(np.linspace(-80, 80, 10), np.linspace(-70, 90, 10))
    return (np.column_stack([across.ravel(), down.ravel()]) + [320, 250])[:75]


@pytest.fixture
def gray(rng):
    return rng.integers(90, 160, (480, 640), np.uint8)


def frame_of(gray, number):
    return Frame(np.repeat(gray[..., None], 3, axis=2), gray.copy(), number / FPS, number)


def state_of(angles_deg=(0, 0, 0), expression=None, lost=False):
    rest = resting_state("free")
    values = np.zeros(46) if expression is None else expression
    rotation = quaternion_from_matrix(matrix_from_head_angles(*np.deg2rad(angles_deg)))
    return FaceState(
        0.0, rotation, [0, 0, 600.0], values, rest.gaze_rad, rest.shape_mm, rest.landmarks_px,
        0.9, "free", lost,
    )  # fmt: skip


def landmarks():
    return Landmarks2D(face_points(), np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.ones(2))


def play(judge, gray, state, n_frames=60, seen=True, start=0, rivals=0):
    marks = landmarks() if seen else None
    return [judge.step(frame_of(gray, start + n), state, marks, rivals) for n in range(n_frames)]


def taken(judgements):
    return [one.taken for one in judgements if one.taken is not None]


def test_a_followed_prompt_is_taken_once_with_its_landmarks(gray):
    judge = CaptureJudge()
    judge.ask(BY_NAME["pose_yaw+30"])
    (picture,) = taken(play(judge, gray, state_of((28, 0, 0))))
    assert picture.shot.name == "pose_yaw+30"
    assert np.array_equal(picture.landmarks.points_px, face_points())
    assert picture.quality["yaw_deg"] == pytest.approx(28)
    assert weakness(picture) == ""


def test_nothing_is_taken_without_a_prompt_in_a_pause_or_in_the_wrong_pose(gray):
    judge = CaptureJudge()
    assert taken(play(judge, gray, state_of())) == []
    judge.ask(BY_NAME["pose_yaw+0"])
    judge.pause(True)
    assert taken(play(judge, gray, state_of(), start=100)) == []
    judge.pause(False)
    wrong = play(judge, gray, state_of((20, 0, 0)), start=200)
    assert taken(wrong) == []
    assert np.rad2deg(wrong[-1].match.turn_rad[0]) == pytest.approx(-20)
    assert len(taken(play(judge, gray, state_of(), start=300))) == 1


def test_several_faces_hold_the_shutter_and_are_told_when_it_lasts(gray):
    judge = CaptureJudge()
    judge.ask(BY_NAME["pose_yaw+0"])
    judged = play(judge, gray, state_of(), rivals=1)
    assert taken(judged) == []
    assert judged[0].advice == "" and judged[-1].advice == "several"


def test_a_picture_by_hand_is_taken_at_once_and_called_weak_where_it_is(gray):
    judge = CaptureJudge()
    judge.ask(BY_NAME["pose_yaw+0"])
    judge.shoot_now()
    (picture,) = taken(play(judge, gray, state_of((25, 0, 0)), n_frames=1))
    assert picture.quality["by_hand"] is True
    assert "head" in weakness(picture)


def test_a_profile_is_taken_after_the_face_went_out_of_sight_on_the_right_side(gray):
    judge = CaptureJudge()
    judge.ask(BY_NAME["pose_yaw-90"])
    play(judge, gray, state_of((-45, 0, 0)), n_frames=3)
    (picture,) = taken(play(judge, gray, state_of(lost=True), seen=False, start=3))
    assert picture.landmarks is None and weakness(picture) == ""


def test_a_picture_by_hand_without_a_face_is_weak(gray):
    judge = CaptureJudge()
    judge.ask(BY_NAME["pose_yaw-30"])
    judge.shoot_now()
    (picture,) = taken(play(judge, gray, state_of(lost=True), n_frames=1, seen=False))
    assert weakness(picture) == "no face was seen"


def test_a_turned_head_that_has_moved_aside_is_measured_from_the_seat(gray):
    judge = CaptureJudge()
    play(judge, gray, state_of(), n_frames=3)
    judge.ask(BY_NAME["pose_yaw+60"])
    aside = replace(state_of((60, 0, 0)), translation_mm=[120.0, 0, 600.0])
    last = play(judge, gray, aside, n_frames=3, start=3)[-1]
    assert np.abs(np.rad2deg(last.match.turn_rad)).max() < 6


def test_a_face_that_left_is_not_a_profile(gray):
    judge = CaptureJudge()
    judge.ask(BY_NAME["pose_yaw-90"])
    play(judge, gray, state_of((5, 0, 0)), n_frames=3)
    judged = play(judge, gray, state_of(lost=True), seen=False, start=3)
    assert taken(judged) == [] and judged[-1].advice == "no_face"


def test_an_expression_that_cannot_be_seen_is_given_time(gray):
    judge = CaptureJudge()
    judge.ask(BY_NAME["cheek_blowing_yaw+0"])
    judged = play(judge, gray, state_of(), n_frames=130)
    first = next(n for n, one in enumerate(judged) if one.taken is not None)
    assert first / FPS > 2.5


def test_angles_count_from_how_the_person_looks_ahead(gray):
    judge = CaptureJudge()
    judge.face_forward(state_of((0, -12, 0)).rotation_wxyz)
    judge.ask(BY_NAME["pose_yaw+0"])
    assert len(taken(play(judge, gray, state_of((0, -12, 0))))) == 1


def test_a_neutral_prompt_waits_for_the_mouth_to_close(gray):
    open_mouth = np.zeros(46)
    open_mouth[EXPRESSION_NAMES.index("jawOpen")] = 0.7
    judge = CaptureJudge()
    judge.ask(BY_NAME["pose_yaw+0"])
    assert taken(play(judge, gray, state_of(expression=open_mouth))) == []


def test_a_slow_camera_is_told_and_still_used(gray):
    judge = CaptureJudge()
    judge.ask(BY_NAME["pose_yaw+0"])
    slow = [replace(frame_of(gray, n), time_s=n / 8) for n in range(40)]
    judged = [judge.step(one, state_of(), landmarks()) for one in slow]
    assert judged[-1].advice == "slow" and taken(judged)


def test_who_hardly_manages_an_expression_is_asked_for_less_in_time(gray):
    little = np.zeros(46)
    for side in ("Left", "Right"):
        little[EXPRESSION_NAMES.index(f"browDown{side}")] = 0.15
    judge = CaptureJudge()
    judge.ask(BY_NAME["anger_yaw+0"])
    judged = play(judge, gray, state_of(expression=little), n_frames=330)
    first = next(n for n, one in enumerate(judged) if one.taken is not None)
    assert 4 < first / FPS < 10
    assert weakness(judged[first].taken) == "the expression was hardly made"


def test_a_slow_computer_that_leaves_frames_out_is_no_slow_camera(gray):
    judge = CaptureJudge()
    # Every fifth frame of 30 a second is looked at.
    seen = [judge.step(frame_of(gray, 5 * n), state_of(), landmarks()) for n in range(60)]
    assert {one.advice for one in seen} == {""}


def test_another_camera_with_a_clock_of_its_own_is_not_slow(gray):
    judge = CaptureJudge()
    play(judge, gray, state_of(), n_frames=60, start=3000)
    assert {one.advice for one in play(judge, gray, state_of(), n_frames=60)} == {""}
