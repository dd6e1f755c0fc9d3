"""The tracker's kernels against naive forms, and what it recovers from known faces."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from assets.build.animation_events import Event, play
from assets.build.animation_script import scene
from core.animation_prior import N_LAGS, conditional_tables
from core.arkit import EXPRESSION_NAMES, mirror_permutation
from core.expression_history import History
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_quaternion,
    matrix_from_rotation_vector,
    register_rigid,
)
from core.kernels.tracking import (
    condition,
    largest_eigenvector,
    log_evidence,
    minimise_in_box,
    register,
)
from core.tracker import (
    Tracker,
    TrackerSettings,
    face_tables,
    point_weights,
    without_rigid_motion,
    workspace_for,
)
from tests.core.test_animation_prior import random_covariances, small_prior
from tests.core.tracked_faces import (
    FPS,
    expression,
    head_pose,
    index,
    lag_and_gain,
    needs_compiled_kernels,
    regressor_noise,
    shape_of,
    shipped_prior,
    track_clip,
    user_face,
)

N = len(EXPRESSION_NAMES)
#: Shapes that 75 points see well.
WELL_SEEN = (
    "eyeBlinkLeft", "eyeBlinkRight", "browDownLeft", "browOuterUpRight", "browInnerUpLeft",
    "jawOpen", "mouthFunnel", "mouthPucker", "mouthLeft", "mouthSmileLeft", "mouthSmileRight",
    "mouthFrownLeft", "mouthDimpleRight", "mouthStretchLeft", "mouthLowerDownLeft",
    "mouthUpperUpRight", "noseSneerLeft", "jawRight", "mouthShrugUpper",
)  # fmt: skip
#: Shapes that move few points, by little, or as others do together.
WEAKLY_SEEN = (
    "eyeWide", "cheekSquint", "mouthPress", "cheekPuff", "cheekSuck", "jawForward",
    "mouthRollLower", "mouthRollUpper",
)  # fmt: skip


def tracker_of(model, **settings):
    return Tracker(model, shipped_prior(), TrackerSettings(**settings))


def settled(tracker, points, n_frames=6):
    for k in range(n_frames):
        face = tracker.step(points, k / FPS)
    return face


# Kernels


@pytest.mark.parametrize("seed", range(4))
def test_largest_eigenvector_agrees_with_numpy(seed):
    matrix = np.random.default_rng(seed).standard_normal((4, 4))
    matrix += matrix.T
    out = np.empty(4)
    largest_eigenvector(matrix.copy(), np.empty((4, 4)), out)
    expected = np.linalg.eigh(matrix)[1][:, -1]
    assert abs(out @ expected) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_registration_agrees_with_the_singular_value_decomposition(seed):
    rng = np.random.default_rng(seed)
    source = rng.normal(0, 40, (75, 3))
    rotation = matrix_from_rotation_vector(rng.normal(0, 1.5, 3))
    target = source @ rotation.T + rng.normal(0, 300, 3) + rng.normal(0, 2, source.shape)
    pose = np.empty((4, 3))
    register(source, target, np.ones(75), np.empty((2, 4, 4)), pose)
    expected_rotation, expected_translation = register_rigid(source, target)
    np.testing.assert_allclose(pose[:3], expected_rotation, atol=1e-9)
    np.testing.assert_allclose(pose[3], expected_translation, atol=1e-6)


def test_registration_of_a_mirrored_face_is_still_a_rotation():
    source = np.random.default_rng(0).normal(0, 40, (75, 3))
    pose = np.empty((4, 3))
    register(source, source * (-1, 1, 1), np.ones(75), np.empty((2, 4, 4)), pose)
    assert np.linalg.det(pose[:3]) == pytest.approx(1)


def test_a_point_without_weight_does_not_move_the_registration():
    source = np.random.default_rng(0).normal(0, 40, (75, 3))
    target, weights, pose = source + [1.0, 2.0, 3.0], np.ones(75), np.empty((4, 3))
    target[7] += 50
    weights[7] = 0
    register(source, target, weights, np.empty((2, 4, 4)), pose)
    np.testing.assert_allclose(pose, np.vstack([np.eye(3), [1, 2, 3]]), atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_coordinate_descent_finds_the_minimum_in_the_box(seed):
    rng = np.random.default_rng(seed)
    matrix, target = rng.standard_normal((60, 12)), 2 * rng.standard_normal(60)
    # Two dummies at the end, so that the bound on a sum does not bite.
    hessian = np.eye(14)
    hessian[:12, :12] = matrix.T @ matrix
    gradient = np.concatenate([matrix.T @ target, [-1.0, -1.0]])
    out = rng.random(14)
    minimise_in_box(hessian, gradient, 12, 13, out)
    expected = lsq_linear(matrix, target, (0, 1), tol=1e-12).x
    np.testing.assert_allclose(out[:12], expected, atol=2e-4)


def test_coordinate_descent_keeps_a_sum_within_one():
    out = np.zeros(3)
    minimise_in_box(np.eye(3), np.array([0.9, 0.8, 0.3]), 0, 1, out)
    assert out[0] + out[1] <= 1
    assert out[2] == pytest.approx(0.3)


def test_evidence_orders_components_as_the_dense_gaussian_does():
    """With the data a Gaussian around a* with covariance G^-1, the evidence of a component is
    log N(a*; mean, G^-1 + covariance) up to a constant of the region."""
    rng, prior = np.random.default_rng(0), small_prior()
    model = user_face()
    face = face_tables(model, TrackerSettings())._replace(
        gram=50 * random_covariances(rng, 1, N)[0]
    )
    tables = conditional_tables(prior, N_LAGS + 1)
    work = workspace_for(face, tables)
    current, optimum = rng.random(N), rng.random(N)
    condition(tables, np.zeros((0, N)), work.log_weights, work.means, work.difference)
    for z, region in enumerate(prior.regions):
        n, chosen = region.members.size, region.members
        gram = face.gram[np.ix_(chosen, chosen)]
        work.residual[chosen] = gram @ (optimum[chosen] - current[chosen])
        ours, dense = [], []
        for s in range(region.weights.size):
            ours.append(log_evidence(tables, z, s, current, 1.0, face.gram, 1.0, work))
            covariance = np.linalg.inv(gram) + np.asarray(region.covariances[s][:n, :n], float)
            away = optimum[chosen] - region.means[s, :n]
            level = away @ np.linalg.solve(covariance, away) + np.linalg.slogdet(covariance)[1]
            dense.append(np.log(region.weights[s]) - 0.5 * level)
        np.testing.assert_allclose(np.diff(ours), np.diff(dense), rtol=1e-3, atol=1e-3)


# Tables


def test_deltas_without_rigid_motion_cannot_be_told_apart_by_one():
    model, weights = user_face(), point_weights(TrackerSettings(), 75)
    free = without_rigid_motion(model.neutral_mm, model.deltas_mm, weights)
    turning = np.cross([0.3, -0.2, 0.5], model.neutral_mm) + [1.0, 2.0, 3.0]
    products = np.einsum("bld,ld,l->b", free, turning, weights)
    np.testing.assert_allclose(products, 0, atol=1e-8 * np.abs(turning).sum())


def test_lips_and_lids_weigh_more_than_replacement_points():
    weights = point_weights(TrackerSettings(), 75)
    assert weights.mean() == pytest.approx(1)
    assert weights[12:28].min() > weights[60:].max()
    assert weights[40:60].min() > weights[60:].max()


# Single faces


@pytest.mark.parametrize("name", WELL_SEEN)
@pytest.mark.parametrize("seed", [None, 3])
def test_recovers_each_well_seen_shape(name, seed):
    model, truth = user_face(seed), np.zeros(N)
    truth[index(name)] = 0.7
    found = settled(tracker_of(model), shape_of(model, truth, head_pose())).expression
    assert found[index(name)] == pytest.approx(0.7, abs=0.07)
    assert np.delete(found, index(name)).max() < 0.12


def test_recovers_pose_and_a_mixed_expression():
    model, pose = user_face(5), head_pose(-0.5, 0.2, 0.3, (-60.0, 40.0, 520.0))
    truth = expression(jawOpen=0.5, mouthSmile=0.5, browInnerUp=0.6, eyeBlinkLeft=0.4)
    face = settled(tracker_of(model), shape_of(model, truth, pose, (0.2, -0.1)))
    np.testing.assert_allclose(face.expression, truth, atol=0.1)
    np.testing.assert_allclose(matrix_from_quaternion(face.rotation_wxyz), pose[:3], atol=5e-3)
    np.testing.assert_allclose(face.translation_mm, pose[3], atol=0.5)
    np.testing.assert_allclose(face.gaze_rad.mean(axis=0), [0.2, -0.1], atol=0.03)


def test_a_jaw_that_opens_in_one_frame_does_not_pull_the_head_with_it():
    model, pose, tracker = user_face(), head_pose(0.0, 0.0, 0.0), tracker_of(user_face())
    settled(tracker, shape_of(model, np.zeros(N), pose))
    tracker.step(shape_of(model, expression(jawOpen=0.9), pose), 6 / FPS)
    angles = np.rad2deg(head_angles_from_matrix(tracker.state.pose[:3]))
    assert np.abs(angles).max() < 0.5
    assert tracker.state.rms_mm < 0.2


def test_a_mirrored_face_gives_mirrored_coefficients():
    model = user_face()
    truth = expression(mouthSmileLeft=0.6, eyeBlinkRight=0.8, jawLeft=0.5, browDownLeft=0.5)
    points = shape_of(model, truth, head_pose(0.2, 0.1, 0.0, (0.0, 0.0, 600.0)))
    found = settled(tracker_of(model), points).expression
    face = model.neutral_mm
    distances = np.linalg.norm(face[:, None] - face * (-1, 1, 1), axis=2)
    mirrored = points[[*distances.argmin(axis=1), 76, 75]] * (-1, 1, 1)
    other = settled(tracker_of(model), mirrored).expression
    np.testing.assert_allclose(other[mirror_permutation()], found, atol=0.03)


def test_moving_the_camera_frame_moves_only_the_translation():
    model, truth = user_face(), expression(mouthPucker=0.5)
    points = shape_of(model, truth, head_pose())
    face = settled(tracker_of(model), points)
    moved = settled(tracker_of(model), points + [30.0, -20.0, 0.0])
    np.testing.assert_allclose(moved.expression, face.expression, atol=1e-6)
    np.testing.assert_allclose(moved.translation_mm - face.translation_mm, [30, -20, 0], atol=1e-6)


def test_coefficients_stay_in_their_box_whatever_comes():
    model, tracker, rng = user_face(), tracker_of(user_face()), np.random.default_rng(0)
    for k in range(10):
        points = shape_of(model, rng.uniform(-0.5, 2.0, N), head_pose())
        found = tracker.step(points, k / FPS).expression
        assert found.min() >= 0 and found.max() <= 1
        assert found[index("mouthClose")] <= found[index("jawOpen")] + 1e-12


@pytest.mark.parametrize("points", [np.zeros((76, 3)), np.full((77, 3), np.nan)])
def test_points_of_the_wrong_number_or_not_finite_are_refused(points):
    with pytest.raises(ValueError, match="77 finite points"):
        tracker_of(user_face()).step(points, 0.0)


def test_less_confidence_leans_more_on_the_past():
    model, steps = user_face(), []
    for confidence in (1.0, 0.02):
        tracker = tracker_of(model)
        settled(tracker, shape_of(model, np.zeros(N), head_pose()))
        points = shape_of(model, expression(mouthSmile=0.15), head_pose())
        found = tracker.step(points, 6 / FPS, confidence).expression
        steps.append(found[index("mouthSmileLeft")])
    assert steps[1] < 0.5 * steps[0]


# History


def test_history_is_sampled_on_the_priors_grid_at_any_frame_rate():
    for fps in (24.0, 30.0, 60.0, 120.0):
        history = History(1, 1 / 30)
        for k in range(100):
            history.append(k / fps, np.array([k / fps]))
        assert history.first_lag(100 / fps) == 1
        wanted = 100 / fps - np.array([[1], [2], [3]]) / 30
        wanted = np.minimum(wanted, 99 / fps)
        np.testing.assert_allclose(history.sample(100 / fps, 1), wanted, atol=1e-9)


@pytest.mark.parametrize("missing, first_lag", [(0, 1), (1, 2), (2, 3), (3, 4), (30, 4)])
def test_dropped_frames_leave_the_later_lags(missing, first_lag):
    history = History(1, 1 / 30)
    for k in range(10):
        history.append(k / 30, np.array([float(k)]))
    time_s = (10 + missing) / 30
    assert history.first_lag(time_s) == first_lag
    kept = history.sample(time_s, first_lag)[:, 0]
    np.testing.assert_allclose(kept, [10 + missing - lag for lag in range(first_lag, N_LAGS + 1)])


def test_a_short_history_is_none():
    history = History(1, 1 / 30)
    assert history.first_lag(0.0) == N_LAGS + 1
    history.append(0.0, np.zeros(1))
    history.append(1 / 30, np.zeros(1))
    assert history.first_lag(2 / 30) == N_LAGS + 1


def test_a_jump_back_in_time_starts_anew():
    model, tracker = user_face(), tracker_of(user_face())
    points = shape_of(model, np.zeros(N), head_pose())
    settled(tracker, points)
    assert tracker.state.first_lag == 1
    tracker.step(points, 0.0)
    assert tracker.state.first_lag == N_LAGS + 1


def test_reset_makes_the_next_step_like_the_first():
    model, tracker = user_face(), tracker_of(user_face())
    points = shape_of(model, expression(mouthSmile=0.4), head_pose())
    first = tracker.step(points, 0.0)
    settled(tracker, shape_of(model, expression(jawOpen=0.9), head_pose(0.5)))
    tracker.reset()
    again = tracker.step(points, 9.0)
    for ours, theirs in zip(again, first, strict=True):
        np.testing.assert_array_equal(ours, theirs)


# Takes, with noise as of a regressor (0.15 mm is 0.15 px at 600 mm and focal length 600 px)


@needs_compiled_kernels
@pytest.mark.parametrize("seed", [None, 7])
def test_a_still_face_keeps_still(seed):
    model, rng = user_face(seed), np.random.default_rng(0)
    clip = np.repeat(expression(mouthSmile=0.1, jawOpen=0.05)[None], 150, axis=0)
    found = track_clip(tracker_of(model), model, clip, regressor_noise(rng, model, 150))[40:]
    assert found.std(axis=0).mean() < 0.006
    assert found.std(axis=0).max() < 0.03
    without = tracker_of(model, prior_weight=0.01, sparsity=0.0)
    plain = track_clip(without, model, clip, regressor_noise(rng, model, 150))[40:]
    assert np.abs(np.diff(found, axis=0)).mean() < 0.35 * np.abs(np.diff(plain, axis=0)).mean()


@needs_compiled_kernels
def test_noise_does_not_excite_what_the_points_hardly_see():
    model, rng = user_face(7), np.random.default_rng(1)
    clip = np.zeros((150, N))
    found = track_clip(tracker_of(model), model, clip, regressor_noise(rng, model, 150))[40:]
    hard = expression(**dict.fromkeys(WEAKLY_SEEN, 1.0)) > 0
    assert found[:, hard].max() < 0.05


def blinking(sides, seed=1, n_frames=200):
    """Return blinks of 3 to 4 frames down and up again, and their starts."""
    rng, events, start = np.random.default_rng(seed), [], 0.5
    target = expression(**{f"eyeBlink{side}": 1.0 for side in sides})
    while start < n_frames / FPS - 0.5:
        events.append(Event(start, 0.07, 0.01, 0.11, target))
        start += rng.uniform(0.4, 0.7)
    clip = np.clip(play(events, np.arange(n_frames) / FPS), 0, 1)
    return clip, [int(event.start_s * FPS) for event in events]


@needs_compiled_kernels
@pytest.mark.parametrize("seed", [None, 7])
def test_fast_blinks_keep_their_depth_and_their_time(seed):
    model, rng = user_face(seed), np.random.default_rng(2)
    clip, starts = blinking(("Left", "Right"))
    found = track_clip(tracker_of(model), model, clip, regressor_noise(rng, model, len(clip)))
    for side in ("Left", "Right"):
        blink = index(f"eyeBlink{side}")
        for start in starts:
            window = slice(start, start + 10)
            assert found[window, blink].max() > 0.9 * clip[window, blink].max()
            late = int(found[window, blink].argmax()) - int(clip[window, blink].argmax())
            assert abs(late) <= 1
        assert abs(lag_and_gain(clip[:, blink], found[:, blink])[0]) < 0.5
    mouth = [index(name) for name in ("mouthSmileLeft", "jawOpen", "mouthPucker", "mouthFunnel")]
    assert found[:, mouth].max() < 0.05


@needs_compiled_kernels
def test_a_wink_leaves_the_other_eye_open():
    model, rng = user_face(), np.random.default_rng(3)
    clip, _ = blinking(("Left",))
    found = track_clip(tracker_of(model), model, clip, regressor_noise(rng, model, len(clip)))
    assert lag_and_gain(clip[:, index("eyeBlinkLeft")], found[:, index("eyeBlinkLeft")])[1] > 0.9
    assert found[:, index("eyeBlinkRight")].max() < 0.1


@needs_compiled_kernels
def test_speech_keeps_its_amplitude_and_comes_at_most_a_frame_late():
    model, rng = user_face(), np.random.default_rng(77)
    clip = scene(rng, "talk", 15.0)
    found = track_clip(tracker_of(model), model, clip, regressor_noise(rng, model, len(clip)))
    for name in ("jawOpen", "mouthFunnel", "mouthPucker", "mouthStretchLeft", "mouthSmileRight"):
        lag, gain = lag_and_gain(clip[:, index(name)], found[:, index(name)])
        assert gain > 0.9, name
        assert lag < 1.0, name
    assert np.sqrt(np.mean((found - clip) ** 2)) < 0.025


@needs_compiled_kernels
@pytest.mark.parametrize("fps", [15.0, 24.0, 60.0])
def test_other_frame_rates_track_as_well(fps):
    model, rng = user_face(), np.random.default_rng(5)
    clip = scene(rng, "feelings", 12.0)
    times = np.arange(0.0, 11.5, 1 / fps)
    truth = np.stack([np.interp(times * FPS, np.arange(len(clip)), c) for c in clip.T], axis=1)
    noise = regressor_noise(rng, model, len(times))
    found = track_clip(tracker_of(model), model, truth, noise, times)
    assert np.sqrt(np.mean((found - truth) ** 2)) < 0.03


@needs_compiled_kernels
def test_dropped_frames_do_no_harm():
    model, rng = user_face(), np.random.default_rng(6)
    clip = scene(rng, "feelings", 12.0)
    kept = np.flatnonzero(rng.random(len(clip)) > 0.3)
    noise = regressor_noise(rng, model, len(clip))
    whole = track_clip(tracker_of(model), model, clip, noise)[kept]
    dropped = track_clip(tracker_of(model), model, clip[kept], noise[kept], kept / FPS)
    error = np.sqrt(np.mean((dropped - clip[kept]) ** 2))
    assert error < 1.3 * np.sqrt(np.mean((whole - clip[kept]) ** 2)) + 0.003
