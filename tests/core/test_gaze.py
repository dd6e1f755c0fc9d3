"""Gaze from pupils, and what happens to it when eyes close."""

import numpy as np
import pytest

from core.gaze import GazeFilter, pupil_directions, vergence_rad
from core.geometry import matrix_from_head_angles

CENTERS = np.array([[-32.0, 0.0, 0.0], [32.0, 0.0, 0.0]])
RADII = np.array([12.0, 12.0])
OPEN, RIGHT_CLOSED, CLOSED = np.zeros(2), np.array([1.0, 0.0]), np.ones(2)
FPS = 30


def pose(yaw=0.0, pitch=0.0, roll=0.0):
    return np.vstack([matrix_from_head_angles(yaw, pitch, roll), [15.0, -20.0, 600.0]])


def pupils(yaw, pitch, head):
    look = np.array([np.sin(yaw) * np.cos(pitch), -np.sin(pitch), -np.cos(yaw) * np.cos(pitch)])
    return (CENTERS + 12.0 * look) @ head[:3].T + head[3]


@pytest.mark.parametrize("head", [pose(), pose(0.5, -0.2, 0.3), pose(-0.4, 0.3, 0.0)])
@pytest.mark.parametrize("yaw, pitch", [(0, 0), (0.4, 0), (-0.3, 0.2), (0.1, -0.35)])
def test_recovers_the_direction_of_a_known_pupil(head, yaw, pitch):
    found = pupil_directions(pupils(yaw, pitch, head), head, CENTERS, RADII)
    np.testing.assert_allclose(found, [[yaw, pitch]] * 2, atol=1e-9)


def test_signs_are_the_subjects_left_and_up():
    head = pose()
    found = pupil_directions(
        pupils(0.0, 0.0, head) + np.array([2.0, -3.0, 0.0]), head, CENTERS, RADII
    )
    assert (found > 0.1).all()


def test_the_pupils_depth_does_not_matter():
    head = pose(0.3, 0.1, 0.0)
    seen = pupils(0.2, 0.1, head)
    further = seen * np.array([[1.01], [0.98]])
    np.testing.assert_allclose(
        pupil_directions(further, head, CENTERS, RADII),
        pupil_directions(seen, head, CENTERS, RADII),
    )


def test_a_pupil_seen_beside_the_eyeball_counts_as_on_its_rim():
    head = pose()
    found = pupil_directions(pupils(0, 0, head) + np.array([30.0, 0, 0]), head, CENTERS, RADII)
    assert np.isfinite(found).all()
    np.testing.assert_allclose(found[:, 0], np.pi / 2, atol=0.15)


def test_a_closed_eye_takes_the_other_eyes_direction():
    gaze = GazeFilter().step(np.array([[0.9, -0.9], [0.2, 0.1]]), RIGHT_CLOSED, 0.0)
    np.testing.assert_allclose(gaze, [[0.2, 0.1], [0.2, 0.1]], atol=1e-12)


def test_both_eyes_share_pitch_and_converge_on_the_screen():
    gaze = GazeFilter().step(np.array([[0.1, 0.2], [-0.06, 0.0]]), OPEN, 0.0, 0.05)
    np.testing.assert_allclose(gaze, [[0.07, 0.1], [-0.03, 0.1]], atol=1e-12)


def test_a_wink_does_not_turn_the_open_eye():
    gaze = GazeFilter().step(np.array([[0.9, -0.9], [0.2, 0.1]]), RIGHT_CLOSED, 0.0, 0.05)
    np.testing.assert_allclose(gaze, [[0.3, 0.1], [0.2, 0.1]], atol=1e-12)


def test_eyes_crossed_on_purpose_are_shown_crossed_and_noise_is_not():
    rng, gaze_filter = np.random.default_rng(4), GazeFilter()
    for k in range(60):
        noisy = rng.normal(0, 0.06, (2, 2))
        gaze = gaze_filter.step(noisy, OPEN, k / FPS)
    assert gaze[0, 0] - gaze[1, 0] < 0.02
    for k in range(60, 120):
        gaze = gaze_filter.step(np.array([[0.4, 0.0], [-0.4, 0.0]]), OPEN, k / FPS)
    assert gaze[0, 0] > 0.25
    assert gaze[1, 0] < -0.25


def test_eyes_turn_in_more_towards_what_is_nearer():
    near, far = vergence_rad(CENTERS, 400.0), vergence_rad(CENTERS, 800.0)
    assert near == pytest.approx(np.arctan2(32, 400))
    assert far < 0.6 * near


def test_gaze_holds_through_a_blink():
    gaze_filter = GazeFilter()
    looking = np.full((2, 2), 0.2)
    for k in range(10):
        before = gaze_filter.step(looking, OPEN, k / FPS)
    # Lids that come down drag the pupils that are found with them.
    for k, blink in enumerate([0.7, 1.0, 1.0, 0.7]):
        held = gaze_filter.step(looking - 0.4, blink * CLOSED, (10 + k) / FPS)
    np.testing.assert_allclose(held, before)


def test_a_saccade_arrives_within_two_frames():
    gaze_filter = GazeFilter()
    for k in range(10):
        gaze_filter.step(np.zeros((2, 2)), OPEN, k / FPS)
    first = gaze_filter.step(np.full((2, 2), 0.25), OPEN, 10 / FPS)
    second = gaze_filter.step(np.full((2, 2), 0.25), OPEN, 11 / FPS)
    assert (first > 0.7 * 0.25).all()
    assert (second > 0.9 * 0.25).all()


def test_a_resting_eye_shakes_less_than_half_as_much():
    rng, gaze_filter = np.random.default_rng(1), GazeFilter()
    noise = rng.normal(0, 0.012, (300, 2, 2))
    out = np.array([gaze_filter.step(n, OPEN, k / FPS) for k, n in enumerate(noise)])
    assert out[30:].std() < 0.45 * noise[30:].std()


def test_gaze_stays_within_what_eyes_can_do():
    assert (np.abs(GazeFilter().step(np.full((2, 2), 1.5), OPEN, 0.0)) <= 0.7).all()


def test_reset_lets_the_next_gaze_pass_unfiltered():
    gaze_filter = GazeFilter()
    gaze_filter.step(np.zeros((2, 2)), OPEN, 0.0)
    gaze_filter.reset()
    np.testing.assert_allclose(
        gaze_filter.step(np.full((2, 2), 0.01), OPEN, 1 / FPS), np.full((2, 2), 0.01)
    )
