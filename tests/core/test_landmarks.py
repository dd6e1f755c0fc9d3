import numpy as np
import pytest

from core import landmarks


def test_there_are_75_landmarks_and_77_shape_points_with_names_of_their_own():
    assert len(set(landmarks.NAMES)) == landmarks.N_LANDMARKS == 75
    assert len(set(landmarks.SHAPE_NAMES)) == landmarks.N_SHAPE_POINTS == 77
    assert landmarks.NAMES[: landmarks.N_INTERNAL] == landmarks.SHAPE_NAMES[: landmarks.N_INTERNAL]


def test_outline_goes_from_the_right_ear_over_the_chin_to_the_left_ear():
    right = [f"R{i}" for i in range(1, 8)]
    left = [f"L{i}" for i in range(7, 0, -1)]
    assert list(landmarks.NAMES[60:]) == [*right, "chin", *left]


@pytest.mark.parametrize("mirror", [landmarks.MIRROR, landmarks.SHAPE_MIRROR])
def test_mirroring_twice_changes_nothing_and_only_the_midline_stays(mirror):
    assert (mirror[mirror] == np.arange(len(mirror))).all()
    assert (mirror[:60] == np.arange(60)).sum() == 10


def test_maps_to_other_schemes_are_one_to_one():
    assert len(set(landmarks.MESH478)) == 75
    assert landmarks.MESH478.max() < 468
    vertices = [*landmarks.INTERNAL_HEAD_VERTICES, *landmarks.REPLACEMENT_HEAD_VERTICES]
    assert len(set(vertices)) == 75
    assert max(vertices) < 4177


def test_ibug_map_is_its_own_inverse_and_knows_all_51_inner_points():
    known = np.flatnonzero(landmarks.IBUG68 >= 0)
    assert (landmarks.TO_IBUG68[landmarks.IBUG68[known]] == known).all()
    assert set(range(17, 68)) <= set(known)


def test_strips_of_the_two_sides_have_equal_lengths_and_share_no_vertex():
    strips = landmarks.CONTOUR_HEAD_STRIPS
    assert [len(strip) for strip in strips] == [len(strip) for strip in strips[::-1]]
    vertices = [vertex for strip in strips for vertex in strip]
    assert len(set(vertices)) == len(vertices)


def test_groups_hold_every_landmark_but_each_once():
    members = [index for group in landmarks.GROUPS.values() for index in group]
    assert sorted(members) == list(range(75))


def test_mirrored_groups_are_the_other_side():
    right = {int(landmarks.MIRROR[i]) for i in landmarks.GROUPS["eye_right"]}
    assert right == set(landmarks.GROUPS["eye_left"])


def test_triangles_use_every_point_and_no_edge_more_than_twice():
    triangles = landmarks.SHAPE_TRIANGLES
    assert set(triangles.ravel()) == set(range(77))
    edges = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    )
    _, counts = np.unique(edges, axis=0, return_counts=True)
    assert counts.max() == 2


def test_tables_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        landmarks.MESH478[0] = 3
