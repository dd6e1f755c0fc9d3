"""Mean face, outline and confidences, with the mean face itself as the network's answer."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from core.geometry import head_angles_from_matrix, matrix_from_head_angles
from core.landmark_confidence import confidences, eye_openings, inside, smooth_step, visibility
from core.landmarks import GROUPS, MESH478, MIRROR, N_INTERNAL, NAMES, PUPILS478
from core.mean_face import barycentric, head_rotation, load_mean_face, smooth_normals
from core.outline import outline, outline_lines

PATH = Path(__file__).resolve().parents[2] / "assets" / "aligner" / "mean_face.npz"


@pytest.fixture(scope="module")
def mean():
    return load_mean_face(PATH)


def answer(mean, yaw=0.0, pitch=0.0, roll=0.0, scale=2.0):
    """The network's points of the mean face, turned, and the rotation."""
    rotation = matrix_from_head_angles(*np.deg2rad([yaw, pitch, roll]))
    eyes = [mean.vertices_mm[MESH478[list(GROUPS[n])]].mean(0) for n in ("eye_right", "eye_left")]
    points = np.concatenate([mean.vertices_mm, np.repeat(eyes, 5, axis=0)])
    turned = scale * points @ rotation.T + [300, 200, 0]
    return turned[:, :2], turned[:, 2], rotation


def named(values, *names):
    return values[[NAMES.index(name) for name in names]]


@pytest.mark.parametrize("angles", [(0, 0, 0), (40, -10, 5), (-60, 20, -30)])
def test_rotation_is_recovered(mean, angles):
    mesh, depth, _ = answer(mean, *angles)
    found = np.rad2deg(head_angles_from_matrix(head_rotation(mean, mesh, depth)))
    np.testing.assert_allclose(found, angles, atol=1e-6)


def test_smooth_normals_point_out_of_the_face(mean):
    normals = smooth_normals(mean)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
    assert normals[1] @ [0, 0, -1] > 0.9
    left_ear, right_ear = normals[454], normals[234]
    assert left_ear[0] > 0.5 and right_ear[0] < -0.5


def test_barycentric_weights_rebuild_the_point_and_degenerate_triangles_stay_finite(rng):
    corners, point = rng.normal(size=(5, 3, 2)), rng.normal(size=(5, 2))
    weights = barycentric(corners, point)
    np.testing.assert_allclose(np.einsum("tk,tkc->tc", weights, corners), point)
    assert np.isfinite(barycentric(np.zeros((3, 2)), np.ones(2))).all()


def test_frontal_outline_is_the_networks_oval(mean):
    mesh, _, rotation = answer(mean)
    found = outline(outline_lines(mean), mesh, rotation)
    assert np.linalg.norm(found - mesh[MESH478[N_INTERNAL:]], axis=1).max() < 4


@pytest.mark.parametrize("yaw", [25, 45])
def test_on_a_turned_head_the_far_outline_encloses_the_face(mean, yaw):
    mesh, _, rotation = answer(mean, yaw)
    found = dict(zip(NAMES[60:], outline(outline_lines(mean), mesh, rotation), strict=True))
    oval = dict(zip(NAMES[60:], mesh[MESH478[60:]], strict=True))
    for name in ("L2", "L3", "L4", "L5"):
        # Turned to her left, her left side is the far one, at the right of the picture.
        assert found[name][0] > oval[name][0] + 4
        level = np.abs(mesh[:468, 1] - found[name][1]) < 12
        cheek = level & (mean.vertices_mm[:, 0] > 25)
        assert found[name][0] > mesh[:468][cheek, 0].max() - 6
    for name in ("R2", "R4", "R6"):
        np.testing.assert_allclose(found[name], oval[name])


def test_mirrored_heads_have_mirrored_outlines_and_confidences(mean):
    lines = outline_lines(mean)
    known = visibility(mean, lines)
    left, right = answer(mean, 35, 5), answer(mean, -35, 5)
    outlines = [outline(lines, mesh, rotation) for mesh, _, rotation in (left, right)]
    mirrored = outlines[1][::-1] * [-1, 1] + [600, 0]
    np.testing.assert_allclose(outlines[0], mirrored, atol=1e-6)
    seen = [confidences(known, *view) for view in (left, right)]
    np.testing.assert_allclose(seen[0][:75], seen[1][:75][MIRROR], atol=1e-6)


def test_all_of_a_frontal_face_is_seen_and_the_outline_trusted_less(mean):
    confidence = confidences(visibility(mean, outline_lines(mean)), *answer(mean))
    assert confidence[:N_INTERNAL].min() > 0.9
    assert 0.3 < confidence[N_INTERNAL:75].min() <= confidence[N_INTERNAL:75].max() < 0.9
    assert confidence[75:].min() > 0.9


def test_a_turned_head_hides_its_far_side_and_what_lies_behind_the_nose(mean):
    known = visibility(mean, outline_lines(mean))
    confidence = confidences(known, *answer(mean, 65))
    near = named(confidence, "R_eye_outer", "R_brow_2", "R_mouth_corner", "nose_tip")
    far = named(confidence, "L_brow_1", "L_brow_2", "L_eye_outer", "L_ala", "L_eye_inner")
    assert near.min() > 0.9
    assert far.max() < 0.4
    assert confidence[76] < 0.5 < confidence[75]


def test_confidence_falls_steadily_as_the_head_turns(mean):
    known = visibility(mean, outline_lines(mean))
    brow = [named(confidences(known, *answer(mean, yaw)), "L_brow_1")[0] for yaw in range(0, 90, 5)]
    assert all(a >= b for a, b in itertools.pairwise(brow))
    assert brow[0] == 1 and brow[-1] == 0


def test_closed_lids_hide_the_pupil_of_that_eye(mean):
    mesh, depth, rotation = answer(mean)
    closed = mesh.copy()
    for upper, lower in (("up_outer", "lo_outer"), ("up_mid", "lo_mid"), ("up_inner", "lo_inner")):
        a, b = (MESH478[NAMES.index(f"R_eye_{lid}")] for lid in (upper, lower))
        closed[a] = closed[b]
    right, left = eye_openings(closed, depth)
    assert right < 0.05 and left > 0.25
    confidence = confidences(visibility(mean, outline_lines(mean)), closed, depth, rotation)
    assert confidence[75] == 0 and confidence[76] == 1
    assert PUPILS478[0] == 468


def test_smooth_step_and_inside_at_their_ends():
    np.testing.assert_allclose(smooth_step(np.array([-1, 0, 0.5, 1, 2.0]), 0, 1), [0, 0, 0.5, 1, 1])
    points = np.array([[-0.6, 0], [-0.4, 0], [9.4, 4.4], [9.6, 4.4]])
    np.testing.assert_array_equal(inside(points, (10, 5)), [0, 1, 1, 0])
