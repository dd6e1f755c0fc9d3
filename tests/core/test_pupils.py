"""Facts about where pupils are."""

import numpy as np
import pytest

from core.camera import camera_for, project
from core.fit_problem import State
from core.geometry import matrix_from_head_angles
from core.pupils import LIMIT_RAD, limited, pupils_mm, sphere_directions
from core.records import Landmarks2D

CAMERA = camera_for((640, 480), 600.0)
RADIUS_MM = 12.0
CENTERS = np.array([[-32.0, 0.0, 0.0], [32.0, 0.0, 0.0]])


def seen(pupils_px, confidence=(1.0, 1.0)):
    nothing = np.zeros(75)
    return Landmarks2D(np.zeros((75, 2)), nothing > 0, nothing, pupils_px, np.array(confidence))


def head(yaw=0.0, pitch=0.0, distance=600.0):
    rotation = matrix_from_head_angles(yaw, pitch, 0.1)
    return State(rotation[None], np.array([[20.0, -10.0, distance]]), np.zeros((1, 46)))


def pupils_looking(state, yaw, pitch):
    """Pupils (2, 3) in the camera frame of eyes that look there in the head frame."""
    forward = matrix_from_head_angles(yaw, pitch, 0.0) @ [0.0, 0.0, -1.0]
    in_head = CENTERS + RADIUS_MM * forward
    return in_head @ state.rotations[0].T + state.translations_mm[0]


@pytest.mark.parametrize("yaw, pitch", [(0.0, 0.0), (0.3, 0.1), (-0.4, -0.2)])
@pytest.mark.parametrize("turn", [-0.6, 0.0, 0.5])
def test_pupils_are_where_their_pictures_came_from(yaw, pitch, turn):
    state = head(yaw=turn, pitch=0.2)
    truth = pupils_looking(state, yaw, pitch)
    found = pupils_mm(CAMERA, state, CENTERS, RADIUS_MM, [seen(project(CAMERA, truth))])
    np.testing.assert_allclose(found[0], truth, atol=1e-6)


def test_an_unseen_pupil_looks_straight_ahead():
    state = head(yaw=0.3)
    found = pupils_mm(CAMERA, state, CENTERS, RADIUS_MM, [seen(np.zeros((2, 2)), (0.1, 0.0))])
    np.testing.assert_allclose(found[0], pupils_looking(state, 0.0, 0.0))


def test_each_eye_is_taken_for_itself():
    state = head()
    truth = pupils_looking(state, 0.3, 0.0)
    found = pupils_mm(CAMERA, state, CENTERS, RADIUS_MM, [seen(project(CAMERA, truth), (0.0, 1.0))])
    np.testing.assert_allclose(found[0, 1], truth[1], atol=1e-6)
    np.testing.assert_allclose(found[0, 0], pupils_looking(state, 0.0, 0.0)[0])


def test_a_ray_beside_the_eye_touches_it_where_it_is_nearest():
    direction = sphere_directions(
        np.array([0.0, 0.0, 1.0]), np.array([30.0, 0.0, 500.0]), RADIUS_MM
    )
    np.testing.assert_allclose(direction, [-1.0, 0.0, 0.0], atol=1e-12)


def test_eyes_turn_only_so_far():
    forward, side = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    edge = limited(side, forward)
    assert np.arccos(edge @ forward) == pytest.approx(LIMIT_RAD)
    assert edge[0] > 0
    little = np.array([np.sin(0.3), 0.0, -np.cos(0.3)])
    np.testing.assert_array_equal(limited(little, forward), little)
