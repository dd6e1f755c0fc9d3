"""Facts about training: kernels against plain code, determinism, fit to what it was shown."""

from dataclasses import replace

import numba
import numpy as np
import pytest

from core.appearance_check import residuals
from core.camera import project
from core.evaluation import frame_rmse_px
from core.geometry import matrix_from_head_angles
from core.kernels.training import best_pairs, find_leaves, grow_leaves, inverse_deviations
from core.point_drawing import PointSettings, draw_points, mean_shape
from core.regressor import Regression
from core.regressor_trainer import PAPER_SETTINGS, TrainSettings, train
from core.sampling import sample, uncovered, undisturbed
from core.training_set import TrainingSetSettings, make_training_set
from tests import naive
from tests.synthetic_face import N_POINTS, finish, make_face, small_world

TINY = TrainSettings(
    n_stages=2,
    n_ferns=6,
    n_numbers=8,
    points=PointSettings(n_points=24, n_cells=6, cell_size=8),
)


@pytest.fixture(scope="module")
def tiny_set():
    """Four pictures with all disturbances: 720 samples."""
    face = make_face(np.random.default_rng(5), (96, 72))
    shapes = face.random_shapes(4, np.random.default_rng(6))
    pictures = [face.picture(shape) for shape in shapes]
    rng = np.random.default_rng(7)
    return make_training_set(
        pictures, face.camera, shapes, rng, TrainingSetSettings(), face.triangles
    )


def same(one, other):
    pairs = zip(one.arrays().values(), other.arrays().values(), strict=True)
    return all(np.array_equal(a, b) for a, b in pairs)


@pytest.mark.nojit
def test_pair_search_agrees_with_correlating_every_difference(rng):
    intensities = rng.normal(size=(12, 300)).astype(np.float32)
    intensities[7] = intensities[3]  # a difference that is constant must not win
    targets = 0.5 * intensities[[2, 9]] - intensities[[5, 0]] + rng.normal(size=(2, 300))
    centred = intensities - intensities.mean(axis=1, keepdims=True)
    inverse = np.empty((12, 12), np.float32)
    inverse_deviations((centred @ centred.T / 300).astype(np.float32), inverse)
    covariances = np.ascontiguousarray((targets @ centred.T / 300).astype(np.float32))
    pairs = np.zeros((2, 2), np.int32)
    best_pairs(covariances, inverse, pairs)
    for target, pair in zip(targets, pairs, strict=True):
        plain, score = naive.best_pair(intensities, target)
        found = intensities[pair[0]] - intensities[pair[1]]
        assert np.corrcoef(found, target)[0, 1] == pytest.approx(score, abs=1e-4)
        assert tuple(pair) == plain


@pytest.mark.nojit
def test_leaves_are_found_as_the_live_ferns_find_them(rng):
    intensities = rng.uniform(0, 255, (10, 200)).astype(np.float32)
    pairs = rng.integers(0, 10, (5, 2)).astype(np.int32)
    places = rng.random(5).astype(np.float32)
    thresholds, leaf = np.empty(5, np.float32), np.empty(200, np.int32)
    find_leaves(intensities, pairs, places, thresholds, leaf)
    for f, (a, b) in enumerate(pairs):
        difference = intensities[a] - intensities[b]
        expected = difference.min() + places[f] * np.ptp(difference)
        assert thresholds[f] == pytest.approx(expected, rel=1e-4, abs=1e-3)
    plain = [naive.leaf_index(column, pairs, thresholds) for column in intensities.T]
    assert leaf.tolist() == plain


@pytest.mark.nojit
@pytest.mark.parametrize("shrinkage", [0.0, 250.0])
def test_leaves_are_shrunk_means_and_come_off_the_residuals(rng, shrinkage):
    residuals_before = rng.normal(size=(150, 6)).astype(np.float32)
    leaf = rng.integers(0, 7, 150).astype(np.int32)  # the eighth leaf stays empty
    left, leaves = residuals_before.copy(), np.empty((8, 6), np.float32)
    grow_leaves(leaf, shrinkage, left, np.empty(8, np.int32), leaves)
    plain = naive.shrunk_means(leaf, residuals_before, 8, shrinkage)
    assert np.allclose(leaves, plain, atol=1e-5)
    assert np.allclose(left, residuals_before - plain[leaf], atol=1e-5)
    assert np.all(leaves[7] == 0)


@pytest.mark.nojit
def test_shuffling_the_samples_leaves_the_leaf_means(rng):
    before = rng.normal(size=(150, 6)).astype(np.float32)
    leaf = rng.integers(0, 8, 150).astype(np.int32)
    order = rng.permutation(150)
    one, other = np.empty((8, 6), np.float32), np.empty((8, 6), np.float32)
    grow_leaves(leaf, 10.0, before.copy(), np.empty(8, np.int32), one)
    grow_leaves(leaf[order], 10.0, before[order], np.empty(8, np.int32), other)
    assert np.allclose(one, other, atol=1e-6)


def test_the_same_seed_gives_the_same_regressor_on_any_number_of_threads(tiny_set):
    threads = numba.get_num_threads()
    try:
        first, _ = finish(train(tiny_set, np.random.default_rng(1), TINY))
        numba.set_num_threads(1)
        second, _ = finish(train(tiny_set, np.random.default_rng(1), TINY))
    finally:
        numba.set_num_threads(threads)
    other, _ = finish(train(tiny_set, np.random.default_rng(2), TINY))
    assert same(first, second)
    assert not same(first, other)


def test_every_stage_brings_the_guesses_nearer():
    left = [step.plot["left_mm"] for step in small_world().progress]
    samples = small_world().training_set
    start = np.sqrt(np.mean(np.sum((samples.truth_mm - samples.guess_mm) ** 2, axis=2)))
    assert np.all(np.diff([start, *left]) < 0)
    assert [step.done for step in small_world().progress] == [1, 2, 3, 4]


def test_the_pictures_it_was_shown_are_fitted():
    world = small_world()
    regression = Regression(world.regressor, world.face.camera)
    samples = world.training_set
    found = [
        regression.run(image, shape + (5, 5, -10)).points_mm
        for image, shape in zip(samples.images, samples.shapes_mm, strict=True)
    ]
    camera = world.face.camera
    errors = frame_rmse_px(project(camera, np.array(found)), project(camera, samples.shapes_mm))
    assert errors.mean() < 0.35
    assert errors.max() < 0.8


def test_the_paper_form_keeps_whole_shapes_and_offsets_from_one_landmark(tiny_set):
    points = replace(PAPER_SETTINGS.points, n_points=24)
    settings = replace(PAPER_SETTINGS, n_stages=1, n_ferns=4, points=points)
    regressor, _ = finish(train(tiny_set, np.random.default_rng(1), settings))
    assert regressor.leaves.shape == (1, 4, 32, 3 * N_POINTS)
    assert np.all(regressor.weights == (1, 0, 0))
    assert np.abs(regressor.offsets_mm).max() > 1
    assert (PAPER_SETTINGS.n_stages, PAPER_SETTINGS.n_ferns, PAPER_SETTINGS.n_tests) == (10, 300, 5)
    assert (PAPER_SETTINGS.points.n_points, PAPER_SETTINGS.shrinkage) == (400, 250)


def test_points_keep_their_place_on_a_face_that_is_stretched_and_turned(rng):
    face = make_face(rng)
    shape = face.shape((0, 0, 0), (0, 0), (0, 0, 0))
    points = draw_points(shape, face.triangles, rng, PointSettings())
    places = np.einsum("pc,pcd->pd", points.weights, shape[points.corners])
    change = matrix_from_head_angles(0.5, -0.3, 1.0) @ np.diag([1.2, 0.8, 1.1])
    moved = np.einsum("pc,pcd->pd", points.weights, (shape @ change.T + 7)[points.corners])
    assert np.allclose(moved, places @ change.T + 7, atol=1e-3)
    assert np.allclose(points.weights.sum(axis=1), 1, atol=1e-5)


def test_points_stay_near_the_face(rng):
    face = make_face(rng)
    shape = face.shape((0, 0, 0), (0, 0), (0, 0, 0))
    points = draw_points(shape, face.triangles, rng, PointSettings(spread=2.0, reach=0.2))
    places = np.einsum("pc,pcd->pd", points.weights, shape[points.corners])
    radius = np.sqrt(np.mean(np.sum((shape - shape.mean(axis=0)) ** 2, axis=1)))
    gaps = np.sqrt(((places[:, None] - shape) ** 2).sum(axis=2)).min(axis=1)
    outside = points.weights.min(axis=1) < 0
    assert gaps[outside].max() < 0.2 * radius
    assert len(places) == PointSettings().n_points


def test_the_mean_shape_does_not_shrink_when_heads_turn(rng):
    face = make_face(rng)
    shape = face.shape((0, 0, 0), (0.5, 0.5), (0, 0, 600))
    turned = [face.shape((yaw, 0, 0), (0.5, 0.5), (9, 0, 600)) for yaw in (-0.8, 0.0, 0.8)]
    mean = mean_shape(np.array(turned))
    assert np.allclose(mean, shape - shape.mean(axis=0), atol=1e-6)


@pytest.mark.nojit
def test_contrast_normalisation_takes_gain_and_gradient_out(tiny_set):
    """The exposure of a sample changes its grey levels much, its normalised appearance little."""
    shape = mean_shape(tiny_set.shapes_mm)
    points = draw_points(shape, tiny_set.triangles, np.random.default_rng(3), PointSettings())
    calm = undisturbed(tiny_set)
    dark = replace(
        calm,
        augmentation=replace(
            calm.augmentation,
            exposure=np.tile([0.5, 1.0, 0.1, 0.0], (len(calm.image), 1)),
        ),
    )

    def change(softening):
        before, after = (sample(s, s.truth_mm, points, softening) for s in (calm, dark))
        return np.abs(after - before).mean() / before.std()

    assert change(0.0) > 1.0
    assert change(6.0) < 0.25


@pytest.mark.nojit
def test_an_occluder_and_a_lamp_change_what_is_sampled(tiny_set):
    shape = mean_shape(tiny_set.shapes_mm)
    points = draw_points(shape, tiny_set.triangles, np.random.default_rng(3), PointSettings())
    calm = undisturbed(tiny_set)
    n = len(calm.image)

    def sampled(**changed):
        disturbed = replace(calm, augmentation=replace(calm.augmentation, **changed))
        return sample(disturbed, disturbed.truth_mm, points, 0.0)

    plain = sampled()
    black = sampled(occluder=np.tile([0, 0, 9, 9, 1, 0, 0, 0, 0, 0.0], (n, 1)))
    assert np.all(black == 0)
    half = sampled(occluder=np.tile([9, 0, 9, 50, 1, 0, 0, 0, 0, 0.0], (n, 1)))
    assert 0.3 < np.mean(half == 0) < 0.7
    frontal = sampled(lamp=np.tile([0, 0, -1, 0.2, 0.8], (n, 1)))
    away = sampled(lamp=np.tile([0, 0, 1, 0.2, 0.8], (n, 1)))
    assert np.allclose(away, 0.2 * plain, atol=0.1)
    assert np.all(frontal <= plain + 0.1)
    assert frontal.mean() > 0.7 * plain.mean()


@pytest.mark.nojit
def test_the_check_measures_the_distance_from_the_linear_model(rng):
    basis = np.linalg.qr(rng.normal(size=(20, 3)))[0].T.astype(np.float32)
    mean = rng.normal(size=20).astype(np.float32)
    inside = mean + rng.normal(size=(5, 3)).astype(np.float32) @ basis
    outside = np.linalg.qr(np.vstack([basis, rng.normal(size=(1, 20))]).T)[0].T[3]
    away = (inside + 2 * outside).astype(np.float32)
    assert np.allclose(residuals(inside, mean, basis), 0, atol=1e-3)
    assert np.allclose(residuals(away, mean, basis), 2 / np.sqrt(20), atol=1e-3)


@pytest.mark.nojit
def test_uncovered_samples_are_lit_but_not_hidden(tiny_set):
    first = uncovered(tiny_set, 50)
    assert np.array_equal(first.image, tiny_set.image[:50])
    assert np.array_equal(first.augmentation.lamp, tiny_set.augmentation.lamp[:50])
    assert np.all(first.augmentation.occluder == 0)
