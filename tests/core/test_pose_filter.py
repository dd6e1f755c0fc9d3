"""The pose filter: steady on a still head, no lag on a moving one."""

import numpy as np
import pytest

from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    matrix_from_quaternion,
    matrix_from_rotation_vector,
    multiply_quaternions,
    quaternion_from_matrix,
    rotation_angle_rad,
    rotation_vector_from_matrix,
)
from core.kernels.pose import rotate_by, rotation_between
from core.pose_filter import PoseFilter

FPS = 30


def yaw_deg(rotation_wxyz):
    return np.rad2deg(head_angles_from_matrix(matrix_from_quaternion(rotation_wxyz))[0])


def turned(yaw):
    return quaternion_from_matrix(matrix_from_head_angles(np.deg2rad(yaw), 0.1, 0.0))


def filtered_yaws(yaws):
    pose_filter = PoseFilter()
    start = np.array([0.0, 0.0, 600.0])
    return np.array(
        [yaw_deg(pose_filter.step(turned(yaw), start, k / FPS)[0]) for k, yaw in enumerate(yaws)]
    )


def random_quaternion(rng):
    q = rng.standard_normal(4)
    return q / np.linalg.norm(q)


@pytest.mark.parametrize("seed", range(5))
def test_rotation_between_agrees_with_matrices(seed):
    rng = np.random.default_rng(seed)
    start, end, out = random_quaternion(rng), random_quaternion(rng), np.empty(3)
    rotation_between(start, end, out)
    matrix = matrix_from_quaternion(end) @ matrix_from_quaternion(start).T
    np.testing.assert_allclose(out, rotation_vector_from_matrix(matrix), atol=1e-9)


def test_rotating_by_the_rotation_between_two_arrives_at_the_second():
    rng = np.random.default_rng(2)
    start, end, vector = random_quaternion(rng), random_quaternion(rng), np.empty(3)
    rotation_between(start, end, vector)
    rotate_by(start, vector)
    assert rotation_angle_rad(start, end) < 1e-7


def test_a_quaternion_and_its_negative_are_no_motion():
    q, out = random_quaternion(np.random.default_rng(0)), np.empty(3)
    rotation_between(q, -q, out)
    np.testing.assert_allclose(out, 0, atol=1e-9)


def test_a_pose_that_stays_is_returned_unchanged():
    pose_filter, q = PoseFilter(), turned(12.0)
    for k in range(5):
        rotation, translation = pose_filter.step(q, np.array([1.0, 2.0, 600.0]), k / FPS)
    np.testing.assert_allclose(rotation, q, atol=1e-12)
    np.testing.assert_allclose(translation, [1, 2, 600], atol=1e-12)


def test_a_still_head_shakes_less_than_half_and_from_frame_to_frame_a_quarter_as_much():
    rng, pose_filter = np.random.default_rng(0), PoseFilter()
    raw, out, raw_mm, out_mm = [], [], [], []
    for k in range(300):
        jitter = matrix_from_rotation_vector(rng.normal(0, np.deg2rad(0.06), 3))
        q = multiply_quaternions(quaternion_from_matrix(jitter), turned(5.0))
        t = np.array([0, 0, 600.0]) + rng.normal(0, [0.08, 0.08, 0.8])
        rotation, translation = pose_filter.step(q, t, k / FPS)
        raw.append(yaw_deg(q))
        out.append(yaw_deg(rotation))
        raw_mm.append(t)
        out_mm.append(translation)
    raw, out = np.array(raw[30:]), np.array(out[30:])
    assert out.std() < 0.5 * raw.std()
    assert np.abs(np.diff(out)).mean() < 0.25 * np.abs(np.diff(raw)).mean()
    assert (np.std(out_mm[30:], axis=0) < 0.6 * np.std(raw_mm[30:], axis=0)).all()


@pytest.mark.parametrize("speed_deg_s, most_frames", [(5, 1.0), (20, 0.5), (60, 0.15), (200, 0.05)])
def test_lag_of_a_turning_head_falls_with_its_speed(speed_deg_s, most_frames):
    yaws = -40 + speed_deg_s / FPS * np.arange(12)
    lag_frames = (yaws - filtered_yaws(yaws)) / (speed_deg_s / FPS)
    assert lag_frames.max() < most_frames


def test_a_jump_of_ten_degrees_is_followed_at_once():
    yaws = np.array([0.0] * 10 + [10.0] * 3)
    assert abs(filtered_yaws(yaws)[10] - 10) < 0.1


def test_a_nod_keeps_its_amplitude():
    times = np.arange(90) / FPS
    yaws = 6 * np.sin(2 * np.pi * 2 * times)
    assert abs(np.ptp(filtered_yaws(yaws)[30:]) / np.ptp(yaws[30:]) - 1) < 0.05


@pytest.mark.parametrize("time_s", [-1.0, 5.0])
def test_after_a_gap_or_a_step_back_in_time_the_pose_passes_unchanged(time_s):
    pose_filter = PoseFilter()
    pose_filter.step(turned(0), np.zeros(3), 0.0)
    rotation, _ = pose_filter.step(turned(1.0), np.zeros(3), time_s)
    np.testing.assert_allclose(rotation, turned(1.0))


def test_reset_forgets_the_last_pose():
    pose_filter = PoseFilter()
    pose_filter.step(turned(0), np.zeros(3), 0.0)
    pose_filter.reset()
    rotation, _ = pose_filter.step(turned(1.0), np.zeros(3), 1 / FPS)
    np.testing.assert_allclose(rotation, turned(1.0))


def test_settings_say_what_is_filtered_how_strongly():
    yaws = [0.0, 0.3, 0.3]
    assert 0.0 < filtered_yaws(yaws)[1] < 0.3


def test_stretching_moves_what_is_kept_and_not_only_what_comes():
    steady, stretched = PoseFilter(), PoseFilter()
    place, turn = np.array([10.0, -20.0, 600.0]), np.array([1.0, 0.0, 0.0, 0.0])
    for k in range(5):
        steady.step(turn, place, k / 30)
        stretched.step(turn, place, k / 30)
    stretched.stretch(np.array([1.0, 1.0, 1.5]))
    _, moved = stretched.step(turn, place * [1, 1, 1.5], 5 / 30)
    np.testing.assert_allclose(moved, [10.0, -20.0, 900.0])
