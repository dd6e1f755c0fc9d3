import numpy as np
import pytest

from core.face_regions import Region, anchors, boxes_of, region_of_box, region_of_points

PLAIN = np.array([[2.0, 0.0, 10.0], [0.0, 2.0, 20.0]])


def answer(*faces):
    """What the detector says of faces (candidate, logit, x, y, size in px of its input)."""
    scores, offsets = np.full(896, -20.0, np.float32), np.zeros((896, 16), np.float32)
    for candidate, logit, x, y, size in faces:
        scores[candidate] = logit
        center = anchors()[candidate] * 128
        eyes = np.array([[x - size / 4, y], [x + size / 4, y]])
        points = np.concatenate([eyes, np.repeat([[x, y]], 4, axis=0)])
        offsets[candidate, :2] = [x, y] - center
        offsets[candidate, 2:4] = size
        offsets[candidate, 4:] = (points - center).ravel()
    return scores, offsets


def test_anchors_are_the_middles_of_the_cells():
    places = anchors()
    assert places.shape == (896, 2)
    np.testing.assert_allclose(places[:3] * 128, [[4, 4], [4, 4], [12, 4]])
    np.testing.assert_allclose(places[512:519] * 128, [[8, 8]] * 6 + [[24, 8]])


def test_one_face_comes_back_in_px_of_the_picture():
    (box,) = boxes_of(*answer((300, 3.0, 60.0, 50.0, 40.0)), PLAIN)
    np.testing.assert_allclose(box.center_px, [130, 120], atol=1e-4)
    np.testing.assert_allclose(box.size_px, [80, 80])
    np.testing.assert_allclose(box.keypoints_px[:2], [[110, 120], [150, 120]], atol=1e-4)
    assert box.score == pytest.approx(1 / (1 + np.exp(-3)))


def test_overlapping_answers_are_one_face_between_them():
    (box,) = boxes_of(*answer((300, 2.0, 60, 50, 40), (301, 2.0, 62, 50, 40)), PLAIN)
    np.testing.assert_allclose(box.center_px, [132, 120], atol=1e-4)


def test_separate_faces_come_with_the_largest_first_however_sure():
    boxes = boxes_of(*answer((10, 9.0, 30, 30, 20), (700, 1.0, 90, 90, 50)), PLAIN)
    assert [box.size_px[0] for box in boxes] == [100, 40]


def test_doubtful_answers_are_no_faces():
    assert boxes_of(*answer((10, -0.1, 30, 30, 20)), PLAIN) == []


def test_region_turns_with_the_eyes_and_is_half_as_large_again():
    (box,) = boxes_of(*answer((300, 3.0, 60.0, 50.0, 40.0)), PLAIN)
    assert region_of_box(box).size_px == 120
    points = np.array([[0.0, 0], [100, 0], [0, 60], [100, 60]])
    region = region_of_points(points, np.array([20.0, 20]), np.array([60.0, 60]))
    assert region.size_px == 150
    assert region.angle_rad == pytest.approx(np.pi / 4)
    np.testing.assert_allclose(region.center_px, [50, 30])


def test_the_networks_middle_is_the_regions_middle_and_its_corners_lie_on_the_square():
    region = Region(np.array([30.0, 40.0]), 100.0, 0.3)
    to_picture = region.to_picture(256)
    inputs = np.array([[128, 128], [0, 0], [256, 0]])
    middle, corner, next_corner = inputs @ to_picture[:, :2].T + to_picture[:, 2]
    np.testing.assert_allclose(middle, [30, 40])
    side = next_corner - corner
    np.testing.assert_allclose(side, [100 * np.cos(0.3), 100 * np.sin(0.3)])
