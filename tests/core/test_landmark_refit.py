"""Facts about the model putting right what the user has not placed."""

import numpy as np
import pytest

from core.landmark_edit import N_POINTS, as_hidden, hidden, shifted
from core.landmark_refit import Refitter
from core.records import Landmarks2D
from tests.core.held_out_person import face_model, filmed, person, prompts

UNKNOWN = np.full(46, np.nan)


@pytest.fixture(scope="module")
def film():
    shots = prompts("pose_yaw-30", "smile_yaw+0", "mouth_stretch_yaw+30")
    return filmed(person(0), shots, np.random.default_rng(1), noise_px=0.0)


@pytest.fixture(scope="module")
def refitter(film):
    return Refitter(face_model(), film.user, film.camera)


def spoiled(landmarks):
    """Landmarks of a face that the aligner saw too small and in the wrong place."""
    return Landmarks2D(
        0.85 * landmarks.points_px + [60, 45], landmarks.edited, landmarks.confidence,
        0.85 * landmarks.pupils_px + [60, 45], 0 * landmarks.pupil_confidence,
    )  # fmt: skip


def with_placed(wrong, right, chosen):
    shifts = np.zeros((N_POINTS, 2))
    shifts[chosen] = right.points_px[chosen] - wrong.points_px[chosen]
    return shifted(wrong, shifts)


def error_px(found, truth):
    return np.linalg.norm(found.points_px - truth.points_px, axis=1)[:60].mean()


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_dozen_placed_points_put_the_others_right(film, refitter, number):
    truth, wrong = film.landmarks[number], spoiled(film.landmarks[number])
    chosen = [0, 1, 12, 13, 20, 21, 32, 33, 40, 41, 44, 45]
    placed = with_placed(wrong, truth, chosen)
    refit = refitter.refit(placed, UNKNOWN)
    assert np.array_equal(refit.points_px[chosen], placed.points_px[chosen])
    assert error_px(wrong, truth) > 6
    assert error_px(refit, truth) < 1.5
    assert refit.edited.sum() == len(chosen)


def test_good_landmarks_stay_where_they_are(film, refitter):
    assert error_px(refitter.refit(film.landmarks[1], UNKNOWN), film.landmarks[1]) < 1.0


def test_the_fitted_model_is_drawn_over_good_landmarks(film, refitter):
    points = refitter.model_points(film.landmarks[0], UNKNOWN)
    distance = np.linalg.norm(points - film.landmarks[0].points_px, axis=1)
    assert distance[:60].mean() < 1.0


def test_the_fitted_mesh_goes_through_its_landmarks_and_shows_its_front(film, refitter):
    fitted = refitter.fitted(film.landmarks[1], UNKNOWN)
    vertices = face_model().landmark_vertices
    assert np.allclose(fitted.mesh_px[vertices], fitted.points_px[:60], atol=0.01)
    shown = np.unique(fitted.edges)
    assert 0.3 < len(shown) / len(fitted.mesh_px) < 0.75
    assert vertices[32] in shown


def test_hidden_points_stay_hidden_and_do_not_pull(film, refitter):
    truth = film.landmarks[1]
    far = with_placed(truth, spoiled(truth), [44, 45, 40, 41, 42, 43])
    gone = as_hidden(far, [44, 45, 40, 41, 42, 43])
    refit = refitter.refit(gone, UNKNOWN)
    assert hidden(refit)[[44, 45, 40, 41, 42, 43]].all()
    seen = [index for index in range(60) if not hidden(gone)[index]]
    distance = np.linalg.norm(refit.points_px - truth.points_px, axis=1)[seen]
    assert distance.mean() < 1.0


def test_a_picture_of_which_nothing_is_known_gives_way_to_a_few_points(film, refitter):
    truth = film.landmarks[0]
    wrong = spoiled(truth)
    guessed = Landmarks2D(wrong.points_px, wrong.edited, np.zeros(75), wrong.pupils_px, np.zeros(2))
    placed = with_placed(guessed, truth, [0, 1, 12, 13, 28, 32, 44, 45, 41])
    assert error_px(refitter.refit(placed, UNKNOWN), truth) < 2.0
