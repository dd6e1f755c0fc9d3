"""Facts about the rough pose."""

import numpy as np
import pytest

from core.camera import camera_for, project
from core.geometry import matrix_from_head_angles, rotation_vector_from_matrix
from core.posit import pose_from_points
from tests.core.synthetic_fit import synthetic_space

CAMERA = camera_for((640, 480), 600.0)
POINTS = synthetic_space().mean_mm[:60]


@pytest.mark.parametrize("yaw", [-1.2, -0.5, 0.0, 0.5, 1.2])
@pytest.mark.parametrize("distance", [350.0, 700.0])
def test_recovers_the_pose_of_exact_points(yaw, distance):
    rotation = matrix_from_head_angles(yaw, 0.2, -0.1)
    translation = np.array([30.0, -20.0, distance])
    seen = project(CAMERA, POINTS @ rotation.T + translation)
    found, place = pose_from_points(CAMERA, POINTS, seen, np.ones(60))
    assert np.linalg.norm(rotation_vector_from_matrix(found @ rotation.T)) < 0.01
    np.testing.assert_allclose(place, translation, atol=0.01 * distance)


def test_a_point_without_weight_is_not_looked_at():
    rotation = matrix_from_head_angles(0.3, 0.0, 0.0)
    seen = project(CAMERA, POINTS @ rotation.T + [0, 0, 600])
    weights = np.ones(60)
    weights[[3, 17]] = 0.0
    wrong = seen.copy()
    wrong[[3, 17]] += 200.0
    for a, b in zip(
        pose_from_points(CAMERA, POINTS, seen, weights),
        pose_from_points(CAMERA, POINTS, wrong, weights),
        strict=True,
    ):
        np.testing.assert_allclose(a, b, atol=1e-9)
