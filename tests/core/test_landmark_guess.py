"""Facts about landmarks of pictures in which no face is found."""

import numpy as np
import pytest

from core.blendshapes import user_blendshapes
from core.geometry import matrix_from_head_angles, matrix_from_quaternion, quaternion_from_matrix
from core.landmark_guess import PIVOT_MM, expected_pose, guess_landmarks
from core.model_fit import FewLandmarksError, FitSettings, check_landmarks, fit_model
from core.records import ModelFit
from core.setup_plan import SHOTS
from tests.core.held_out_person import face_model, filmed, person, prompts
from tests.core.synthetic_fit import result_of

PROFILE = next(shot for shot in SHOTS if shot.name == "pose_yaw+90")


def fit_with_pose(rotation, translation):
    n = len(rotation)
    return ModelFit(
        np.zeros(3), np.zeros((n, 46)), [quaternion_from_matrix(one) for one in rotation],
        translation, np.zeros((n, 75)), np.zeros(n),
    )  # fmt: skip


def test_the_pose_is_that_of_the_nearest_prompt_turned_about_the_neck():
    shots = prompts("pose_yaw")
    # The user turned 5 degrees less than asked each time.
    short = np.deg2rad(5)
    turned = [matrix_from_head_angles(s.yaw - np.sign(s.yaw) * short, 0, 0) for s in shots]
    neck = np.array([10.0, 90.0, 700.0])
    fit = fit_with_pose(turned, [neck - one @ PIVOT_MM for one in turned])
    rotation, translation = expected_pose(PROFILE, shots, fit)
    expected = matrix_from_head_angles(PROFILE.yaw - short, 0, 0)
    np.testing.assert_allclose(rotation, expected, atol=1e-9)
    np.testing.assert_allclose(rotation @ PIVOT_MM + translation, neck, atol=1e-9)


@pytest.fixture(scope="module")
def film():
    return filmed(person(1), prompts("pose"), np.random.default_rng(2))


def test_a_profile_is_guessed_near_its_truth_but_never_trusted(film):
    model = face_model()
    fit = result_of(fit_model(model, film.camera, film.landmarks, FitSettings(), film.standard))
    user = user_blendshapes(model, fit)
    truth = filmed(person(1), [PROFILE], np.random.default_rng(3), noise_px=0.0)
    guess = guess_landmarks(model, user, film.camera, PROFILE, film.shots, fit)
    # Where the head is cannot be known; its shape and turn can.
    error = guess.points_px - truth.landmarks[0].points_px
    error -= error[:60].mean(axis=0)
    face_px = np.ptp(truth.landmarks[0].points_px[:60, 1])
    assert np.linalg.norm(error[:60], axis=1).mean() < 0.1 * face_px
    assert not guess.confidence.any() and not guess.pupil_confidence.any()
    assert not guess.edited.any()
    with pytest.raises(FewLandmarksError):
        check_landmarks([guess])


def test_a_guess_that_the_user_corrects_is_fitted(film):
    model = face_model()
    fit = result_of(fit_model(model, film.camera, film.landmarks, FitSettings(), film.standard))
    user = user_blendshapes(model, fit)
    guess = guess_landmarks(model, user, film.camera, PROFILE, film.shots, fit)
    truth = filmed(person(1), [PROFILE], np.random.default_rng(3), noise_px=0.5)
    # One side of the face is all that is seen of it.
    for index in range(1, 60, 2):
        guess = guess.moved(index, *truth.landmarks[0].points_px[index])
    nearer = [*film.landmarks, guess]
    standard = np.vstack([film.standard, PROFILE.standard])
    both = result_of(fit_model(model, film.camera, nearer, FitSettings(), standard))
    found = matrix_from_quaternion(both.rotations_wxyz[-1])
    cosine = 0.5 * (np.trace(found.T @ truth.state.rotations[0]) - 1)
    assert np.rad2deg(np.arccos(np.clip(cosine, -1, 1))) < 8
    assert guess.edited.sum() == 30
