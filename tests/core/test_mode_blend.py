"""Facts about going from one tracker to another, and from one face to a better one."""

from dataclasses import replace

import numpy as np
import pytest

from core.camera import camera_for, project
from core.face_blend import FaceBlend, KnownHead, between
from core.fit_space import Face
from core.geometry import (
    matrix_from_head_angles,
    quaternion_from_matrix,
    rotation_angle_rad,
    rotation_facing_camera,
)
from core.live import resting_state
from core.mode_blend import StateBlend, gap_share, part_of_rotation
from core.usual_rotation import UsualRotation

CAMERA = camera_for((640, 480), 600.0)
SHAPE = np.random.default_rng(3).normal(size=(75, 3)) * 40 + [0, 0, 600]


def turned(yaw=0.0, pitch=0.0, roll=0.0):
    return quaternion_from_matrix(matrix_from_head_angles(yaw, pitch, roll))


def state(time_s, mode, yaw=0.0, jaw=0.0, depth=600.0, lost=False):
    expression = np.zeros(46)
    expression[3] = jaw
    shape = SHAPE + [0, 0, depth - 600]
    return replace(
        resting_state(mode), time_s=time_s, rotation_wxyz=turned(yaw),
        translation_mm=np.array([0, 0, depth]), expression=expression,
        gaze_rad=np.full((2, 2), jaw), shape_mm=shape, landmarks_px=project(CAMERA, shape),
        confidence=0.9, lost=lost,
    )  # fmt: skip


def test_nothing_is_bent_while_one_tracker_leads():
    blend = StateBlend()
    states = [state(n / 30, "free", 0.1 * n, 0.1 * n) for n in range(5)]
    assert all(blend.step(one, CAMERA) is one for one in states)


def test_a_change_of_trackers_is_no_jump_and_is_over_in_its_time():
    blend = StateBlend(0.2)
    before = blend.step(state(0.0, "free", 0.3, 0.8, 640.0), CAMERA)
    shown = [before] + [
        blend.step(state(n / 30, "trained", 0.1, 0.2, 600.0), CAMERA) for n in range(1, 9)
    ]
    turns = rotation_angle_rad(
        np.array([one.rotation_wxyz for one in shown[1:]]),
        np.array([one.rotation_wxyz for one in shown[:-1]]),
    )
    # 0.2 rad in six frames, the steepest half as fast again as the mean.
    assert turns.max() < 0.2 / 6 * 1.6 and turns.sum() == pytest.approx(0.2)
    depths = np.array([one.translation_mm[2] for one in shown])
    assert np.all(np.diff(depths) <= 0) and np.abs(np.diff(depths)).max() < 40 / 6 * 1.6
    jaws = np.array([one.expression[3] for one in shown])
    assert np.abs(np.diff(jaws)).max() < 0.6 / 6 * 1.6
    last = shown[6]
    assert last.translation_mm[2] == 600 and last.expression[3] == pytest.approx(0.2)
    np.testing.assert_allclose(last.rotation_wxyz, turned(0.1), atol=1e-12)


def test_what_is_shown_meanwhile_is_of_one_piece():
    blend = StateBlend(0.2)
    blend.step(state(0.0, "free", depth=700.0), CAMERA)
    middle = blend.step(state(0.1, "trained"), CAMERA)
    np.testing.assert_allclose(middle.landmarks_px, project(CAMERA, middle.shape_mm))
    assert 600 < middle.translation_mm[2] < 700 and middle.mode == "trained"
    assert np.linalg.norm(middle.rotation_wxyz) == pytest.approx(1.0)


def test_the_new_trackers_motion_passes_at_once():
    blend = StateBlend(0.2)
    blend.step(state(0.0, "free", jaw=0.1), CAMERA)
    first = blend.step(state(0.03, "trained", jaw=0.1), CAMERA)
    second = blend.step(state(0.06, "trained", jaw=0.7), CAMERA)
    assert second.expression[3] - first.expression[3] == pytest.approx(0.6)


def test_coefficients_stay_in_their_range():
    blend = StateBlend(0.2)
    blend.step(state(0.0, "free", jaw=1.0), CAMERA)
    blend.step(state(0.03, "trained", jaw=0.2), CAMERA)
    assert blend.step(state(0.05, "trained", jaw=0.9), CAMERA).expression.max() == 1.0
    blend.step(state(0.06, "free", jaw=1.0), CAMERA)
    assert blend.step(state(0.07, "free", jaw=0.0), CAMERA).expression.min() >= 0.0


def test_a_face_found_again_is_shown_where_it_is():
    blend = StateBlend(0.2)
    blend.step(state(0.0, "free", 0.5), CAMERA)
    blend.step(state(0.03, "free", 0.5, lost=True), CAMERA)
    found = state(0.06, "trained", -0.5)
    assert blend.step(found, CAMERA) is found


@pytest.mark.parametrize("how", ["reset", "time"])
def test_the_past_is_forgotten(how):
    blend = StateBlend(0.2)
    blend.step(state(5.0, "free", 0.5), CAMERA)
    if how == "reset":
        blend.reset()
    new = state(5.1 if how == "reset" else 0.1, "trained", -0.5)
    assert blend.step(new, CAMERA) is new


def test_parts_of_a_rotation_lie_on_the_shorter_way():
    whole = turned(0.4, -0.2, 0.1)
    for sign in (1, -1):
        half = part_of_rotation(sign * whole, 0.5)
        assert rotation_angle_rad(half, whole) == pytest.approx(
            rotation_angle_rad(half, np.array([1.0, 0, 0, 0]))
        )
        np.testing.assert_allclose(np.abs(part_of_rotation(sign * whole, 1.0) @ whole), 1.0)
        np.testing.assert_array_equal(part_of_rotation(sign * whole, 0.0), [1, 0, 0, 0])
    np.testing.assert_array_equal(part_of_rotation(np.array([1.0, 0, 0, 0]), 0.5), [1, 0, 0, 0])


def test_the_gap_closes_smoothly_from_all_to_nothing():
    shares = [gap_share(progress) for progress in np.linspace(0, 1, 21)]
    assert shares[0] == 1 and shares[-1] == 0 and gap_share(-0.1) == 0
    assert np.all(np.diff(shares) < 0)


def head(size_mm, focal_px):
    face = Face(
        np.full((62, 3), size_mm), np.full((46, 62, 3), size_mm / 10),
        np.zeros((15, 2), np.int32), np.zeros(15, np.int32),
    )  # fmt: skip
    return KnownHead(face, camera_for((640, 480), focal_px), np.full((2, 3), size_mm))


def test_a_better_face_comes_in_by_and_by_and_stays():
    first, better = head(10.0, 500.0), head(20.0, 720.0)
    blend = FaceBlend(first, 0.5)
    assert blend.arrived and blend.head is first
    blend.begin(better, 7.0)
    assert blend.head is first and not blend.arrived
    middle = blend.step(7.25)
    assert middle.face.neutral_mm[0, 0] == 15 and middle.face.deltas_mm[0, 0, 0] == 1.5
    assert middle.eye_centers_mm[0, 0] == 15
    assert middle.camera.focal_px == pytest.approx(600)
    assert blend.step(7.5) is better and blend.arrived


def test_a_still_better_face_starts_from_what_is_in_use():
    blend = FaceBlend(head(10.0, 500.0), 0.5)
    blend.begin(head(20.0, 500.0), 0.0)
    blend.step(0.25)
    blend.begin(head(35.0, 500.0), 0.3)
    assert blend.step(0.3).face.neutral_mm[0, 0] == 15
    assert blend.step(0.55).face.neutral_mm[0, 0] == 25


def test_time_that_runs_backwards_ends_the_move():
    blend, better = FaceBlend(head(10.0, 500.0), 0.5), head(20.0, 500.0)
    blend.begin(better, 9.0)
    assert blend.step(0.0) is better and blend.arrived


def test_the_ends_of_the_way_are_the_two_heads():
    first, second = head(10.0, 500.0), head(20.0, 720.0)
    for share, end in ((0.0, first), (1.0, second)):
        found = between(first, second, share)
        np.testing.assert_array_equal(found.face.neutral_mm, end.face.neutral_mm)
        assert found.camera.focal_px == pytest.approx(end.camera.focal_px)


def test_the_usual_rotation_is_that_of_most_of_the_time_whatever_looking_away_adds():
    usual, unknown = UsualRotation(), np.array([1.0, 0, 0, 0])
    assert usual.rotation_wxyz(unknown) is unknown
    for n in range(60):
        away = n % 3 == 2
        usual.add(turned(0.8 if away else 0.0, 0.2), np.array([0, 0, 600.0]), n)
    np.testing.assert_allclose(usual.rotation_wxyz(unknown), turned(0.0, 0.2), atol=1e-9)


def test_heads_beside_the_camera_are_compared_with_the_line_to_it():
    usual = UsualRotation()
    place = np.array([200.0, -150.0, 600.0])
    facing = quaternion_from_matrix(rotation_facing_camera(place))
    for n in range(10):
        usual.add(facing, place, n)
    np.testing.assert_allclose(usual.rotation_wxyz(np.zeros(4)), [1, 0, 0, 0], atol=1e-9)


def test_frames_close_together_count_once_and_an_older_time_starts_another_turn():
    usual = UsualRotation()
    for n in range(30):
        usual.add(turned(0.3), np.array([0, 0, 600.0]), 10 + n / 30)
    # Five looks a second: one second gives five heads, just enough.
    np.testing.assert_allclose(usual.rotation_wxyz(np.zeros(4)), turned(0.3), atol=1e-9)
    for n in range(60):
        usual.add(turned(-0.3), np.array([0, 0, 600.0]), n / 30)
    np.testing.assert_allclose(usual.rotation_wxyz(np.zeros(4)), turned(-0.3), atol=1e-9)
