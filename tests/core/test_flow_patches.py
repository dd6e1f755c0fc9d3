import cv2
import numpy as np
import pytest

from core.flow_error import Signs, confidences_of, expected_error
from core.flow_patches import difference, frames_of, patches
from core.landmarks import GROUPS, NAMES
from tests.core.followed_face import drawn_face, face_points


@pytest.fixture
def points():
    return face_points()


def test_patches_hold_still_while_the_head_turns_in_the_picture_and_comes_nearer(points):
    affine = cv2.getRotationMatrix2D((160, 120), 12.0, 1.25)
    picture = drawn_face(points)
    moved = cv2.warpAffine(picture, affine, picture.shape[::-1])
    there = points @ affine[:, :2].T + affine[:, 2]
    for one, other in zip(patches(picture, points), patches(moved, there), strict=True):
        assert difference(one, other) < 0.05


def test_gain_and_brightness_do_not_matter(points):
    picture = drawn_face(points)
    darker = (0.6 * picture + 20).astype(np.uint8)
    for one, other in zip(patches(picture, points), patches(darker, points), strict=True):
        assert difference(one, other) < 0.01


def test_a_wink_shows_in_its_eye_only_and_an_open_mouth_in_the_mouth(points):
    still = patches(drawn_face(points), points)
    wink = patches(drawn_face(points, lids=(1.0, 0.0)), points)
    open_mouth = patches(drawn_face(points, jaw=1.0), points)
    changes = [
        [difference(a, b) for a, b in zip(still, x, strict=True)] for x in (wink, open_mouth)
    ]
    assert changes[0][0] > 0.2 > 0.02 > max(changes[0][1:])
    assert changes[1][2] > 0.2 > 0.02 > max(changes[1][:2])


def test_a_plain_surface_is_not_blown_up_to_contrast(rng, points):
    noise = (100 + rng.normal(0, 0.4, (2, 240, 320))).round().astype(np.uint8)
    for one, other in zip(*(patches(picture, points) for picture in noise), strict=True):
        assert difference(one, other) < 0.05


def test_frames_lie_over_their_features(points):
    for frame, name in zip(frames_of(points), ("eye_right", "eye_left", "lips_outer"), strict=True):
        inside = np.linalg.solve(frame[:, :2], (points[list(GROUPS[name])] - frame[:, 2]).T)
        assert inside.min() > 0.02
        assert inside.max() < 0.98


def test_points_in_one_place_give_patches_all_the_same():
    flat = np.full((40, 40), 7, np.uint8)
    for patch in patches(flat, np.zeros((len(NAMES), 2))):
        assert np.isfinite(patch).all()


def test_every_sign_raises_the_expected_error():
    calm = expected_error(Signs(0.0, 0.0, 0.0, 0.0, 0.0))
    assert calm < 0.002
    for k in range(4):
        signs = [0.0] * 5
        signs[k] = 0.5
        assert expected_error(Signs(*signs)) > calm + 0.001
    assert expected_error(Signs(0.0, 0.0, 0.0, 0.2, 0.9)) > expected_error(
        Signs(0.0, 0.0, 0.0, 0.2, 0.0)
    )


def test_confidence_falls_from_one_to_little_with_trust():
    confidence = confidences_of(np.array([1.0, 0.9, 0.5, 0.1, 0.0]))
    assert confidence[0] == 1.0
    assert confidence[2] == pytest.approx(0.72, abs=0.01)
    assert (np.diff(confidence) < 0).all()
    assert 0.1 < confidence[-1] < 0.2
