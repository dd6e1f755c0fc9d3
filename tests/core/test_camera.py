"""Facts about the pinhole camera."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.camera import camera_for, project, project_jacobian, scaled, unproject

CAMERA = camera_for((640, 480), 600.0)
points = st.tuples(st.floats(-300, 300), st.floats(-300, 300), st.floats(200, 3000)).map(np.array)


def test_a_point_on_the_axis_lands_in_the_middle():
    np.testing.assert_allclose(project(CAMERA, np.array([0.0, 0, 500])), [319.5, 239.5])


def test_a_point_to_the_right_and_below_lands_there_by_similar_triangles():
    np.testing.assert_allclose(project(CAMERA, np.array([[50.0, 100.0, 600.0]])), [[369.5, 339.5]])


@given(points)
def test_jacobian_agrees_with_finite_differences(point):
    jacobian, step = project_jacobian(CAMERA, point), 1e-4
    for axis in range(3):
        offset = step * np.eye(3)[axis]
        difference = project(CAMERA, point + offset) - project(CAMERA, point - offset)
        np.testing.assert_allclose(jacobian[:, axis], difference / (2 * step), atol=1e-5)


@given(points)
def test_unproject_undoes_project(point):
    back = unproject(CAMERA, project(CAMERA, point), point[2])
    np.testing.assert_allclose(back, point, atol=1e-8)


def test_arrays_of_any_leading_shape():
    stack = np.random.default_rng(0).uniform(100, 500, size=(4, 5, 3))
    assert project(CAMERA, stack).shape == (4, 5, 2)
    assert project_jacobian(CAMERA, stack).shape == (4, 5, 2, 3)
    np.testing.assert_allclose(project(CAMERA, stack)[2, 3], project(CAMERA, stack[2, 3]))


def test_a_smaller_picture_shows_the_same_points():
    half = scaled(CAMERA, (320, 240))
    point = np.array([30.0, -40.0, 700.0])
    # The image origin is the centre of the top-left pixel, so borders, not centres, scale.
    expected = (project(CAMERA, point) + 0.5) / 2 - 0.5
    np.testing.assert_allclose(project(half, point), expected)
    np.testing.assert_allclose(half.center_px, camera_for((320, 240), 300.0).center_px)
    assert half.focal_px == pytest.approx(300.0)
