"""Facts about the landmark network's mean error."""

import numpy as np
import pytest

from app.performer.opening import Scenario, open_performer
from core.aligner_bias import (
    FURTHEST_RAD,
    N_TURNING,
    STRANGEST,
    AlignerBias,
    features,
    in_plane,
    load_aligner_bias,
    unposed_mm,
)
from core.alignment import FaceAligner
from core.errors import ArrayShapeError
from core.geometry import matrix_from_head_angles
from core.landmarks import MIRROR, N_INTERNAL
from core.mean_face import load_mean_face
from tests.app.gl import renderer_or_skip
from tests.core.tracked_faces import ASSETS

MIRROR_INTERNAL = np.asarray(MIRROR[:N_INTERNAL])
N_ANGLE_TERMS, N_SHAPES = 11, 70


@pytest.fixture(scope="module")
def shipped():
    return load_aligner_bias(ASSETS / "aligner" / "bias.npz")


@pytest.fixture(scope="module")
def mean():
    """The network's points on its mean face, (478, 3) mm; the irises do not matter here."""
    face = load_mean_face(ASSETS / "aligner" / "mean_face.npz").vertices_mm
    return np.concatenate([face, np.zeros((10, 3))])


def error(bias, mean_mm, angles, px_per_mm=1.0):
    """The foretold error (60, 2) of the given face under weak perspective."""
    rotation = matrix_from_head_angles(*angles)
    points = px_per_mm * mean_mm @ rotation.T + [320.0, 240.0, 0.0]
    return bias.error_px(points[:, :2], points[:, 2], rotation, px_per_mm)


def plain(coefficients):
    """A bias that reads four points and takes their coordinates as they are."""
    modes = np.zeros((N_SHAPES, 4, 3))
    modes[np.arange(12), np.arange(4).repeat(3), np.tile(np.arange(3), 4)] = 1.0
    return AlignerBias(np.arange(4), np.zeros((4, 3)), modes, coefficients)


def n_features():
    return features(np.zeros(2), np.zeros(N_SHAPES)).size


def test_features_are_the_polynomial_the_shape_and_the_shape_by_the_angles():
    y, p, shape = 0.3, -0.2, np.linspace(-2, 2, N_SHAPES)
    angles = [1, y, p, y * y, y * p, p * p, y**3, y * y * p, y * p * p, p**3, y**4]
    strong = shape[:N_TURNING]
    expected = np.concatenate([angles, shape, strong * y, strong * p, strong * y * y])
    assert np.allclose(features(np.array([y, p]), shape), expected)
    many = np.random.default_rng(0).uniform(-0.4, 0.4, (5, 3, 2))
    shapes = np.tile(shape, (5, 3, 1))
    assert np.allclose(features(many, shapes)[2, 1], features(many[2, 1], shape))


def test_nothing_is_foretold_beyond_what_was_measured():
    yaw, pitch = FURTHEST_RAD
    beyond = features(np.array([yaw + 0.4, -pitch - 0.3]), np.full(N_SHAPES, 50.0))
    edge = features(np.array([yaw, -pitch]), np.full(N_SHAPES, STRANGEST))
    assert np.array_equal(beyond, edge)


def test_points_without_their_pose_are_those_of_the_face(rng):
    face = rng.normal(0, 40, (9, 3))
    rotation = matrix_from_head_angles(0.5, -0.2, 0.3)
    points = 1.7 * face @ rotation.T + [300.0, 200.0, 15.0]
    assert np.allclose(unposed_mm(points, rotation, 1.7), face - face.mean(axis=0))


@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (0.4, 0.1, 0.2), (0.9, -0.3, 0.0)])
def test_the_shipped_error_of_the_mirrored_head_is_the_mirrored_error(shipped, mean, angles):
    there = error(shipped, mean, angles)
    mirrored = error(shipped, mean, np.array(angles) * [-1, 1, -1])
    assert np.allclose(mirrored, there[MIRROR_INTERNAL] * [-1, 1], atol=0.05)


def test_the_shipped_error_is_small_also_for_a_shape_that_nobody_has(shipped, mean, rng):
    odd = mean + rng.normal(0, 60, mean.shape)
    usual_mm = np.linalg.norm(error(shipped, mean, (0.0, 0.0, 0.0)), axis=1)
    odd_mm = np.linalg.norm(error(shipped, odd, (0.0, 0.0, 0.0)), axis=1)
    assert 0.3 < usual_mm.mean() < 4 and usual_mm.max() < 10
    assert odd_mm.max() < 40


@pytest.mark.parametrize("roll", [-0.7, 0.2, 1.5])
def test_roll_turns_the_error_with_the_head(shipped, mean, roll):
    upright, rolled = (error(shipped, mean, (0.3, 0.1, angle)) for angle in (0.0, roll))
    assert np.allclose(rolled, upright @ in_plane(roll).T)
    # In the picture as the head itself turns: x goes where the rotation takes it.
    head = matrix_from_head_angles(0.0, 0.0, roll)
    assert np.allclose(in_plane(roll), head[:2, :2])


def test_scale_multiplies_the_error(shipped, mean):
    angles = (0.3, 0.1, 0.2)
    assert np.allclose(error(shipped, mean, angles, 4.0), 4 * error(shipped, mean, angles))


def test_coefficients_are_used_as_they_are(rng):
    face = rng.uniform(-1, 1, (478, 3))
    coefficients = np.zeros((N_INTERNAL, 2, n_features()))
    coefficients[7, 1, 1] = 2.0
    coefficients[9, 0, N_ANGLE_TERMS + 4] = 3.0
    found = error(plain(coefficients), face, (0.25, 0.1, 0.0))
    assert found[7, 1] == pytest.approx(0.5)
    # The fifth number of shape is the y of the second of the four points.
    assert found[9, 0] == pytest.approx(3 * (face[1, 1] - face[:4, 1].mean()))
    assert np.count_nonzero(found) == 2


def test_coefficients_of_another_number_of_landmarks_are_refused():
    with pytest.raises(ArrayShapeError, match="coefficients_mm"):
        plain(np.zeros((75, 2, n_features())))


def errors_px(found, true_px):
    """The mean distance of the landmarks that are seen from the truth, for each alignment."""
    seen = found[0].landmarks.confidence[:N_INTERNAL] > 0.3
    off = [one.landmarks.points_px[:N_INTERNAL] - true_px[:N_INTERNAL] for one in found]
    return [np.linalg.norm(one[seen], axis=1).mean() for one in off]


@pytest.mark.slow
@pytest.mark.gl
@pytest.mark.parametrize("person", ["mara", "tomas", "ayo"])
def test_landmarks_of_people_it_was_not_measured_on_are_nearer_the_truth_with_it(shipped, person):
    renderer_or_skip()
    scenario = Scenario("head_turns", person)
    folder = ASSETS / "aligner"
    aligners = FaceAligner(folder), FaceAligner(folder, shipped)
    missed_px = []
    with open_performer(scenario) as performer:
        for index in range(0, performer.n_frames, performer.n_frames // 10):
            rgb = performer.picture(index).rgb
            found = [aligner.first(rgb) for aligner in aligners]
            if found[0] is not None:
                missed_px.append(errors_px(found, performer.landmarks_px(index)))
    without, with_it = np.mean(missed_px, axis=0)
    assert len(missed_px) >= 8
    assert with_it < 0.72 * without
