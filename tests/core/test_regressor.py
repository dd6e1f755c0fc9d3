"""Facts about applying a regressor: kernels against plain code, the whole against algorithm 2."""

import tracemalloc

import numpy as np
import pytest

from core.appearance import AppearanceReader
from core.camera import project
from core.errors import ArrayShapeError
from core.evaluation import frame_rmse_px
from core.fern_regressor import FernRegressor
from core.geometry import matrix_from_head_angles, register_rigid
from core.head_size import size_gauge
from core.kernels.ferns import add_leaves, choose_leaves, take_steps
from core.kernels.starts import (
    align_rotation,
    choose_starts,
    combine_runs,
    squared_distances,
    turned_distances,
)
from core.regressor import Regression, RegressionSettings
from core.shape_space import distinct, pairwise_rotations
from tests import naive
from tests.synthetic_face import N_POINTS, small_world

ONE_PASS = RegressionSettings(again_mm=1e9, keep_size=False)


@pytest.fixture(scope="module")
def world():
    return small_world()


@pytest.fixture(scope="module")
def unseen(world):
    """Shapes that the regressor was not trained on, and their pictures."""
    shapes = world.face.random_shapes(6, np.random.default_rng(11))
    return [(shape, world.face.picture(shape)) for shape in shapes]


def projection(camera):
    return np.array([camera.focal_px, *camera.center_px], np.float32)


def rmse_px(world, found_mm, true_mm):
    points = project(world.face.camera, found_mm), project(world.face.camera, true_mm)
    return float(frame_rmse_px(points[0][None], points[1][None])[0])


@pytest.mark.parametrize("softening", [0.0, 6.0])
def test_appearance_agrees_with_naive(world, unseen, softening):
    points = world.regressor.points(0)
    rotation, center = matrix_from_head_angles(0.1, 0.2, 0.3), np.array([5.0, -9.0, 590.0])
    shapes = np.array([shape - shape.mean(axis=0) for shape, _ in unseen])
    reader = AppearanceReader(N_POINTS, points, len(shapes))
    reader.shapes[:] = shapes
    reader.place(rotation, center)
    picture = unseen[0][1]
    read = reader.read(picture, projection(world.face.camera), softening)
    for run, shape in enumerate(shapes):
        plain = naive.appearance(
            picture, world.face.camera, points, shape, rotation, center, softening
        )
        assert np.allclose(read[:, run], plain, atol=0.1 if softening == 0 else 0.02)


def test_beyond_the_border_the_border_goes_on(world):
    points = world.regressor.points(0)
    picture = np.tile(np.linspace(10, 200, 240).astype(np.uint8), (180, 1))
    reader = AppearanceReader(N_POINTS, points, 2)
    reader.place(np.eye(3), np.array([0, 0, 600.0]))
    reader.shapes[0, :, 0], reader.shapes[1, :, 0] = -1e5, 1e5
    read = reader.read(picture, projection(world.face.camera), 0.0)
    assert np.allclose(read[:, 0], 10)
    assert np.allclose(read[:, 1], 200, atol=0.1)


@pytest.mark.nojit
@pytest.mark.parametrize(
    ("n_ferns", "n_tests", "n_runs"), [(1, 1, 1), (3, 5, 16), (40, 4, 15), (270, 5, 15)]
)
def test_ferns_agree_with_naive(n_ferns, n_tests, n_runs):
    rng = np.random.default_rng(n_ferns)
    intensities = rng.uniform(0, 255, (50, n_runs)).astype(np.float32)
    pairs = rng.integers(0, 50, (n_ferns, n_tests, 2)).astype(np.int32)
    thresholds = rng.normal(0, 60, (n_ferns, n_tests)).astype(np.float32)
    leaves = rng.integers(-127, 128, (n_ferns, 2**n_tests, 7)).astype(np.int8)
    out = fern_sums(intensities, pairs, thresholds, leaves)
    for run in range(n_runs):
        plain = naive.fern_sum(intensities[:, run], pairs, thresholds, leaves)
        assert np.array_equal(out[run], plain)


@pytest.mark.nojit
def test_difference_equal_to_threshold_goes_to_the_upper_leaf():
    leaves = np.array([[[-1], [1]]], np.int8)
    intensities = np.array([[15], [10]], np.float32)
    pairs, thresholds = np.array([[[0, 1]]], np.int32), np.array([[5]], np.float32)
    assert fern_sums(intensities, pairs, thresholds, leaves)[0, 0] == 1


@pytest.mark.nojit
def test_many_large_leaves_of_one_sign_do_not_overflow():
    leaves = np.full((700, 2, 3), -127, np.int8)
    pairs, thresholds = np.zeros((700, 1, 2), np.int32), np.zeros((700, 1), np.float32)
    out = fern_sums(np.zeros((1, 2), np.float32), pairs, thresholds, leaves)
    assert np.all(out == -127 * 700)


@pytest.mark.nojit
@pytest.mark.parametrize("n_steps", [1, 4, 7])
def test_steps_move_along_the_basis(rng, n_steps):
    taken = rng.integers(-500, 500, (3, n_steps)).astype(np.int32)
    basis = rng.normal(size=(n_steps, 9)).astype(np.float32)
    shapes = rng.normal(size=(3, 9)).astype(np.float32)
    moved = shapes.copy()
    take_steps(taken, basis, moved)
    assert np.allclose(moved, shapes + taken @ basis, atol=1e-2)


def fern_sums(intensities, pairs, thresholds, leaves):
    n_runs = intensities.shape[1]
    leaf = np.empty((len(pairs), n_runs), np.int32)
    choose_leaves(intensities, pairs, thresholds, leaf)
    out = np.ones((n_runs, leaves.shape[2]), np.int32)
    add_leaves(leaves, leaf, np.empty(out.shape, np.int16), out)
    return out


@pytest.mark.nojit
def test_rotation_agrees_with_registration_by_svd(rng):
    source = rng.normal(size=(N_POINTS, 3))
    source -= source.mean(axis=0)
    for angles in [(0, 0, 0), (0.3, -0.2, 0.1), (1.5, 0.5, -3.0)]:
        target = source @ matrix_from_head_angles(*angles).T + 0.1 * rng.normal(size=source.shape)
        target -= target.mean(axis=0)
        found = np.empty((3, 3))
        align_rotation(source, target, np.empty((3, 4, 4)), found)
        assert np.allclose(found, register_rigid(source, target)[0], atol=1e-9)


def test_pairwise_rotations_agree_with_registration(world):
    shapes = world.regressor.shapes_mm[:5]
    rotations = pairwise_rotations(shapes + 100.0)
    for i, target in enumerate(shapes):
        for j, source in enumerate(shapes):
            assert np.allclose(rotations[i, j], register_rigid(source, target)[0], atol=1e-9)


def test_shapes_that_are_others_turned_are_not_distinct(world):
    shapes = world.regressor.shapes_mm[:4]
    turn = matrix_from_head_angles(0.4, -0.2, 0.1)
    both = np.concatenate([shapes, shapes[[2, 0]] @ turn.T])
    assert distinct(both, pairwise_rotations(both)).tolist() == [0, 1, 2, 3]


def test_a_shape_kept_twice_makes_no_second_start(world, unseen):
    arrays = world.regressor.arrays()
    shape, picture = unseen[0]
    turned = arrays["shapes_mm"] @ matrix_from_head_angles(0.9, 0, 0).T
    doubled = arrays | {"shapes_mm": np.concatenate([arrays["shapes_mm"], turned])}
    once = Regression(world.regressor, world.face.camera).run(picture, shape)
    twice = Regression(FernRegressor.from_arrays(doubled), world.face.camera).run(picture, shape)
    assert np.allclose(once.points_mm, twice.points_mm)


def test_distances_are_measured_after_turning(world):
    shapes = world.regressor.shapes_mm[:5]
    turns = pairwise_rotations(shapes)[2]
    out, plain = np.empty(5), np.empty(5)
    turned_distances(shapes[3], shapes, turns, out)
    turned = np.einsum("nij,nqj->nqi", turns, shapes)
    assert np.allclose(out, ((turned - shapes[3]) ** 2).sum(axis=(1, 2)))
    squared_distances(shapes[3], shapes, plain)
    assert np.allclose(plain, ((shapes - shapes[3]) ** 2).sum(axis=(1, 2)))


@pytest.mark.nojit
def test_starts_are_the_nearest_of_the_shape_space(rng):
    distances, steps = rng.uniform(0, 100, 20), rng.uniform(0, 50, 9)
    chosen, best = np.zeros((15, 2), np.int32), np.empty(15)
    choose_starts(distances, steps, chosen, best)
    every = np.sort((distances[:, None] + steps).ravel())[:15]
    assert np.allclose(best, every)
    assert np.allclose(distances[chosen[:, 0]] + steps[chosen[:, 1]], every)


@pytest.mark.nojit
def test_more_runs_than_shapes_start_again_from_the_first():
    chosen = np.zeros((4, 2), np.int32)
    choose_starts(np.array([3.0, 1.0]), np.zeros(1), chosen, np.empty(4))
    assert chosen[:2, 0].tolist() == [1, 0]
    assert np.all(chosen < 2)


@pytest.mark.nojit
@pytest.mark.parametrize("n_runs", [1, 4, 15])
def test_runs_combine_to_mean_or_median(rng, n_runs):
    shapes = rng.normal(size=(16, 5, 3)).astype(np.float32)
    out, values = np.empty((5, 3)), np.empty(n_runs)
    spread = combine_runs(shapes, n_runs, False, values, out)
    kept = shapes[:n_runs].astype(float)
    assert np.allclose(out, kept.mean(axis=0))
    across = kept[..., :2] - kept[..., :2].mean(axis=0)
    assert spread == pytest.approx(np.sqrt((across**2).sum() / (5 * n_runs)))
    combine_runs(shapes, n_runs, True, values, out)
    assert np.allclose(out, np.median(kept, axis=0))


@pytest.mark.parametrize(("use_median", "same_pose"), [(False, True), (True, False)])
def test_a_pass_is_algorithm_2(world, unseen, use_median, same_pose):
    settings = RegressionSettings(15, use_median, 1e9, keep_size=False, same_pose=same_pose)
    # One stage: where rounding moves a grey level across a threshold, later stages would differ.
    regressor = first_stage(world.regressor)
    regression = Regression(regressor, world.face.camera, settings)
    for shape, picture in unseen[:3]:
        previous = shape + (4, -3, 8)
        plain = naive.one_pass(regressor, world.face.camera, picture, previous, settings)
        assert np.abs(regression.run(picture, previous).points_mm - plain).max() < 0.2


def first_stage(regressor):
    """Return the regressor without its later stages."""
    staged = ["corners", "weights", "offsets_mm", "members", "cell", "pairs", "thresholds"]
    staged += ["leaves", "basis_mm"]
    arrays = regressor.arrays()
    return FernRegressor.from_arrays(arrays | {name: arrays[name][:1] for name in staged})


def test_unseen_frames_are_found_from_a_start_beside_the_face(world, unseen):
    regression = Regression(world.regressor, world.face.camera)
    errors, before = [], []
    for shape, picture in unseen:
        start = shape + (6, -6, 5)
        before.append(rmse_px(world, start, shape))
        errors.append(rmse_px(world, regression.run(picture, start).points_mm, shape))
    assert np.mean(before) > 1.5
    assert np.mean(errors) < 0.35


def test_a_head_rolled_further_than_any_training_picture_is_found(world):
    shape = world.face.shape((0.0, 0.0, 0.9), (0.5, 0.2), (0, 0, 600.0))
    previous = world.face.shape((0.0, 0.0, 0.84), (0.4, 0.3), (3, 0, 600.0))
    regression = Regression(world.regressor, world.face.camera)
    found = regression.run(world.face.picture(shape), previous).points_mm
    assert rmse_px(world, found, shape) < 0.7


def test_a_second_pass_reaches_further(world, unseen):
    once = Regression(world.regressor, world.face.camera, RegressionSettings(again_mm=1e9))
    twice = Regression(world.regressor, world.face.camera, RegressionSettings(again_mm=5.0))
    start_gap = np.array([24.0, -16.5, 24.0])
    first = [rmse_px(world, once.run(p, s + start_gap).points_mm, s) for s, p in unseen]
    second = [rmse_px(world, twice.run(p, s + start_gap).points_mm, s) for s, p in unseen]
    assert np.mean(second) < 0.5 * np.mean(first)


def test_the_result_depends_on_the_frame_alone_not_on_earlier_ones(world, unseen):
    (shape, picture), (other_shape, other) = unseen[:2]
    used = Regression(world.regressor, world.face.camera)
    used.run(other, other_shape)
    used.run_from(other, other_shape[None])
    fresh = Regression(world.regressor, world.face.camera)
    assert np.array_equal(used.run(picture, shape).points_mm, fresh.run(picture, shape).points_mm)


def test_keeping_the_size_slides_points_along_their_lines_of_sight(world, unseen):
    free = Regression(world.regressor, world.face.camera, ONE_PASS)
    kept = Regression(world.regressor, world.face.camera, RegressionSettings(again_mm=1e9))
    for shape, picture in unseen:
        start = shape + (0, 0, 30)
        loose, fixed = free.run(picture, start).points_mm, kept.run(picture, start).points_mm
        assert np.allclose(
            project(world.face.camera, loose), project(world.face.camera, fixed), atol=1e-6
        )


def test_keeping_the_size_finds_the_depth(world, unseen):
    free = Regression(world.regressor, world.face.camera, ONE_PASS)
    kept = Regression(world.regressor, world.face.camera, RegressionSettings(again_mm=1e9))

    def depth_error(regression):
        starts = [(s, p, s + (0, 0, gap)) for s, p in unseen for gap in (-40, 40)]
        found = [regression.run(p, start).points_mm - s for s, p, start in starts]
        return np.abs(np.mean(found, axis=1)[:, 2]).mean()

    # A tenth of a pixel in the radius of this face of 23 px is 2.6 mm of depth.
    assert depth_error(kept) < 6.0
    assert depth_error(kept) < 0.6 * depth_error(free)


def test_the_size_gauge_reads_one_on_every_shape_of_the_user_and_scales_with_it(world):
    face = world.face
    rng = np.random.default_rng(4)
    setup = face.random_shapes(30, rng)
    mean = face.shape((0, 0, 0), (0.5, 0.5), (0, 0, 0))
    mean -= mean.mean(axis=0)
    gauge = size_gauge(setup, mean)
    for shape in face.random_shapes(10, rng):
        centred = 1.1 * (shape - shape.mean(axis=0))
        turned = centred @ register_rigid(centred, mean)[0].T
        assert np.vdot(turned, gauge) == pytest.approx(1.1, abs=0.005)


def test_starts_at_the_truth_stay_there(world):
    samples = world.training_set
    regression = Regression(world.regressor, world.face.camera)
    for image, shape in zip(samples.images[:4], samples.shapes_mm[:4], strict=True):
        assert rmse_px(world, regression.run_from(image, shape[None]).points_mm, shape) < 0.6


def test_the_residual_tells_a_found_face_from_a_wrong_place(world, unseen):
    regression = Regression(world.regressor, world.face.camera, ONE_PASS)
    good = [regression.run(picture, shape).residual for shape, picture in unseen]
    upside_down = [
        regression.run(picture[::-1].copy(), shape).residual for shape, picture in unseen
    ]
    assert max(good) < 1.3
    assert min(upside_down) > 1.5


def test_a_frame_makes_next_to_no_arrays(world, unseen):
    regression = Regression(world.regressor, world.face.camera)
    shape, picture = unseen[0]
    regression.run(picture, shape)
    tracemalloc.start()
    regression.run(picture, shape)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 16_384


def test_survives_a_file(world, unseen, tmp_path):
    np.savez(tmp_path / "regressor.npz", **world.regressor.arrays())
    with np.load(tmp_path / "regressor.npz", allow_pickle=False) as stored:
        loaded = FernRegressor.from_arrays(stored)
    shape, picture = unseen[0]
    one = Regression(world.regressor, world.face.camera).run(picture, shape)
    other = Regression(loaded, world.face.camera).run(picture, shape)
    assert np.array_equal(one.points_mm, other.points_mm)
    assert one.residual == other.residual


@pytest.mark.parametrize("name", ["corners", "pairs", "members", "cell", "check_cell"])
def test_refuses_a_damaged_index(world, name):
    arrays = world.regressor.arrays()
    arrays[name] = arrays[name] + 1000
    with pytest.raises(ArrayShapeError, match=rf"FernRegressor\.{name}.*expected indices"):
        FernRegressor.from_arrays(arrays)


def test_refuses_a_missing_leaf(world):
    arrays = world.regressor.arrays()
    arrays["leaves"] = arrays["leaves"][:, :, :-1]
    with pytest.raises(ArrayShapeError, match="leaves"):
        FernRegressor.from_arrays(arrays)


def test_says_what_is_wrong_with_a_frame_or_a_start(world, unseen):
    regression = Regression(world.regressor, world.face.camera)
    shape, picture = unseen[0]
    with pytest.raises(ValueError, match=r"\(90, 120\), uint8, expected \(180, 240\), uint8"):
        regression.run(picture[::2, ::2], shape)
    with pytest.raises(ValueError, match="not finite"):
        regression.run(picture, np.full_like(shape, np.nan))
    with pytest.raises(ValueError, match="16 starts, but room for 15"):
        regression.run_from(picture, np.repeat(shape[None], 16, axis=0))
