"""Targets registered onto a neutral face by the back of the head."""

import numpy as np
import pytest

from core.geometry import matrix_from_rotation_vector
from core.target_alignment import AnchorsError, TargetShapeError, align_targets, back_of_head


def head(rng):
    """Return points (200, 3) on an ellipsoid, the face towards -z."""
    points = rng.normal(size=(200, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points * [70.0, 110.0, 90.0]


def expressions(rng, neutral, anchors, count=4):
    """Return deltas (count, 200, 3) that leave the anchors where they are."""
    deltas = rng.normal(size=(count, *neutral.shape))
    deltas[:, anchors] = 0
    return deltas


def thrown_about(rng, shapes):
    """Return the shapes, each turned by up to half a turn and moved away."""
    turned = []
    for shape in shapes:
        axis = rng.normal(size=3)
        vector = axis / np.linalg.norm(axis) * rng.uniform(0.1, 3.0)
        turned.append(shape @ matrix_from_rotation_vector(vector).T + rng.normal(size=3) * 300)
    return np.array(turned)


@pytest.fixture
def rng():
    return np.random.default_rng(3)


def test_the_back_is_behind_everything_else(rng):
    neutral = head(rng)
    anchors = back_of_head(neutral, 0.25)
    assert len(anchors) == 50
    assert neutral[anchors, 2].min() >= np.delete(neutral[:, 2], anchors).max()


def test_motion_of_the_head_is_taken_out_and_the_expression_left(rng):
    neutral = head(rng)
    anchors = back_of_head(neutral)
    deltas = expressions(rng, neutral, anchors)
    aligned = align_targets(thrown_about(rng, neutral + deltas), neutral, anchors)
    np.testing.assert_allclose(aligned.deltas_mm, deltas, atol=1e-4)
    np.testing.assert_allclose(aligned.rms_mm, 0, atol=1e-9)


def test_rotations_and_translations_are_those_that_were_applied(rng):
    neutral = head(rng)
    anchors = back_of_head(neutral)
    targets = thrown_about(rng, neutral + expressions(rng, neutral, anchors))
    aligned = align_targets(targets, neutral, anchors)
    moved = np.einsum("bij,bvj->bvi", aligned.rotations, targets)
    moved += aligned.translations_mm[:, None]
    np.testing.assert_allclose(moved - neutral, aligned.deltas_mm, atol=1e-4)


def test_a_mirror_image_is_turned_and_never_mirrored(rng):
    neutral = head(rng)
    anchors = back_of_head(neutral)
    aligned = align_targets((neutral * [-1, 1, 1])[None], neutral, anchors)
    assert np.linalg.det(aligned.rotations[0]) == pytest.approx(1.0)
    assert aligned.rms_mm[0] > 1.0


def test_flat_anchors_are_enough_and_give_a_rotation(rng):
    neutral = head(rng)
    anchors = back_of_head(neutral)
    neutral[anchors, 2] = 40.0
    aligned = align_targets(thrown_about(rng, neutral[None]), neutral, anchors)
    np.testing.assert_allclose(aligned.deltas_mm, 0, atol=1e-4)


def test_what_moves_the_anchors_shows_in_what_is_left(rng):
    neutral = head(rng)
    anchors = back_of_head(neutral)
    noisy = neutral + rng.normal(size=neutral.shape) * 2.0
    left = align_targets(noisy[None], neutral, anchors).rms_mm[0]
    assert 2.0 < left < 4.0


def test_anchors_on_a_line_are_refused(rng):
    neutral = head(rng)
    neutral[:3] = [[0, 0, 0], [0, 10, 0], [0, 20, 0]]
    with pytest.raises(AnchorsError, match="back of the head") as caught:
        align_targets(neutral[None], neutral, np.array([0, 1, 2], np.int32))
    assert caught.value.width == pytest.approx(0.0)


def test_two_anchors_are_refused(rng):
    neutral = head(rng)
    with pytest.raises(AnchorsError, match="2 anchors"):
        align_targets(neutral[None], neutral, np.array([0, 1], np.int32))


def test_targets_of_another_mesh_are_refused(rng):
    neutral = head(rng)
    with pytest.raises(TargetShapeError, match="export all from one mesh"):
        align_targets(neutral[None, :-1], neutral, back_of_head(neutral))
