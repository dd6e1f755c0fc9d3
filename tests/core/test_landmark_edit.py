"""Facts about what a hand does to landmarks."""

import numpy as np
import pytest

from core.landmark_edit import (
    N_POINTS,
    as_hidden,
    drag_weights,
    hidden,
    mirrored,
    placed_like,
    points_of,
    shifted,
    taken_from,
)
from core.landmarks import GROUPS, MIRROR, NAMES
from core.records import Landmarks2D


@pytest.fixture
def face(rng):
    return Landmarks2D(
        rng.uniform(200, 400, (75, 2)), np.zeros(75, bool), np.full(75, 0.7),
        rng.uniform(250, 350, (2, 2)), np.full(2, 0.6),
    )  # fmt: skip


def arch():
    """Points of which the upper right lid lies on a straight line, 10 px apart."""
    points = np.full((N_POINTS, 2), 500.0)
    for place, index in enumerate(GROUPS["brow_right"]):
        points[index] = (10.0 * place, 0.0)
    return points


def test_a_moved_point_counts_as_placed_and_others_stay(face):
    shifts = np.zeros((N_POINTS, 2))
    shifts[7] = (3.0, -2.0)
    moved = shifted(face, shifts)
    assert np.allclose(moved.points_px[7], face.points_px[7] + [3, -2])
    assert moved.edited[7] and moved.confidence[7] == 1.0
    others = np.arange(75) != 7
    assert np.array_equal(moved.points_px[others], face.points_px[others])
    assert not moved.edited[others].any()
    assert np.array_equal(moved.confidence[others], face.confidence[others])
    assert np.array_equal(moved.pupils_px, face.pupils_px)


def test_a_moved_pupil_is_sure(face):
    shifts = np.zeros((N_POINTS, 2))
    shifts[76] = (1.0, 0.0)
    moved = shifted(face, shifts)
    assert moved.pupil_confidence.tolist() == [0.6, 1.0]
    assert np.allclose(moved.pupils_px[1], face.pupils_px[1] + [1, 0])


def test_a_hard_drag_moves_only_what_is_grabbed():
    weights = drag_weights(arch(), [4, 70], soft=False)
    assert set(np.flatnonzero(weights)) == {4, 70}


def test_neighbours_on_the_curve_follow_a_soft_drag_the_less_the_further_they_are():
    brow = GROUPS["brow_right"]
    weights = drag_weights(arch(), [brow[2]], soft=True)
    assert weights[brow[2]] == 1.0
    assert weights[brow[1]] == pytest.approx(weights[brow[3]])
    assert 0 < weights[brow[1]] < 1
    assert weights[brow[5]] == 0.0
    assert not weights[list(set(range(N_POINTS)) - set(brow))].any()


def test_a_closed_curve_is_followed_both_ways_round():
    eye = GROUPS["eye_left"]
    points = np.zeros((N_POINTS, 2))
    angle = 2 * np.pi * np.arange(len(eye)) / len(eye)
    points[list(eye)] = 20 * np.column_stack([np.cos(angle), np.sin(angle)])
    weights = drag_weights(points, [eye[0]], soft=True)
    assert weights[eye[1]] == pytest.approx(weights[eye[-1]])
    assert weights[eye[1]] > 0.2


def test_hiding_hides_and_hiding_again_shows(face):
    gone = as_hidden(face, [3, 60, 75])
    assert set(np.flatnonzero(hidden(gone))) == {3, 60}
    assert gone.confidence[[3, 60]].tolist() == [0.0, 0.0] and gone.pupil_confidence[0] == 0.0
    back = as_hidden(gone, [3, 60, 75])
    assert not hidden(back).any()
    assert back.confidence[3] == 1.0 and back.pupil_confidence[0] == 1.0


def test_hiding_a_mixed_choice_hides_all_of_it(face):
    gone = as_hidden(as_hidden(face, [3]), [3, 4])
    assert hidden(gone)[[3, 4]].all()


def test_points_are_taken_from_another_record(face, rng):
    shifts = rng.normal(size=(N_POINTS, 2))
    moved = shifted(face, shifts)
    part = taken_from(moved, face, [2, 75])
    assert np.array_equal(points_of(part)[[2, 75]], points_of(face)[[2, 75]])
    assert np.array_equal(points_of(part)[3], points_of(moved)[3])
    assert not part.edited[2] and part.edited[3]
    whole = taken_from(moved, face)
    assert np.array_equal(points_of(whole), points_of(face)) and not whole.edited.any()


def test_a_copy_is_laid_over_the_face_of_the_picture(face):
    other = Landmarks2D(
        0.5 * face.points_px + [30, 10], face.edited, face.confidence,
        0.5 * face.pupils_px + [30, 10], face.pupil_confidence,
    )  # fmt: skip
    copied = placed_like(face, other, 640)
    assert np.allclose(points_of(copied), points_of(face), atol=1e-6)
    assert copied.edited.all()


def test_where_nothing_is_known_of_the_face_a_copy_stays_where_it_was(face):
    unknown = Landmarks2D(
        np.zeros((75, 2)), face.edited, np.zeros(75), np.zeros((2, 2)), np.zeros(2)
    )
    copied = placed_like(unknown, face, 640)
    assert np.allclose(points_of(copied), points_of(face))


def test_a_mirror_swaps_sides_and_two_mirrors_do_nothing(face):
    once = mirrored(face, 640)
    right, left = NAMES.index("R_eye_outer"), NAMES.index("L_eye_outer")
    assert MIRROR[right] == left
    assert np.allclose(
        once.points_px[left], [639 - face.points_px[right, 0], face.points_px[right, 1]]
    )
    assert np.allclose(once.pupils_px[0, 0], 639 - face.pupils_px[1, 0])
    assert np.allclose(points_of(mirrored(once, 640)), points_of(face))
