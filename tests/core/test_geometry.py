"""Facts about rotations and registrations."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from core import geometry as geo

components = st.floats(-1, 1, allow_nan=False, width=32)
angles = st.floats(-1.4, 1.4)


def quaternions():
    return (
        arrays(np.float64, 4, elements=components)
        .filter(lambda q: np.linalg.norm(q) > 1e-2)
        .map(lambda q: q / np.linalg.norm(q))
    )


def vectors(bound=100.0):
    return arrays(np.float64, 3, elements=st.floats(-bound, bound, width=32))


@given(quaternions())
def test_quaternion_matrices_are_rotations(q):
    m = geo.matrix_from_quaternion(q)
    np.testing.assert_allclose(m @ m.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(m) == pytest.approx(1)


@given(quaternions())
def test_quaternion_to_matrix_and_back(q):
    back = geo.quaternion_from_matrix(geo.matrix_from_quaternion(q))
    assert back[0] >= 0
    assert abs(back @ q) == pytest.approx(1)


@given(quaternions(), quaternions())
def test_product_of_quaternions_is_product_of_matrices(a, b):
    product = geo.matrix_from_quaternion(geo.multiply_quaternions(a, b))
    expected = geo.matrix_from_quaternion(a) @ geo.matrix_from_quaternion(b)
    np.testing.assert_allclose(product, expected, atol=1e-12)


@given(arrays(np.float64, 3, elements=st.floats(-1.75, 1.75)))
def test_rotation_vector_to_matrix_and_back(v):
    back = geo.rotation_vector_from_matrix(geo.matrix_from_rotation_vector(v))
    np.testing.assert_allclose(back, v, atol=1e-7)


def test_rotation_vector_of_a_half_turn_keeps_its_angle():
    m = geo.matrix_from_rotation_vector(np.array([0.0, np.pi, 0.0]))
    assert np.linalg.norm(geo.rotation_vector_from_matrix(m)) == pytest.approx(np.pi)


def test_quarter_turn_about_z_takes_x_to_y():
    m = geo.matrix_from_rotation_vector(np.array([0.0, 0.0, np.pi / 2]))
    np.testing.assert_allclose(m @ [1, 0, 0], [0, 1, 0], atol=1e-12)


@given(vectors(2.0), vectors())
def test_small_rotations_turn_points_by_the_cross_product(v, point):
    step = 1e-6
    moved = geo.matrix_from_rotation_vector(step * v) @ point - point
    np.testing.assert_allclose(moved / step, np.cross(v, point), atol=1e-3)


@given(angles, angles, angles)
def test_head_angles_to_matrix_and_back(yaw, pitch, roll):
    m = geo.matrix_from_head_angles(yaw, pitch, roll)
    np.testing.assert_allclose(geo.head_angles_from_matrix(m), [yaw, pitch, roll], atol=1e-8)


def test_signs_of_the_head_angles():
    nose, crown, left_ear = np.array([0.0, 0, -1]), np.array([0.0, -1, 0]), np.array([1.0, 0, 0])
    turned = geo.matrix_from_head_angles(0.5, 0, 0) @ nose
    assert turned[0] > 0, "to the subject's left is to the right in the picture"
    raised = geo.matrix_from_head_angles(0, 0.5, 0) @ nose
    assert raised[1] < 0, "up"
    leaning = geo.matrix_from_head_angles(0, 0, 0.5)
    assert (leaning @ crown)[0] > 0 and (leaning @ left_ear)[1] > 0, "left ear down"


@given(quaternions(), vectors())
def test_rigid_registration_recovers_the_motion(q, translation):
    points = np.random.default_rng(3).normal(size=(12, 3)) * 50
    rotation = geo.matrix_from_quaternion(q)
    found, shift = geo.register_rigid(points, points @ rotation.T + translation)
    np.testing.assert_allclose(found, rotation, atol=1e-9)
    np.testing.assert_allclose(shift, translation, atol=1e-6)


def test_rigid_registration_never_mirrors():
    points = np.random.default_rng(4).normal(size=(9, 3))
    rotation, _ = geo.register_rigid(points, points * [1, 1, -1])
    assert np.linalg.det(rotation) == pytest.approx(1)


@settings(max_examples=30)
@given(quaternions(), vectors(), st.floats(0.2, 5))
def test_procrustes_recovers_the_similarity(q, translation, scale):
    points = np.random.default_rng(5).normal(size=(10, 3)) * 30
    rotation = geo.matrix_from_quaternion(q)
    found = geo.procrustes(points, scale * points @ rotation.T + translation)
    assert found[0] == pytest.approx(scale)
    np.testing.assert_allclose(found[1], rotation, atol=1e-8)
    np.testing.assert_allclose(found[2], translation, atol=1e-5)


@given(quaternions(), st.floats(0, 3.1))
def test_angle_between_rotations(q, angle):
    axis = np.array([0.6, 0.0, 0.8])
    turn = geo.quaternion_from_matrix(geo.matrix_from_rotation_vector(angle * axis))
    found = geo.rotation_angle_rad(q, geo.multiply_quaternions(turn, q))
    assert float(found) == pytest.approx(angle, abs=1e-6)
