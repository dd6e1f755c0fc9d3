"""Facts about making a profile from pictures with landmarks."""

import json
from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.calibration import CalibrationSettings
from core.camera import project
from core.held_out_pairs import HeldOutSettings
from core.landmarks import N_INTERNAL, N_LANDMARKS
from core.model_fit import LEAST_LANDMARKS, FitSettings
from core.pipeline import (
    LABELS,
    LEAST_PICTURES,
    BuildSettings,
    FewPicturesError,
    build,
    gray_from_rgb,
    known_focal,
    stage_shares,
    usable_pictures,
)
from core.records import SetupImages
from core.regressor import Regression
from tests.core.painted_user import CALM, painted_user
from tests.synthetic_face import SMALL, finish

N_PICTURES = 14
QUICK = BuildSettings(
    fit=FitSettings(rounds=2, steps=4),
    calibration=CalibrationSettings(
        fit=FitSettings(noise_mm=1.0, contour_weight=0.02, rounds=2, steps=4), evaluations=5,
        steps=3,
    ),
    training_set=CALM,
    train=SMALL,
    held_out=HeldOutSettings(starts=2),
)  # fmt: skip


@pytest.fixture(scope="module")
def setup():
    """Pictures of somebody who turns the head; in one of them hardly anything is seen."""
    user, rng = painted_user(identity_seed=8), np.random.default_rng(9)
    yaws = np.linspace(-0.6, 0.6, N_PICTURES)
    shapes = [
        user.shape((*rng.uniform(-15, 15, 2), 600), (yaw, *rng.uniform(-0.2, 0.2, 2)))
        for yaw in yaws
    ]
    frames = [user.frame(shape, 0.0) for shape in shapes]
    names = tuple(f"frame_{n:05d}" for n in range(N_PICTURES))
    images = SetupImages(
        tuple(frame.rgb for frame in frames), names, np.full((N_PICTURES, 46), np.nan)
    )
    landmarks = [user.landmarks(shape) for shape in shapes]
    landmarks[4] = with_trusted(landmarks[4], LEAST_LANDMARKS - 1)
    return user, images, landmarks, shapes


def with_trusted(landmarks, n_trusted):
    """The landmarks, only so many of them trusted."""
    confidence = np.where(np.arange(N_LANDMARKS) < n_trusted, 0.9, 0.2)
    return replace(landmarks, confidence=confidence)


def built_from(setup, focal_px):
    user, images, landmarks, _ = setup
    rng = np.random.default_rng(2)
    return finish(build(user.model, images, landmarks, focal_px, rng, QUICK))


@pytest.fixture(scope="module")
def searched(setup):
    return built_from(setup, None)


@pytest.fixture(scope="module")
def given(setup):
    return built_from(setup, setup[0].camera.focal_px)


def test_grey_levels_are_opencvs_luma(rng):
    corners = np.array(np.meshgrid([0, 255], [0, 255], [0, 255])).T.reshape(1, -1, 3)
    rgb = np.concatenate([rng.integers(0, 256, (1, 5000, 3)), corners], axis=1).astype(np.uint8)
    gray = gray_from_rgb(rgb)
    assert gray.dtype == np.uint8 and gray.shape == (1, 5008)
    luma = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    assert np.abs(gray.astype(int) - luma).max() <= 1
    assert gray_from_rgb(np.full((2, 2, 3), 255, np.uint8)).max() == 255


def test_pictures_with_too_few_trusted_landmarks_are_left_out_by_name(setup):
    _, images, landmarks, _ = setup
    kept, kept_landmarks, sorting = usable_pictures(images, landmarks)
    assert sorting.left_out == (4,) and sorting.guessed == ()
    assert kept.names == tuple(name for name in images.names if name != "frame_00004")
    others = [n for n in range(N_PICTURES) if n != 4]
    assert all(kept.images[k] is images.images[n] for k, n in enumerate(others))
    assert all(kept_landmarks[k] is landmarks[n] for k, n in enumerate(others))
    assert kept.standard.shape == (N_PICTURES - 1, 46)


def test_just_enough_trusted_landmarks_are_enough(setup):
    _, images, landmarks, _ = setup
    enough = [with_trusted(one, LEAST_LANDMARKS) for one in landmarks]
    assert usable_pictures(images, enough)[2].fitted == tuple(range(N_PICTURES))


def test_the_contour_does_not_help_a_picture_without_a_face(setup):
    _, images, landmarks, _ = setup
    contour = np.where(np.arange(N_LANDMARKS) < N_INTERNAL, 0.0, 1.0)
    landmarks = [replace(landmarks[0], confidence=contour), *landmarks[1:]]
    assert usable_pictures(images, landmarks)[2].left_out == (0, 4)


def test_says_how_many_pictures_are_usable_and_what_to_do(setup):
    user, images, landmarks, _ = setup
    poor = [with_trusted(one, 3) for one in landmarks[:5]] + landmarks[5:]
    assert len(poor) - 5 == LEAST_PICTURES - 1
    text = r"9 of 14 setup pictures .* at least 10 are needed: add pictures"
    with pytest.raises(FewPicturesError, match=text) as caught:
        finish(build(user.model, images, poor, None, np.random.default_rng(0), QUICK))
    assert (caught.value.usable, caught.value.given) == (9, 14)


@pytest.mark.parametrize("which", ["searched", "given"])
def test_progress_never_goes_back_and_reaches_the_end(which, request):
    _, progress = request.getfixturevalue(which)
    done = [one.done for one in progress]
    assert done[0] == 0 and done == sorted(done) and done[-1] == progress[-1].total
    assert {one.total for one in progress} == {1000}
    assert max(np.diff(done)) < 350


def test_progress_tells_the_stages_in_order(searched, given):
    labels = list(dict.fromkeys(one.label for one in searched[1]))
    assert labels == list(LABELS.values())
    assert list(dict.fromkeys(one.label for one in given[1])) == labels[1:]


def test_the_search_shows_focal_lengths_to_plot(searched):
    shown = [one.plot for one in searched[1] if "focal_px" in one.plot]
    curve = searched[0].report["focal_curve"]
    assert np.allclose(sorted([one["focal_px"], one["error"]] for one in shown), curve)


def test_a_known_focal_length_is_kept_and_said_to_be_given(setup, given):
    user, *_ = setup
    built, _ = given
    assert built.camera.focal_px == user.camera.focal_px == built.report["focal_px"]
    assert built.camera.size_px == (240, 180) and built.report["size_px"] == [240, 180]
    assert built.report["focal_source"] == "given"
    assert built.report["focal_curve"] == [] and built.report["focal_spread_percent"] == 0
    assert known_focal((240, 180), 300.0).camera.focal_px == 300.0


def test_an_unknown_focal_length_is_searched(searched):
    built, _ = searched
    assert built.report["focal_source"] == "found"
    focals, errors = np.transpose(built.report["focal_curve"])
    assert len(focals) >= 6 and np.all(np.diff(focals) > 0)
    assert built.report["focal_spread_percent"] > 0
    near = np.abs(np.log(focals / built.camera.focal_px))
    assert near[errors.argmin()] < 0.3


def test_shapes_of_exact_landmarks_are_the_true_ones(setup, given):
    *_, shapes = setup
    built, _ = given
    truth = np.array([shape for n, shape in enumerate(shapes) if n != 4])
    found = built.shapes.points_mm
    assert found.shape == truth.shape
    # Depth as a whole is traded for size; the shape itself and its place are not.
    centred = [points - points.mean(axis=1, keepdims=True) for points in (found, truth)]
    off = np.linalg.norm(centred[0] - centred[1], axis=2)[:, :N_INTERNAL]
    assert np.sqrt(np.mean(off**2)) < 3.0
    assert built.report["shape_rms_px_at_640"] < 1.5
    assert built.report["fit_rms_px_at_640"] < 1.5


def test_the_regressor_finds_the_shapes_of_the_pictures_it_was_trained_on(given):
    built, _ = given
    regression = Regression(built.regressor, built.camera)
    for image, shape in zip(built.images.images[::4], built.shapes.points_mm[::4], strict=True):
        start = shape + [7, -6, 5]
        found = regression.run(gray_from_rgb(image), start).points_mm
        before, after = (distance_px(built.camera, points, shape) for points in (start, found))
        assert after < 0.3 * before


def distance_px(camera, a_mm, b_mm):
    return np.linalg.norm(project(camera, a_mm) - project(camera, b_mm), axis=1).mean()


def test_the_report_is_plain_and_names_the_pictures(setup, given):
    _, images, *_ = setup
    report = given[0].report
    assert json.loads(json.dumps(report)) == report
    assert report["left_out"] == ["frame_00004"] and report["guessed"] == []
    assert report["pictures"] == N_PICTURES - 1
    assert report["picture_names"] == [name for name in images.names if name != "frame_00004"]
    errors = np.array(report["picture_rms_px_at_640"])
    assert report["shape_rms_px_at_640"] == pytest.approx(np.sqrt(np.mean(errors**2)))
    assert report["held_out"]["pictures"] == len(range(2, N_PICTURES - 1, 5))


def test_the_report_tells_the_error_after_each_stage_and_what_will_be_weak(given):
    report = given[0].report
    shown = [one.plot for one in given[1] if "stage" in one.plot]
    for key, told in (report["held_out"]["stages"] | report["stages"]).items():
        assert told == [plot[key] for plot in shown if key in plot]
        assert len(told) == 1 + SMALL.n_stages and told[-1] < told[0]
    assert set(report["stages"]) == {"all_px"}
    weak = {one["name"] for one in report["weak_expressions"]}
    # Nothing was prompted, so nothing that landmarks tell is missing for want of a prompt alone.
    assert "cheekPuff" in weak


def test_the_stages_and_their_shares_are_those_of_the_work():
    for known in (False, True):
        shares = stage_shares(known)
        assert list(shares) == list(LABELS.values())[known:]
        assert sum(shares.values()) == pytest.approx(1)
