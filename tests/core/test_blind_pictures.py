"""Facts about setup pictures in which no face is found."""

import numpy as np
import pytest

from app.setup_steps import unseen
from core.blendshapes import user_blendshapes
from core.blind_pictures import Pictures, Placed, prompt_of, sort_pictures, with_guesses
from core.camera import project
from core.geometry import matrix_from_quaternion, quaternion_from_matrix, rotation_angle_rad
from core.landmarks import N_INTERNAL
from core.model_fit import LEAST_LANDMARKS, FitSettings, fit_model
from core.pipeline import build
from core.records import SetupImages
from core.setup_plan import SHOTS
from core.shape_recovery import RecoverySettings, recover_shapes
from tests.core.held_out_person import face_model, filmed, person, prompts
from tests.core.painted_head import head_picture, head_state
from tests.core.painted_user import painted_user
from tests.core.synthetic_fit import result_of
from tests.core.test_pipeline import QUICK
from tests.synthetic_face import finish

PROFILE = next(shot for shot in SHOTS if shot.name == "pose_yaw+90")
NEAR_SIDE = tuple(range(1, N_INTERNAL, 2))


def edited(truth_px, count):
    """Unseen landmarks, some of them placed by the user."""
    landmarks = unseen()
    for index in NEAR_SIDE[:count]:
        landmarks = landmarks.moved(index, *truth_px[index])
    return landmarks


@pytest.fixture(scope="module")
def film():
    """A person who turns the head, fitted."""
    film = filmed(person(1), prompts("pose"), np.random.default_rng(2))
    fit = result_of(
        fit_model(face_model(), film.camera, film.landmarks, FitSettings(), film.standard)
    )
    user = user_blendshapes(face_model(), fit)
    steps = recover_shapes(
        face_model(), user, film.camera, film.landmarks, fit, film.standard, RecoverySettings()
    )
    return film, user, Placed(tuple(film.landmarks), fit, result_of(steps))


def test_pictures_are_sorted_by_what_is_known_of_them(film):
    seen = film[0].landmarks[0]
    names = ["pose_yaw+90", "pose_yaw+0", "holiday", "beach"]
    sorting = sort_pictures(names, [unseen(), seen, seen, unseen()])
    assert (sorting.fitted, sorting.guessed, sorting.left_out) == ((1, 2), (0,), (3,))
    assert sorting.kept == (0, 1, 2)


def test_without_a_prompted_picture_that_is_fitted_nothing_is_guessed(film):
    sorting = sort_pictures(["pose_yaw+90", "holiday"], [unseen(), film[0].landmarks[0]])
    assert sorting.guessed == () and sorting.left_out == (0,)


def test_enough_points_of_the_user_make_a_profile_a_picture_like_others(film):
    truth = filmed(person(1), [PROFILE], np.random.default_rng(3)).landmarks[0].points_px
    names, seen = ["pose_yaw+90", "pose_yaw+0"], film[0].landmarks[0]
    few, enough = edited(truth, LEAST_LANDMARKS - 1), edited(truth, LEAST_LANDMARKS)
    assert sort_pictures(names, [few, seen]).guessed == (0,)
    assert sort_pictures(names, [enough, seen]).fitted == (0, 1)


def test_names_of_prompts_are_known():
    assert prompt_of("pose_yaw-90").yaw == pytest.approx(-np.pi / 2)
    assert prompt_of("frame_00001") is None


def placed_by_prompt(film, user, names, landmarks, fitted):
    """The guesses in pictures that show nothing."""
    blank = tuple(np.full((480, 640), 128, np.uint8) for _ in names)
    pictures = Pictures(tuple(names), blank, tuple(landmarks))
    return with_guesses(face_model(), user, film.camera, pictures, fitted)


def test_a_guess_stands_where_its_picture_came_and_nothing_else_moves(film):
    film, user, fitted = film
    names = [shot.name for shot in film.shots]
    names.insert(3, "pose_yaw+90")
    landmarks = [*film.landmarks[:3], unseen(), *film.landmarks[3:]]
    placed = placed_by_prompt(film, user, names, landmarks, fitted)
    others = [n for n in range(len(names)) if n != 3]
    assert np.array_equal(placed.fit.translations_mm[others], fitted.fit.translations_mm)
    assert np.array_equal(placed.shapes.points_mm[others], fitted.shapes.points_mm)
    assert all(placed.landmarks[n] is landmarks[n] for n in others)
    guess = placed.landmarks[3]
    assert not guess.confidence.any() and not guess.edited.any()
    assert np.isnan(placed.shapes.rms_px[3]) and np.isnan(placed.fit.rms_px[3])
    # Landmarks and shape are one and the same guess; the outline is not in the shape.
    inside = project(film.camera, placed.shapes.points_mm[3])[:N_INTERNAL]
    np.testing.assert_allclose(guess.points_px[:N_INTERNAL], inside, atol=1e-6)
    turned = matrix_from_quaternion(placed.fit.rotations_wxyz[3])
    asked = np.array([turned[2, 2], turned[0, 2]])
    assert abs(asked[0]) < 0.3 and abs(asked[1]) > 0.95


def test_a_guess_keeps_the_points_that_the_user_has_placed(film):
    film, user, fitted = film
    names = ["pose_yaw+90", *(shot.name for shot in film.shots)]
    before = edited(np.full((75, 2), 17.0), 5)
    landmarks = [before, *film.landmarks]
    placed = placed_by_prompt(film, user, names, landmarks, fitted).landmarks[0]
    assert np.array_equal(placed.edited, before.edited)
    assert np.array_equal(placed.confidence, np.where(before.edited, 1.0, 0.0))
    assert np.all(placed.points_px[before.edited] == 17.0)
    assert np.all(placed.points_px[~before.edited] != 17.0)


@pytest.fixture(scope="module")
def shoot():
    """Pictures of somebody who turns the head, twice as far as any aligner follows."""
    user, rng = painted_user(identity_seed=8), np.random.default_rng(9)
    shots = [*prompts("pose"), *(shot for shot in SHOTS if abs(shot.yaw) > 1.2)]
    places = rng.uniform(-15, 15, (len(shots), 3)) + [0, 0, 600]
    angles = [0.95 * np.array([shot.yaw, shot.pitch, shot.roll]) for shot in shots]
    shapes = [user.shape(place, turn) for place, turn in zip(places, angles, strict=True)]
    grays = [
        head_picture(user.model, user.blendshapes, user.camera, head_state(turn, place))
        for place, turn in zip(places, angles, strict=True)
    ]
    images = SetupImages(
        tuple(np.repeat(gray[..., None], 3, axis=2) for gray in grays),
        tuple(shot.name for shot in shots),
        np.stack([shot.standard for shot in shots]),
    )
    return user, images, shapes


def built(shoot, n_edited):
    user, images, shapes = shoot
    landmarks = [user.landmarks(shape) for shape in shapes]
    for row in (-2, -1):
        landmarks[row] = edited(landmarks[row].points_px, n_edited)
    steps = build(
        user.model, images, landmarks, user.camera.focal_px, np.random.default_rng(2), QUICK
    )
    return finish(steps)[0]


def turn_deg(found, truth_mm, mean_mm):
    """How far a rotation is from that of the true points."""
    u, _, v = np.linalg.svd((truth_mm - truth_mm.mean(axis=0)).T @ (mean_mm - mean_mm.mean(axis=0)))
    true = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return np.rad2deg(rotation_angle_rad(found, quaternion_from_matrix(true)))


def test_profiles_without_landmarks_are_kept_as_guesses(shoot):
    result = built(shoot, 0)
    user, images, shapes = shoot
    assert result.report["guessed"] == ["pose_yaw-90", "pose_yaw+90"]
    assert result.report["left_out"] == []
    assert result.images.names == images.names and len(result.landmarks) == len(images.names)
    assert result.report["pictures"] == len(images.names) - 2
    for row in (-2, -1):
        guess = result.landmarks[row]
        assert not guess.confidence.any()
        off = guess.points_px[:N_INTERNAL] - project(user.camera, shapes[row])[:N_INTERNAL]
        assert np.linalg.norm(off, axis=1).mean() < 4


def test_profiles_with_landmarks_placed_by_the_user_are_fitted_and_trained_on(shoot):
    result = built(shoot, len(NEAR_SIDE))
    user, images, shapes = shoot
    assert result.report["guessed"] == [] and result.report["left_out"] == []
    assert result.report["pictures"] == len(images.names)
    straight = user.shape()
    for row in (-2, -1):
        found = result.shapes.rotations_wxyz[row]
        assert turn_deg(found, shapes[row][:60], straight[:60]) < 6
        off = project(user.camera, result.shapes.points_mm[row]) - project(user.camera, shapes[row])
        off = off[list(NEAR_SIDE)]
        assert np.linalg.norm(off, axis=1).mean() < 2
        assert np.isfinite(result.shapes.rms_px[row])
    assert result.landmarks[-1].edited.sum() == len(NEAR_SIDE)
