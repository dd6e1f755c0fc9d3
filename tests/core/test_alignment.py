from pathlib import Path

import cv2
import numpy as np
import pytest

from core.alignment import FaceAligner
from core.arkit import ARKIT_NAMES
from core.face_regions import Region
from core.geometry import head_angles_from_matrix
from core.landmarks import GROUPS, MIRROR, N_INTERNAL

REPOSITORY = Path(__file__).resolve().parents[2]
DATA = REPOSITORY / "tests" / "data"


@pytest.fixture(scope="module")
def aligner():
    return FaceAligner(REPOSITORY / "assets" / "aligner")


@pytest.fixture(scope="module")
def picture():
    """A performer near, and the same small at the right, turned to her left."""
    return cv2.cvtColor(cv2.imread(str(DATA / "two_faces.jpg")), cv2.COLOR_BGR2RGB)


@pytest.fixture(scope="module")
def truth():
    with np.load(DATA / "two_faces.npz") as arrays:
        return dict(arrays)


@pytest.fixture(scope="module")
def near(aligner, picture):
    return aligner.first(picture)


@pytest.fixture(scope="module")
def far(aligner, picture):
    return aligner.first(without_near(picture))


def without_near(picture):
    alone = picture.copy()
    alone[:, :220] = 110
    return alone


def error(landmarks, true):
    """RMS distance of the internal landmarks in parts of the distance of the eyes."""
    eyes = [true[list(GROUPS[name])].mean(axis=0) for name in ("eye_right", "eye_left")]
    off = landmarks.points_px[:N_INTERNAL] - true[:N_INTERNAL]
    return np.sqrt(np.mean(np.sum(off**2, axis=1))) / np.linalg.norm(eyes[0] - eyes[1])


def test_detector_lists_the_larger_face_first(aligner, picture, truth):
    boxes = aligner.detect(picture)
    assert len(boxes) == 2
    for box, name in zip(boxes, ("near", "far"), strict=True):
        middle = truth[name][:N_INTERNAL].mean(axis=0)
        assert np.all(np.abs(middle - box.center_px) < 0.25 * box.size_px)
        right, left = truth[name][75:77]
        np.testing.assert_allclose(box.keypoints_px[:2], [right, left], atol=4)


def test_first_is_the_largest_face_with_landmarks_where_they_truly_are(near, truth):
    assert near.presence > 0.9
    assert error(near.landmarks, truth["near"]) < 0.07
    np.testing.assert_allclose(near.landmarks.pupils_px, truth["near"][75:77], atol=1.0)
    assert near.landmarks.confidence[:N_INTERNAL].min() > 0.8
    assert near.landmarks.pupil_confidence.min() > 0.9


def test_rotation_is_that_of_the_head(near, far):
    assert abs(np.rad2deg(head_angles_from_matrix(near.rotation)[0])) < 8
    assert np.rad2deg(head_angles_from_matrix(far.rotation)[0]) == pytest.approx(32, abs=8)


def test_following_stays_with_the_same_face_even_if_another_is_larger(aligner, picture, far, truth):
    following = aligner.follow(picture, far)
    assert error(following.landmarks, truth["far"]) < 0.12


def test_a_face_that_jumped_is_found_again_by_the_detector(aligner, picture, near, truth):
    moved = np.roll(picture, 60, axis=1)
    found = aligner.follow(moved, near)
    assert error(found.landmarks, truth["near"] + [60, 0]) < 0.07


def test_a_face_too_far_away_is_not_taken_for_the_lost_one(aligner, picture, near):
    alone = without_near(picture)
    assert aligner.follow(alone, near) is None
    assert aligner.follow(alone, None) is not None


def test_check_looks_where_a_tracker_says_and_sees_the_same(aligner, picture, near, truth):
    checked = aligner.check(picture, truth["near"][:75])
    assert error(checked.landmarks, near.landmarks.points_px) < 0.02
    nowhere = np.full((75, 2), np.nan)
    assert aligner.check(picture, nowhere) is None
    assert aligner.check(picture, truth["near"][:75] * 0.3) is None


def test_an_empty_picture_has_no_face(aligner, rng):
    empty = rng.integers(0, 255, (120, 160, 3), dtype=np.uint8)
    assert aligner.detect(empty) == []
    assert aligner.first(empty) is None


@pytest.mark.parametrize("size_px", [0.0, 3.0, 1e5, np.nan])
def test_a_region_that_ran_away_holds_no_face(aligner, picture, size_px):
    assert aligner.align(picture, Region(np.array([100.0, 100.0]), size_px, 0.0)) is None


def test_points_outside_the_picture_have_no_confidence(aligner, picture, near):
    cut_px = near.landmarks.points_px[list(GROUPS["lips_outer"]), 1].min() - 2
    cut = picture[: int(cut_px)]
    found = aligner.align(cut, near.region)
    outside = found.landmarks.points_px[:, 1] > cut.shape[0]
    assert outside.any()
    assert not found.landmarks.confidence[outside].any()


def test_mirrored_picture_gives_mirrored_landmarks(aligner, picture, near):
    width = picture.shape[1]
    center = np.array([width - 1 - near.region.center_px[0], near.region.center_px[1]])
    region = Region(center, near.region.size_px, -near.region.angle_rad)
    mirrored = aligner.align(np.ascontiguousarray(picture[:, ::-1]), region)
    back = mirrored.landmarks.points_px[MIRROR]
    back[:, 0] = width - 1 - back[:, 0]
    assert error(near.landmarks, back) < 0.05
    # Half a pixel of the network's input would show as a shift between the two.
    shift = np.mean(back - near.landmarks.points_px, axis=0)
    assert np.abs(shift).max() < 0.25


def test_weights_tell_a_turned_away_glance_and_no_open_mouth(aligner, far):
    weights = dict(zip(ARKIT_NAMES, aligner.arkit_weights(far), strict=True))
    assert all(0 <= value <= 1 for value in weights.values())
    # The far performer turned to her left and still looks into the camera, to her right.
    assert weights["eyeLookInLeft"] > weights["eyeLookOutLeft"] + 0.2
    assert weights["eyeLookOutRight"] > weights["eyeLookInRight"] + 0.2
    assert weights["jawOpen"] < 0.2
    assert weights["tongueOut"] == 0


def test_alignment_of_the_same_picture_is_the_same(aligner, picture, near):
    again = aligner.first(picture)
    assert (again.mesh_px == near.mesh_px).all()


@pytest.mark.slow
def test_the_real_person_is_found_in_every_frame_and_blinks(aligner, clips):
    capture = cv2.VideoCapture(str(clips / "person_a_2.mp4"))
    found, pupils = None, []
    for _ in range(150):
        rgb = cv2.cvtColor(capture.read()[1], cv2.COLOR_BGR2RGB)
        found = aligner.follow(rgb, found)
        assert found is not None
        pupils.append(found.landmarks.pupil_confidence)
    closed = np.flatnonzero(np.max(pupils, axis=1) < 0.1)
    assert {99, 100, 101} <= set(closed) <= set(range(96, 106))
