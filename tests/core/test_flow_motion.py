import cv2
import numpy as np
import pytest

from core.flow_motion import (
    N_FOLLOWED,
    camera_between,
    carried,
    face_size_px,
    follow_points,
)
from core.landmarks import GROUPS

MOUTH = np.array(sorted({*GROUPS["lips_outer"], *GROUPS["lips_inner"]}))


def texture(rng, size_px=(320, 240)):
    """A picture with detail of a few pixels everywhere."""
    noise = rng.normal(size=size_px[::-1])
    smooth = cv2.GaussianBlur(noise, (0, 0), 2.0) + 2 * cv2.GaussianBlur(noise, (0, 0), 6.0)
    return (120 + 60 * smooth / smooth.std()).clip(0, 255).astype(np.uint8)


def warped(picture, affine):
    return cv2.warpAffine(picture, affine, picture.shape[::-1], borderMode=cv2.BORDER_REFLECT)


@pytest.fixture
def picture(rng):
    return texture(rng)


@pytest.fixture
def face(points_px):
    return points_px * 90 + [160, 120], np.zeros(N_FOLLOWED)


@pytest.fixture
def points_px():
    """The 62 followed points about as they lie in a face one unit wide."""
    rng = np.random.default_rng(5)
    points = rng.uniform(-0.5, 0.5, (N_FOLLOWED, 2))
    points[MOUTH] = rng.uniform([-0.2, 0.3], [0.2, 0.45], (len(MOUTH), 2))
    return points


def test_recovers_a_turn_and_shift_of_the_picture(picture, face):
    affine = cv2.getRotationMatrix2D((160, 120), 3.0, 1.02)
    affine[:, 2] += [4.0, -3.0]
    motion = follow_points(picture, warped(picture, affine), *face)
    truth = face[0] @ affine[:, :2].T + affine[:, 2]
    assert np.abs(motion.points_px - truth).max() < 0.3
    np.testing.assert_allclose(motion.camera[:, :2], affine[:, :2], atol=5e-3)
    assert motion.trust.min() > 0.8


@pytest.mark.parametrize("times", [2, 4])
def test_large_faces_are_followed_as_well_in_parts_of_their_size(picture, face, times):
    affine = np.array([[1, 0, 3.3], [0, 1, -2.1]])
    wide = [
        cv2.resize(one, None, fx=times, fy=times, interpolation=cv2.INTER_CUBIC)
        for one in (picture, warped(picture, affine))
    ]
    start = (face[0] + 0.5) * times - 0.5
    motion = follow_points(*wide, start, face[1])
    assert np.abs(motion.points_px - start - affine[:, 2] * times).max() < 0.15 * times


def test_a_point_that_cannot_be_followed_goes_with_its_neighbours(picture, face):
    lost = MOUTH[3]
    after = warped(picture, np.array([[1, 0, 5.0], [0, 1, 2.0]]))
    x, y = (face[0][lost] + [5, 2]).astype(int)
    after[y - 9 : y + 10, x - 9 : x + 10] = 128
    motion = follow_points(picture, after, *face)
    assert motion.trust[lost] < 0.3
    np.testing.assert_allclose(motion.points_px[lost], face[0][lost] + [5, 2], atol=1.0)


@pytest.mark.parametrize("gain", [0.5, 0.8, 1.2])
def test_a_change_of_light_is_no_motion(picture, face, gain):
    dim = (0.5 * picture + 40).astype(np.uint8)
    after = warped((gain * dim).clip(0, 255).astype(np.uint8), np.array([[1, 0, 3.0], [0, 1, 1.0]]))
    motion = follow_points(dim, after, *face)
    assert np.abs(motion.points_px - face[0] - [3, 1]).max() < 0.3
    assert motion.trust.min() > 0.5


def test_nothing_to_see_and_a_cut_are_not_followed(rng, picture, face):
    flat = np.full((240, 320), 90, np.uint8)
    assert follow_points(flat, flat, *face) is None
    assert follow_points(picture, texture(rng), *face) is None


def test_a_face_outside_the_picture_or_not_finite_is_not_followed(picture, face):
    points, depth = face
    assert follow_points(picture, picture, points + [400, 0], depth) is None
    assert follow_points(picture, picture, points * np.nan, depth) is None
    assert follow_points(picture[:10, :10], picture[:10, :10], points, depth) is None


def test_the_camera_of_a_turning_head_is_found(rng):
    points = rng.normal(0, 40, (N_FOLLOWED, 2))
    depth = rng.normal(0, 25, N_FOLLOWED)
    camera = np.array([[0.97, 0.02, 0.2, 5.0], [-0.03, 1.01, -0.1, -2.0]])
    after = carried(camera, points, depth)
    weights = rng.uniform(0.5, 1, N_FOLLOWED)
    found = camera_between(points, depth, after, weights)
    assert np.abs(carried(found, points, depth) - after).max() < 0.03 * face_size_px(after - points)


def test_points_in_a_line_move_by_their_mean(rng):
    line = np.column_stack([np.linspace(0, 50, N_FOLLOWED), np.zeros(N_FOLLOWED)])
    camera = camera_between(line, np.zeros(N_FOLLOWED), line + [3, 4], np.ones(N_FOLLOWED))
    np.testing.assert_allclose(camera[:, 3], [3, 4], atol=1e-6)
    np.testing.assert_allclose(camera[:, 1], [0, 1], atol=1e-6)


def test_without_any_weight_nothing_moves_apart():
    points = np.zeros((N_FOLLOWED, 2))
    camera = camera_between(points, np.zeros(N_FOLLOWED), points + 2, np.zeros(N_FOLLOWED))
    assert np.isfinite(camera).all()
