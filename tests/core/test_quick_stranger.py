"""When the tracked face counts as somebody else's."""

import numpy as np
import pytest

from core.camera import camera_for, project
from core.geometry import matrix_from_head_angles
from core.quick_frames import Keyframe
from core.quick_stranger import StrangerSettings, StrangerWatch
from core.records import Landmarks2D
from tests.core.synthetic_fit import SIZE_PX, synthetic_space

SETTINGS = StrangerSettings(memory=10, level_memory=50, patience=30, lasting=20)
CAMERA = camera_for(SIZE_PX, 600.0)


@pytest.fixture(scope="module")
def face():
    return synthetic_space().face(np.zeros(8), np.zeros((60, 3)))


def frame(face, bias_mm, rng, yaw=0.0):
    """A tracked frame whose landmarks are off by a fixed bias and by noise."""
    rotation, place = matrix_from_head_angles(yaw, 0.0, 0.0), np.array([0.0, 0.0, 600.0])
    points = np.zeros((75, 2))
    points[:60] = project(CAMERA, face.neutral_mm[:60] @ rotation.T + place)
    points[:60] += bias_mm + 0.8 * rng.normal(size=(60, 2))
    landmarks = Landmarks2D(points, np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.zeros(2))
    return Keyframe(landmarks, rotation, place, np.zeros(46), 0.9, np.zeros(50))


def first_alarm(face, biases_mm, yaw=0.0):
    """Return the frame at which the watch calls a stranger, None if it never does."""
    watch, rng = StrangerWatch(face, CAMERA, SETTINGS), np.random.default_rng(0)
    for n, bias_mm in enumerate(biases_mm):
        if watch.is_stranger(frame(face, bias_mm, rng, yaw)):
            return n
    return None


def biases(mm, rng):
    return mm * rng.normal(size=(60, 2))


def test_noise_alone_is_nobody_else(face):
    assert first_alarm(face, [0.0] * 400) is None


def test_a_small_fixed_bias_is_nobody_else(face, rng):
    own = biases(0.2, rng)
    assert first_alarm(face, [own] * 400) is None


def test_another_bias_is_somebody_else_after_a_while(face, rng):
    own, other = biases(0.2, rng), biases(0.7, rng)
    alarm = first_alarm(face, [own] * 100 + [other] * 100)
    assert 100 + SETTINGS.lasting < alarm < 140


def test_a_short_disturbance_is_nobody_else(face, rng):
    own, hand = biases(0.2, rng), biases(1.5, rng)
    assert first_alarm(face, [own] * 100 + [hand] * 4 + [own] * 200) is None


def test_nothing_is_said_of_turned_heads(face, rng):
    own, other = biases(0.2, rng), biases(0.7, rng)
    assert first_alarm(face, [own] * 100 + [other] * 100, yaw=0.5) is None


def test_mean_remainder_of_a_fixed_bias_is_its_size_in_mm_at_the_face(face):
    watch, rng = StrangerWatch(face, CAMERA, SETTINGS), np.random.default_rng(0)
    for _ in range(300):
        watch.is_stranger(frame(face, np.array([0.6, 0.8]), rng))
    assert watch.mean_remainder_mm == pytest.approx(1.0, abs=0.1)
