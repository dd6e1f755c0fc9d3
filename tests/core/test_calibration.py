"""Facts about the search for the focal length."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from app.performer.opening import FOCAL_LENGTHS_PX, PEOPLE
from core.calibration import (
    Before,
    CalibrationSettings,
    ChessboardError,
    calibrate,
    chessboard_camera,
    estimate_focal,
)
from core.camera import camera_for, project
from core.focal_search import FocalNotBracketedError, search_focal, smooth_minimum
from core.geometry import matrix_from_head_angles
from core.model_fit import FewLandmarksError, fit_model
from core.setup_plan import SHOTS
from tests.benchmarks.focal_length import found_from_exact
from tests.core.held_out_person import face_model, filmed, person, prompts
from tests.core.synthetic_fit import result_of


@pytest.mark.parametrize("truth_px", [350.0, 610.0, 1500.0])
def test_finds_the_least_error(truth_px):
    found = result_of(search_focal(lambda f: np.log(f / truth_px) ** 2, 300, 3000))
    assert found == pytest.approx(truth_px, rel=1e-3)


def test_one_evaluation_a_step():
    asked = []

    def error(focal_px):
        asked.append(focal_px)
        return (focal_px - 700) ** 2

    progress = list(search_focal(error, 300, 3000, steps=8))
    assert len(asked) == len(set(asked)) == len(progress) == 10
    assert [one.done for one in progress] == list(range(1, 11))
    assert progress[-1].total == 10
    assert progress[3].plot["focal_px"] == pytest.approx(asked[3])


def test_says_which_end_is_too_tight():
    with pytest.raises(FocalNotBracketedError, match="widen the interval") as caught:
        result_of(search_focal(lambda f: f, 300.0, 3000.0))
    assert caught.value.best_px == pytest.approx(300.0, rel=1e-3)
    with pytest.raises(FocalNotBracketedError, match=r"\[300, 3000\]"):
        result_of(search_focal(lambda f: -f, 300.0, 3000.0))


def test_the_minimum_of_a_parabola_and_its_spread():
    places = np.linspace(-0.2, 0.2, 9)
    place, spread = smooth_minimum(places, ((places - 0.01) / 0.05) ** 2 + 7, 0.0)
    assert place == pytest.approx(0.01, abs=1e-4) and spread == pytest.approx(0.05)


def test_errors_that_rise_faster_on_one_side_do_not_shift_the_minimum():
    places = np.array([-0.24, -0.15, -0.08, -0.03, 0.0, 0.02, 0.05, 0.12, 0.2])
    # What depends on 1 / f, as perspective does.
    errors = ((np.exp(-(places - 0.01)) - 1) / 0.05) ** 2
    place, spread = smooth_minimum(places, errors, 0.0)
    assert place == pytest.approx(0.01, abs=2e-3) and spread == pytest.approx(0.05, rel=0.1)
    parabola = np.polyfit(places, errors, 2)
    assert abs(-0.5 * parabola[1] / parabola[0] - 0.01) > 4e-3


def test_errors_that_do_not_curve_up_leave_the_best_as_it_is():
    places = np.linspace(-0.2, 0.2, 9)
    assert smooth_minimum(places, -(places**2), 0.1) == (0.1, 0.25)
    assert smooth_minimum(places[:4], places[:4] ** 2, 0.1) == (0.1, 0.25)


def board_picture(camera, rotation, translation, squares=(8, 6), size_mm=25.0):
    """A picture of a chessboard, each pixel the average of 3 x 3 rays."""
    width, height = camera.size_px
    fine = 3
    v, u = np.mgrid[: height * fine, : width * fine]
    pixels = np.stack([(u + 0.5) / fine - 0.5, (v + 0.5) / fine - 0.5], axis=-1)
    rays = np.concatenate(
        [(pixels - camera.center_px) / camera.focal_px, np.ones((*u.shape, 1))], axis=-1
    )
    depth = (translation @ rotation[:, 2]) / (rays @ rotation[:, 2])
    place = (rays * depth[..., None] - translation) @ rotation[:, :2] / size_mm
    cells = np.floor(place).astype(int)
    on_board = np.all((cells >= 0) & (cells < squares), axis=-1)
    dark = on_board & (cells.sum(axis=-1) % 2 == 0)
    picture = np.where(dark, 20.0, 230.0).reshape(height, fine, width, fine).mean(axis=(1, 3))
    return picture.astype(np.uint8)


@pytest.mark.parametrize("focal_px", [300.0, 420.0])
def test_chessboard_pictures_give_the_focal_length(focal_px):
    camera = camera_for((320, 240), focal_px)
    poses = [(0.5, 0.0, 0.1), (-0.5, 0.2, 0.0), (0.1, 0.5, -0.1), (0.0, -0.5, 0.2)]
    pictures = []
    for angles in poses:
        rotation = matrix_from_head_angles(*angles)
        middle = np.array([100.0, 75.0, 0.0])
        pictures.append(board_picture(camera, rotation, [0, 0, focal_px] - rotation @ middle))
    found = chessboard_camera(pictures, (7, 5))
    assert found.focal_px == pytest.approx(focal_px, rel=0.01)
    np.testing.assert_allclose(found.center_px, camera.center_px)
    colour = [cv2.cvtColor(one, cv2.COLOR_GRAY2RGB) for one in pictures]
    assert chessboard_camera(colour, (7, 5)).focal_px == pytest.approx(found.focal_px)


def test_says_how_many_boards_were_seen():
    blank = np.full((240, 320), 128, np.uint8)
    with pytest.raises(ChessboardError, match="7 x 5 inner corners in 0 pictures") as caught:
        chessboard_camera([blank, blank], (7, 5))
    assert caught.value.found == 0


def test_the_board_picture_of_these_tests_is_where_it_should_be():
    camera = camera_for((320, 240), 300.0)
    rotation, translation = np.eye(3), np.array([-100.0, -75.0, 300.0])
    corner = project(camera, translation + np.array([25.0, 25.0, 0.0]))
    picture = board_picture(camera, rotation, translation)
    x, y = np.round(corner).astype(int)
    # First square is dark, its right neighbour light.
    assert picture[y - 5, x - 5] == 20 and picture[y - 5, x + 5] == 230


def estimate_of(film, standard):
    steps = estimate_focal(
        face_model(), film.camera.size_px, film.landmarks, standard, CalibrationSettings()
    )
    return result_of(steps)


@pytest.mark.slow
@pytest.mark.parametrize("focal_px", [450.0, 600.0, 900.0])
def test_the_prompts_give_the_focal_length_of_a_person_outside_the_model(focal_px):
    shots = [shot for shot in SHOTS if abs(shot.yaw) < 1.2]
    film = filmed(person(0), shots, np.random.default_rng(0), focal_px, noise_px=0.5)
    found = estimate_of(film, film.standard)
    assert found.camera.focal_px == pytest.approx(focal_px, rel=0.02)
    assert found.errors[0] > found.errors.min() + 4 and found.errors[-1] > found.errors.min() + 4


def test_turned_heads_tell_a_wide_lens_from_a_narrow_one():
    shots = prompts("pose")
    found = [
        estimate_of(film, film.standard).camera.focal_px / film.camera.focal_px
        for film in (
            filmed(person(1), shots, np.random.default_rng(1), focal_px) for focal_px in (450, 800)
        )
    ]
    np.testing.assert_allclose(found, 1.0, atol=0.12)


def test_frontal_pictures_of_a_plain_video_give_a_usual_webcam_and_say_how_unsure_that_is():
    shots = [shot for shot in SHOTS if not (shot.yaw or shot.pitch or shot.roll)][:8]
    film = filmed(person(2), shots, np.random.default_rng(2), focal_px=700.0)
    found = estimate_of(film, None)
    assert abs(np.log(found.camera.focal_px / (0.87 * 640))) < 0.35
    assert found.spread > 0.1


def test_calibration_counts_its_steps_and_returns_the_camera():
    film = filmed(person(0), prompts("pose_yaw")[1:4], np.random.default_rng(3))
    steps = calibrate(
        face_model(), (640, 480), film.landmarks, film.standard, CalibrationSettings(evaluations=3)
    )
    seen = []
    while True:
        try:
            seen.append(next(steps))
        except StopIteration as end:
            camera = end.value
            break
    assert [one.done for one in seen] == list(range(1, len(seen) + 1))
    assert {one.total for one in seen} == {len(seen)}
    assert camera.size_px == (640, 480)
    np.testing.assert_allclose(camera.center_px, [319.5, 239.5])


def test_calibration_refuses_a_picture_without_landmarks():
    film = filmed(person(0), prompts("pose_yaw")[:2], np.random.default_rng(4))
    blind = [film.landmarks[0], replace(film.landmarks[1], confidence=np.zeros(75))]
    with pytest.raises(FewLandmarksError, match="picture 1"):
        result_of(calibrate(face_model(), (640, 480), blind, None, CalibrationSettings()))


@pytest.mark.slow
@pytest.mark.parametrize("name", PEOPLE)
@pytest.mark.parametrize("focal_px", FOCAL_LENGTHS_PX)
def test_true_landmarks_give_the_focal_length_of_every_virtual_performer(name, focal_px):
    found = found_from_exact(face_model(), name, focal_px, noise_px=0.0)
    assert found == pytest.approx(focal_px, rel=0.02)


def test_errors_count_in_full_where_the_user_placed_the_landmarks():
    film = filmed(person(0), prompts("pose_yaw")[1:4], np.random.default_rng(3))
    settings = CalibrationSettings(evaluations=3, dispersion=4.0, usual_spread=100.0)
    found = [
        result_of(estimate_focal(face_model(), (640, 480), landmarks, film.standard, settings))
        for landmarks in (
            film.landmarks, [replace(one, edited=np.ones(75, bool)) for one in film.landmarks]
        )
    ]  # fmt: skip
    rise = [np.ptp(one.errors) for one in found]
    assert rise[1] > 3 * rise[0]


def test_a_search_that_begins_at_an_earlier_result_is_shorter_and_finds_the_same():
    film = filmed(person(1), prompts("pose"), np.random.default_rng(1), 600.0)
    settings = CalibrationSettings()
    cold = estimate_of(film, film.standard)
    fit = result_of(
        fit_model(face_model(), cold.camera, film.landmarks, settings.fit, film.standard)
    )

    def begun_at(focal_px):
        before = Before(focal_px, fit)
        size_px = film.camera.size_px
        steps = estimate_focal(
            face_model(), size_px, film.landmarks, film.standard, settings, before
        )
        return result_of(steps)

    near = begun_at(1.08 * cold.camera.focal_px)
    assert near.camera.focal_px == pytest.approx(cold.camera.focal_px, rel=0.01)
    assert near.spread == pytest.approx(cold.spread, rel=0.2)
    assert len(near.focals_px) < 0.6 * len(cold.focals_px)
    # What was found before is of no use: everything as without it.
    far = begun_at(1.6 * cold.camera.focal_px)
    assert far.camera.focal_px == cold.camera.focal_px
    assert np.array_equal(far.errors, cold.errors)
