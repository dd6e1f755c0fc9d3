"""The animation prior: its file, its conditional tables, and how it was made."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from assets.build.animation_events import Event, minimum_jerk, play, speak, targets
from assets.build.animation_mixture import (
    Mixture,
    MixtureSettings,
    expectation,
    fit_mixture,
    log_densities,
    maximisation,
)
from assets.build.animation_prior import samples_of
from assets.build.animation_script import KINDS, performance, scene
from core.animation_prior import (
    N_LAGS,
    REGIONS,
    AnimationPrior,
    PriorFileError,
    RegionMixture,
    conditional_tables,
    load_animation_prior,
    members,
    pack_symmetric,
    save_animation_prior,
    unpack_symmetric,
)
from core.arkit import EXPRESSION_NAMES, mirror_permutation
from tests.core.tracked_faces import ASSETS, index, shipped_prior


def random_covariances(rng, count, size):
    factors = rng.standard_normal((count, size, size + 3))
    return factors @ factors.transpose(0, 2, 1) / size


def small_prior(seed=0, n_components=3):
    """Return a prior of random mixtures with the shipped regions."""
    rng = np.random.default_rng(seed)
    regions = []
    for name in REGIONS:
        chosen = members(name)
        size = chosen.size * (1 + N_LAGS)
        weights = rng.random(n_components) + 0.1
        regions.append(
            RegionMixture(
                chosen,
                weights / weights.sum(),
                rng.random((n_components, size)),
                0.1 * random_covariances(rng, n_components, size),
            )
        )
    return AnimationPrior(1 / 30, tuple(regions))


def test_every_coefficient_is_in_one_region():
    chosen = np.concatenate([members(name) for name in REGIONS])
    assert sorted(chosen) == list(range(len(EXPRESSION_NAMES)))


def test_a_region_holds_both_sides_of_what_it_holds():
    for name in REGIONS:
        chosen = set(members(name).tolist())
        assert {mirror_permutation()[i] for i in chosen} == chosen or name == "sideways"


def test_packing_and_unpacking_symmetric_matrices_changes_nothing():
    matrices = random_covariances(np.random.default_rng(1), 4, 7).astype(np.float32)
    np.testing.assert_array_equal(unpack_symmetric(pack_symmetric(matrices)), matrices)


def test_a_prior_survives_its_file(tmp_path):
    prior = small_prior()
    save_animation_prior(tmp_path / "prior.npz", prior)
    loaded = load_animation_prior(tmp_path / "prior.npz")
    assert loaded.frame_s == prior.frame_s
    for ours, theirs in zip(prior.regions, loaded.regions, strict=True):
        np.testing.assert_array_equal(ours.members, theirs.members)
        np.testing.assert_allclose(ours.weights, theirs.weights)
        np.testing.assert_allclose(ours.means, theirs.means, rtol=1e-6)
        np.testing.assert_allclose(ours.covariances, theirs.covariances, rtol=1e-5)


def test_a_file_without_an_array_says_which_and_how_to_make_it_again(tmp_path):
    np.savez(tmp_path / "prior.npz", frame_s=0.03, lids_weights=np.ones(1))
    with pytest.raises(PriorFileError, match=r"'lids_means'.*animation_prior\.py"):
        load_animation_prior(tmp_path / "prior.npz")


@pytest.mark.parametrize("first_lag", range(1, N_LAGS + 2))
def test_tables_give_the_joint_density_of_frame_and_history(first_lag):
    prior, rng = small_prior(), np.random.default_rng(3)
    tables = conditional_tables(prior, first_lag)
    for z, region in enumerate(prior.regions):
        n = region.members.size
        kept = np.r_[0:n, first_lag * n : (1 + N_LAGS) * n]
        sample = rng.random(kept.size)
        n_history = tables.counts[z, 1]
        for s in range(region.weights.size):
            away = sample[n:] - tables.history_means[z, s, :n_history]
            white = tables.whiteners[z, s, :n_history, :n_history] @ away
            mean = tables.means[z, s, :n] + tables.maps[z, s, :n, :n_history] @ away
            off = sample[:n] - mean
            precision = tables.precisions[z, s, :n, :n]
            ours = tables.log_weights[z, s] - 0.5 * (white @ white + off @ precision @ off)
            covariance = np.asarray(region.covariances[s], float)[np.ix_(kept, kept)]
            joint = multivariate_normal(region.means[s][kept], covariance).logpdf(sample)
            constant = -0.5 * kept.size * np.log(2 * np.pi)
            expected = np.log(region.weights[s]) + joint - constant
            assert ours == pytest.approx(expected, rel=2e-4, abs=2e-3)


def test_the_shipped_prior_is_small_and_sound():
    assert (ASSETS / "animation_prior.npz").stat().st_size < 1_000_000
    prior = shipped_prior()
    assert prior.frame_s == pytest.approx(1 / 30)
    for region in prior.regions:
        assert region.weights.sum() == pytest.approx(1)
        assert (np.linalg.eigvalsh(np.asarray(region.covariances, float)) > 0).all()


def test_the_shipped_prior_forbids_no_shape():
    prior = shipped_prior()
    for region in prior.regions:
        n = region.members.size
        mixture = Mixture(
            region.weights, region.means[:, :n], np.asarray(region.covariances[:, :n, :n], float)
        )
        for i in range(n):
            level = log_densities(mixture, 0.8 * np.eye(n)[i][None])
            # The full range of a region's coefficients is a box of volume 1.
            assert np.logaddexp.reduce(level[0]) > -20


def test_the_shipped_prior_is_nearly_the_same_in_the_mirror():
    prior, mirror = shipped_prior(), np.array(mirror_permutation())
    for region in prior.regions:
        n = region.members.size
        mean = region.weights @ region.means[:, :n]
        order = [list(region.members).index(i) for i in mirror[region.members]]
        np.testing.assert_allclose(mean, mean[order], atol=0.01)


def test_minimum_jerk_starts_and_ends_at_rest():
    phase = np.linspace(-0.5, 1.5, 2001)
    speed = np.gradient(minimum_jerk(phase), phase)
    assert minimum_jerk(phase)[[0, -1]].tolist() == [0, 1]
    assert abs(speed[np.abs(phase) < 0.01]).max() < 0.01
    assert speed.max() == pytest.approx(1.875, abs=0.01)


def test_an_event_rises_holds_and_falls():
    times = np.arange(0, 2, 0.01)
    curve = play([Event(0.5, 0.2, 0.3, 0.4, targets(jawOpen=0.8))], times)[:, index("jawOpen")]
    assert curve[times < 0.5].max() == 0
    np.testing.assert_allclose(curve[(times > 0.71) & (times < 0.99)], 0.8)
    np.testing.assert_allclose(curve[times > 1.41], 0, atol=1e-12)


def test_a_sound_between_two_others_is_shaped_by_them():
    times = np.array([0.10])
    alone, wide = targets(jawOpen=0.2), targets(jawOpen=0.8)
    between = speak(
        np.array([0.05, 0.1, 0.15]), np.array([wide, alone, wide]), np.full(3, 0.04), times
    )
    single = speak(np.array([0.1]), alone[None], np.full(1, 0.04), times)
    assert between[0, index("jawOpen")] > single[0, index("jawOpen")] + 0.1


@pytest.mark.parametrize("kind", KINDS)
def test_scenes_stay_in_range_with_the_mouth_closed_no_further_than_the_jaw_is_open(kind):
    clip = scene(np.random.default_rng(0), kind, 8.0)
    assert clip.min() >= 0 and clip.max() <= 1
    assert (clip[:, index("mouthClose")] <= clip[:, index("jawOpen")]).all()


def test_the_performance_moves_every_shape_and_depends_on_the_seed_alone():
    first = np.concatenate(performance(np.random.default_rng(4), 10.0))
    again = np.concatenate(performance(np.random.default_rng(4), 10.0))
    np.testing.assert_array_equal(first, again)
    highest = first.max(axis=0)
    assert (np.maximum(highest, highest[mirror_permutation()]) > 0.3).all()
    assert abs(len(first) / 1800 - 10.0) < 0.2


def test_samples_are_a_frame_and_its_predecessors():
    clip = np.linspace(0, 1, 300)[:, None] * np.ones(len(EXPRESSION_NAMES))
    samples = samples_of(np.random.default_rng(0), clip)
    np.testing.assert_array_equal(samples[:, 0], clip[N_LAGS:])
    error = samples[:, 1:].mean(axis=2) - np.stack(
        [clip[N_LAGS - lag : -lag, 0] for lag in range(1, N_LAGS + 1)], axis=1
    )
    assert np.abs(error[30:-30]).max() < 0.03


def test_expectation_maximisation_finds_two_clouds():
    rng = np.random.default_rng(0)
    near = rng.multivariate_normal([0, 0], [[0.04, 0.03], [0.03, 0.04]], 3000)
    far = rng.multivariate_normal([2, 1], [[0.09, 0.0], [0.0, 0.01]], 1000)
    settings = MixtureSettings(3, shrinkage=1.0)
    mixture, _ = fit_mixture(rng, np.concatenate([near, far]), 1, settings)
    at_near = np.abs(mixture.means[:-1]).sum(axis=1) < 1.0
    assert mixture.weights[:-1][at_near].sum() == pytest.approx(0.75, abs=0.03)
    right = mixture.means[:-1][~at_near]
    np.testing.assert_allclose(right.mean(axis=0), [2, 1], atol=0.3)


def test_likelihood_rises_from_round_to_round():
    rng = np.random.default_rng(1)
    samples = np.concatenate([rng.normal(0, 0.1, (500, 4)), rng.normal(1, 0.3, (500, 4))])
    settings = MixtureSettings(4, shrinkage=0.0, floor=1e-4)
    start, _ = fit_mixture(rng, samples, 1, MixtureSettings(4, rounds=0))
    broad = Mixture(start.weights[-1:], start.means[-1:], start.covariances[-1:])
    mixture, levels = start, []
    for _ in range(6):
        shares, level = expectation(mixture, samples)
        levels.append(level)
        mixture = maximisation(samples, shares, settings, broad)
    assert (np.diff(levels) > -1e-6).all()
