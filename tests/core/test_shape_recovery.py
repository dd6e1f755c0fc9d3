"""Facts about the 3D shapes of pictures."""

from dataclasses import replace

import numpy as np
import pytest

from core.arkit import mirror_permutation
from core.geometry import matrix_from_quaternion, rotation_vector_from_matrix
from core.landmarks import MIRROR, N_INTERNAL, SHAPE_MIRROR
from core.model_fit import FewLandmarksError
from core.records import Landmarks2D, ModelFit, UserBlendshapes
from core.shape_recovery import (
    RecoverySettings,
    recover_one,
    recover_shapes,
    standard_from_fit,
)
from tests.core.held_out_person import face_model, filmed, person, prompts
from tests.core.synthetic_fit import result_of

SETTINGS = RecoverySettings()


@pytest.fixture(scope="module")
def film():
    shots = prompts("pose_yaw", "pose_pitch", "smile", "mouth_stretch", "eyes_closed", "lip_f")
    return filmed(person(0), shots, np.random.default_rng(1))


def one_of(film, number):
    return recover_one(face_model(), film.user, film.camera, film.landmarks[number], SETTINGS)


def fit_at_truth(film):
    """A fit that found the truth but no expressions."""
    n = len(film.landmarks)
    quaternions = [one_of(film, i).rotations_wxyz[0] for i in range(n)]
    return ModelFit(
        film.user.identity, np.zeros((n, 46)), quaternions, film.state.translations_mm,
        np.zeros((n, 75)), np.zeros(n),
    )  # fmt: skip


def test_one_picture_gives_pose_points_and_expression(film):
    for number, truth in enumerate(film.state.expressions):
        shape = one_of(film, number)
        turn = matrix_from_quaternion(shape.rotations_wxyz[0]) @ film.state.rotations[number].T
        assert np.rad2deg(np.linalg.norm(rotation_vector_from_matrix(turn))) < 2.5
        assert np.linalg.norm(shape.translations_mm[0] - film.state.translations_mm[number]) < 15
        assert np.abs(shape.coefficients[0] - truth).mean() < 0.04
        error = shape.points_mm[0, :N_INTERNAL] - film.points_mm[number, :N_INTERNAL]
        assert np.abs(error[:, :2]).mean() < 0.8
        assert shape.rms_px[0] < 1.5


def test_rows_after_the_internal_landmarks_are_replacements_and_pupils(film):
    shape = one_of(film, 3)
    truth = film.points_mm[3, film.face.replacements]
    depth = shape.translations_mm[0, 2] - film.state.translations_mm[3, 2]
    np.testing.assert_allclose(shape.points_mm[0, 60:75] - [0, 0, depth], truth, atol=4.0)
    np.testing.assert_allclose(shape.points_mm[0, 75:] - [0, 0, depth], film.pupils_mm[3], atol=3.0)


def test_an_unseen_pupil_looks_straight_ahead(film):
    hidden = replace(film.landmarks[3], pupil_confidence=np.zeros(2), pupils_px=np.zeros((2, 2)))
    shape = recover_one(face_model(), film.user, film.camera, hidden, SETTINGS)
    depth = shape.translations_mm[0, 2] - film.state.translations_mm[3, 2]
    np.testing.assert_allclose(shape.points_mm[0, 75:] - [0, 0, depth], film.pupils_mm[3], atol=3.0)


def test_a_prompt_draws_the_coefficients_to_it(film):
    fit = fit_at_truth(film)
    free = np.full_like(film.standard, np.nan)
    recovered = [
        result_of(
            recover_shapes(
                face_model(), film.user, film.camera, film.landmarks, fit, standard, SETTINGS
            )
        ).coefficients
        for standard in (film.standard, free)
    ]
    to_prompt = [np.abs(found - film.standard).mean() for found in recovered]
    assert to_prompt[0] < to_prompt[1]
    assert np.abs(recovered[0] - film.state.expressions).mean() < 0.03


def test_pictures_without_a_prompt_take_the_coefficients_of_the_fit():
    fit = ModelFit(
        np.zeros(3), np.full((2, 46), 0.3), np.tile([1.0, 0, 0, 0], (2, 1)), np.zeros((2, 3)),
        np.zeros((2, 75)), np.zeros(2),
    )  # fmt: skip
    np.testing.assert_array_equal(standard_from_fit(fit), fit.expressions)


def test_a_mirrored_picture_gives_the_mirrored_shape(film):
    model = face_model()
    neutral = film.user.neutral_mm
    symmetric = 0.5 * (neutral + neutral[model.mirror_vertices] * [-1, 1, 1])
    order = mirror_permutation()
    deltas = film.user.deltas_mm
    mirrored = deltas[order][:, model.mirror_vertices] * np.array([-1, 1, 1], np.float32)
    user = UserBlendshapes(film.user.identity, symmetric, 0.5 * (deltas + mirrored))
    landmarks = film.landmarks[1]
    width = film.camera.size_px[0] - 1
    flipped = Landmarks2D(
        landmarks.points_px[MIRROR] * [-1, 1] + [width, 0], landmarks.edited,
        landmarks.confidence, landmarks.pupils_px[::-1] * [-1, 1] + [width, 0],
        landmarks.pupil_confidence,
    )  # fmt: skip
    here = recover_one(model, user, film.camera, landmarks, SETTINGS)
    there = recover_one(model, user, film.camera, flipped, SETTINGS)
    expected = here.points_mm[0][SHAPE_MIRROR] * [-1, 1, 1]
    np.testing.assert_allclose(there.points_mm[0], expected, atol=0.3)
    np.testing.assert_allclose(there.coefficients[0], here.coefficients[0][order], atol=0.02)


def test_a_picture_without_trusted_landmarks_is_refused(film):
    blind = replace(film.landmarks[0], confidence=np.zeros(75))
    with pytest.raises(FewLandmarksError, match="0 trusted landmarks"):
        recover_one(face_model(), film.user, film.camera, blind, SETTINGS)
