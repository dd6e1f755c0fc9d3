"""Facts about the training-free mode on the pictures kept for testing."""

from dataclasses import replace

import numpy as np
import pytest

from core.free_comparison import free_report
from core.geometry import quaternion_from_matrix
from core.held_out_pairs import Measured
from core.landmarks import N_INTERNAL
from core.records import SetupShapes
from core.setup_plan import SHOTS
from tests.core.held_out_person import face_model as model
from tests.core.held_out_person import filmed, person
from tests.core.synthetic_fit import result_of

FACES = ("neutral", "smile", "mouth_stretch", "brow_raise", "jaw_left", "anger")


@pytest.fixture(scope="module")
def film():
    shots = [s for s in SHOTS if s.expression_name in FACES and abs(s.yaw) < 0.6]
    return filmed(person(1), shots, np.random.default_rng(4), noise_px=0.4)


@pytest.fixture(scope="module")
def pictures(film):
    """The true shapes of the film's pictures."""
    state, face = film.state, film.face
    points = np.concatenate(
        [film.points_mm[:, :N_INTERNAL], film.points_mm[:, face.replacements], film.pupils_mm],
        axis=1,
    )
    turns = np.stack([quaternion_from_matrix(one) for one in state.rotations])
    n = len(points)
    shapes = SetupShapes(points, turns, state.translations_mm, state.expressions, np.zeros(n))
    return Measured(tuple(shot.name for shot in film.shots), (), film.camera, shapes)


@pytest.fixture(scope="module")
def told(film, pictures):
    return result_of(free_report(model(), pictures, film.landmarks, 5))


def test_the_person_s_face_is_learned_and_helps(told):
    first, later = told["at_first"], told["later"]
    assert first["lost"] == later["lost"] == 0
    assert later["mean_rmse_px"] < 0.8 * first["mean_rmse_px"]
    assert sum(later["mean_turn_deg"].values()) < sum(first["mean_turn_deg"].values())
    assert later["mean_rmse_px"] < 3.0


def test_the_same_pictures_are_told_by_yaw_and_expression(told):
    faces = told["later"]["by_expression"]
    assert set(faces) == set(FACES)
    assert sum(one["tries"] for one in faces.values()) == told["later"]["pictures"]
    assert sum(one["tries"] for one in told["later"]["by_yaw"].values()) == sum(
        one["tries"] for one in faces.values()
    )


def test_a_picture_without_a_face_is_told_as_lost(film, pictures):
    row = next(n for n, name in enumerate(pictures.names) if name == "mouth_stretch_yaw+0")
    found = list(film.landmarks)
    found[row] = replace(found[row], confidence=np.zeros(75))
    told = result_of(free_report(model(), pictures, found, 5))
    assert told["at_first"]["lost"] == told["later"]["lost"] == 1
    assert "mouth_stretch" not in told["later"]["by_expression"]


def test_errors_are_those_of_the_aligner_s_landmarks_not_of_corrected_ones(film, pictures, told):
    """Landmarks found 10 px aside make the training-free face lie 10 px aside."""
    aside = [replace(one, points_px=one.points_px + [10.0, 0.0]) for one in film.landmarks]
    moved = result_of(free_report(model(), pictures, aside, 5))
    assert 8 < moved["later"]["mean_rmse_px"] < 13
