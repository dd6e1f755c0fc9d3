"""Facts about the landmark network's mean error."""

import numpy as np
import pytest

from app.performer.opening import Scenario, open_performer
from core.aligner_bias import FURTHEST_RAD, AlignerBias, features, in_plane, load_aligner_bias
from core.alignment import FaceAligner
from core.errors import ArrayShapeError
from core.geometry import matrix_from_head_angles
from core.landmarks import MIRROR, N_INTERNAL
from tests.app.gl import renderer_or_skip
from tests.core.tracked_faces import ASSETS

MIRROR_INTERNAL = np.asarray(MIRROR[:N_INTERNAL])


@pytest.fixture(scope="module")
def shipped():
    return load_aligner_bias(ASSETS / "aligner" / "bias.npz")


def error(bias, yaw, pitch, roll=0.0, px_per_mm=1.0):
    return bias.error_px(matrix_from_head_angles(yaw, pitch, roll), px_per_mm)


def test_features_are_the_polynomial():
    y, p = 0.3, -0.2
    expected = [1, y, p, y * y, y * p, p * p, y**3, y * y * p]
    assert np.allclose(features(np.array([y, p])), expected)
    many = np.random.default_rng(0).uniform(-0.4, 0.4, (5, 3, 2))
    assert np.allclose(features(many)[2, 1], features(many[2, 1]))


def test_nothing_is_foretold_beyond_the_angles_measured():
    furthest_yaw, furthest_pitch = FURTHEST_RAD
    beyond = features(np.array([furthest_yaw + 0.4, -furthest_pitch - 0.3]))
    assert np.array_equal(beyond, features(np.array([furthest_yaw, -furthest_pitch])))


@pytest.mark.parametrize(("yaw", "pitch"), [(0.0, 0.0), (0.4, 0.1), (0.9, -0.3)])
def test_the_shipped_error_of_the_mirrored_head_is_the_mirrored_error(shipped, yaw, pitch):
    there, mirrored = error(shipped, yaw, pitch), error(shipped, -yaw, pitch)
    assert np.allclose(mirrored, there[MIRROR_INTERNAL] * [-1, 1], atol=1e-3)


def test_the_shipped_error_is_small_and_larger_on_turned_heads(shipped):
    size_mm = [np.linalg.norm(error(shipped, yaw, 0.0), axis=1) for yaw in (0.0, 0.9)]
    assert 0.3 < size_mm[0].mean() < 3 and size_mm[0].max() < 8
    assert size_mm[0].mean() < size_mm[1].mean() < 6


@pytest.mark.parametrize("roll", [-0.7, 0.2, 1.5])
def test_roll_turns_the_error_with_the_head(shipped, roll):
    upright, rolled = error(shipped, 0.3, 0.1), error(shipped, 0.3, 0.1, roll)
    assert np.allclose(rolled, upright @ in_plane(roll).T)
    # In the picture as the head itself turns: x goes where the rotation takes it.
    head = matrix_from_head_angles(0.0, 0.0, roll)
    assert np.allclose(in_plane(roll), head[:2, :2])


def test_scale_multiplies_the_error(shipped):
    assert np.allclose(error(shipped, 0.3, 0.1, 0.2, 4.0), 4 * error(shipped, 0.3, 0.1, 0.2))


def test_coefficients_are_used_as_they_are():
    coefficients = np.zeros((N_INTERNAL, 2, 8))
    coefficients[7, 1, 1] = 2.0
    found = error(AlignerBias(coefficients), 0.25, 0.1)
    assert found[7, 1] == pytest.approx(0.5) and np.count_nonzero(found) == 1


def test_coefficients_of_another_number_of_landmarks_are_refused():
    with pytest.raises(ArrayShapeError, match="coefficients_mm"):
        AlignerBias(np.zeros((75, 2, 8)))


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
    assert with_it < 0.8 * without
