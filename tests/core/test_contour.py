"""Facts about the choice of contour vertices."""

import numpy as np
import pytest

from core.contour import contour_points, fixed_points, furthest_points, outward_directions
from core.fit_problem import State, posed
from core.geometry import matrix_from_head_angles
from tests.core.synthetic_fit import N_STRIP, synthetic_space

SPACE = synthetic_space()
RIGHT, CHIN, LEFT = slice(0, 7), 7, slice(8, 15)


def picks(yaw=0.0, pitch=0.0):
    """Places along the strips (15,), 0 = front, of a head so turned."""
    rotation = matrix_from_head_angles(yaw, pitch, 0.0)[None]
    state = State(rotation, np.array([[0.0, 0.0, 600.0]]), np.zeros((1, 46)))
    points = posed(SPACE.mean_mm[None], state)
    found = contour_points(SPACE.mean_mm, points, rotation, SPACE.strips)[0]
    return (found - 60) % N_STRIP


def test_each_strip_gives_one_of_its_own_points():
    rotation = matrix_from_head_angles(0.4, 0.1, 0.2)[None]
    points = SPACE.mean_mm[None] @ rotation[0].T + [0, 0, 500]
    found = contour_points(SPACE.mean_mm, points, rotation, SPACE.strips)[0]
    np.testing.assert_array_equal((found - 60) // N_STRIP, np.arange(15))


def test_outward_is_sideways_above_the_mouth_and_down_at_the_chin():
    outward = outward_directions(SPACE.mean_mm, SPACE.strips)
    np.testing.assert_allclose(np.linalg.norm(outward, axis=1), 1)
    np.testing.assert_allclose(outward[0], [-1, 0, 0], atol=1e-6)
    np.testing.assert_allclose(outward[14], [1, 0, 0], atol=1e-6)
    assert outward[CHIN, 1] > 0.99
    assert outward[4, 0] < 0 < outward[4, 1]


def test_a_frontal_face_shows_its_widest_points():
    fixed = (fixed_points(SPACE.mean_mm, SPACE.strips) - 60) % N_STRIP
    np.testing.assert_array_equal(picks(), fixed)
    azimuths = np.linspace(0.35, 1.9, N_STRIP)[fixed[RIGHT]]
    # Perspective moves the silhouette of a sphere-like head a little to the front.
    assert np.all(np.abs(azimuths - (np.pi / 2 - 0.15)) < 0.25)


@pytest.mark.parametrize("yaw", [0.3, 0.6, 1.0])
def test_the_far_cheek_slides_forward_and_the_near_jaw_stays(yaw):
    turned, frontal = picks(yaw=yaw), picks()
    assert np.all(turned[LEFT] < frontal[LEFT]), "turned to the left, the left side is far"
    np.testing.assert_array_equal(turned[RIGHT], frontal[RIGHT])


def test_left_and_right_are_mirror_images():
    left, right = picks(yaw=0.5), picks(yaw=-0.5)[::-1]
    np.testing.assert_array_equal(left[RIGHT], right[RIGHT])
    np.testing.assert_array_equal(left[LEFT], right[LEFT])


def test_a_chin_that_is_lifted_stays_and_one_that_is_lowered_slides_forward():
    assert picks(pitch=0.4)[CHIN] == picks()[CHIN]
    assert picks(pitch=-0.4)[CHIN] < picks()[CHIN]


def test_padding_is_never_chosen():
    strips = SPACE.strips.copy()
    strips[:, 5:] = -1
    points = SPACE.mean_mm[None] + [0, 0, 600]
    directions = np.tile([1.0, 0.0], (1, 15, 1))
    found = furthest_points(points, directions, strips)
    assert np.all((found[0] - 60) % N_STRIP < 5)
    assert np.all(found >= 60)
