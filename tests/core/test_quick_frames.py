"""Which frames the quick identity fit keeps."""

import numpy as np
import pytest

from core.geometry import matrix_from_head_angles
from core.quick_frames import Keyframe, Keyframes, KeyframeSettings, place_of
from core.records import Landmarks2D

SETTINGS = KeyframeSettings(most=4)
BLANK = Landmarks2D(
    np.zeros((75, 2)), np.zeros(75, bool), np.ones(75), np.zeros((2, 2)), np.zeros(2)
)
SEAT_MM = np.array([0.0, 0.0, 600.0])


def frame(yaw=0.0, smile=0.0, confidence=0.9, place_mm=SEAT_MM):
    rotation = matrix_from_head_angles(yaw, 0.0, 0.0)
    expression = np.zeros(46)
    expression[28] = smile
    place = place_of(rotation, place_mm, expression, SETTINGS)
    return Keyframe(BLANK, rotation, place_mm, expression, confidence, place)


def kept(*frames):
    keyframes = Keyframes(SETTINGS)
    for one in frames:
        keyframes.offer(one)
    return keyframes


def test_frames_alike_are_kept_once():
    keyframes = kept(frame())
    assert not keyframes.offer(frame(yaw=0.05))
    assert len(keyframes.frames) == 1


def test_never_keeps_more_than_asked_for():
    keyframes = kept(*(frame(yaw=yaw) for yaw in np.linspace(-0.8, 0.8, 30)))
    assert len(keyframes.frames) == SETTINGS.most


def test_full_set_spreads_out():
    near = [frame(yaw=yaw) for yaw in (0.0, 0.18, 0.36, 0.54)]
    keyframes = kept(*near, frame(yaw=-0.8))
    yaws = sorted(float(one.place[0]) * SETTINGS.angle_rad for one in keyframes.frames)
    assert yaws[0] == pytest.approx(-0.8)
    assert len(yaws) == SETTINGS.most


def test_most_neutral_frame_is_the_first_and_stays():
    neutral = frame()
    turned = (frame(yaw=yaw) for yaw in (0.3, 0.5, 0.7, -0.3, -0.5, -0.7))
    keyframes = kept(frame(smile=0.9), neutral, *turned)
    assert keyframes.frames[0] is neutral


def test_head_that_faces_the_camera_from_the_side_is_frontal():
    aside = np.array([300.0, 0.0, 600.0])
    towards = frame(yaw=-np.arctan2(300, 600), place_mm=aside)
    away = frame(yaw=0.0, place_mm=aside)
    assert (
        min(towards.strangeness, frame(yaw=np.arctan2(300, 600), place_mm=aside).strangeness) < 1e-6
    )
    assert away.strangeness > 1


def test_similar_frame_takes_the_place_if_it_is_better():
    better = frame(yaw=0.31, confidence=0.99)
    keyframes = kept(frame(), frame(yaw=0.3, confidence=0.6))
    assert keyframes.offer(better)
    assert keyframes.frames[1] is better


def test_far_turned_heads_are_not_looked_at():
    assert not kept().offer(frame(yaw=1.2))


def test_solved_frames_take_the_places_of_those_still_kept():
    first, second, solved = frame(), frame(yaw=0.4), frame(yaw=0.41)
    keyframes = kept(first, second)
    gone = frame(yaw=-0.4)
    keyframes.solved((second, gone), (solved, frame()))
    assert keyframes.frames == (first, solved)
