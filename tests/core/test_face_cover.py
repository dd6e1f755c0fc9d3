import numpy as np
import pytest

from core.face_cover import POINTS, REGIONS, covered, skin_levels

N = 300
JAW = slice(*(np.array([0, 8]) + 8 * list(REGIONS).index("jaw_left")))


@pytest.fixture
def causes(rng):
    return rng.normal(0, [0.3, 0.2, 0.1, 1.0], (N, 4))


def skin(causes, rng):
    """Levels that depend on the causes, each point in its own manner, and on chance."""
    slopes = rng.normal(0, 0.3, (causes.shape[1], len(POINTS)))
    return rng.normal(0, 1, len(POINTS)) + causes @ slopes + rng.normal(0, 0.05, (N, len(POINTS)))


def test_light_that_changes_with_the_pose_is_no_cover(causes, rng):
    assert covered(skin(causes, rng), causes, causes[:, 0]).max() < 1.3


@pytest.mark.parametrize("share", [0.02, 0.1, 0.3])
def test_frames_with_a_covered_region_stand_out(causes, rng, share):
    levels, hidden = skin(causes, rng), np.arange(N) < share * N
    levels[hidden, JAW] += 1.0
    score = covered(levels, causes, 0 * causes[:, 0])
    assert score[hidden].min() > 1.3 * score[~hidden].max()


def test_a_rare_pose_may_look_otherwise(causes, rng):
    levels = skin(0 * causes, rng)
    levels[0] += 0.2
    usual = covered(levels, causes, np.zeros(N))
    causes[0, 0] += 15 * causes[:, 0].std()
    rare = covered(levels, causes, np.zeros(N))
    assert rare[0] < 0.7 * usual[0]
    assert np.median(rare) == pytest.approx(np.median(usual), rel=0.05)


def test_half_of_the_frames_tell_the_same(causes, rng):
    levels = skin(causes, rng)
    levels[:20, JAW] += 1.0
    whole, half = (covered(levels[::n], causes[::n], np.zeros(N)[::n]) for n in (1, 2))
    np.testing.assert_allclose(whole[::2], half, rtol=0.25)


def test_what_a_turned_head_hides_is_not_judged(causes, rng):
    levels = skin(causes, rng)
    levels[:5, JAW] += 2.0
    yaw = np.zeros(N)
    assert covered(levels, causes, yaw)[:5].min() > 2
    yaw[:5] = 1.0
    assert covered(levels, causes, yaw)[:5].max() < 1.3
    yaw[:5] = -1.0
    assert covered(levels, causes, yaw)[:5].min() > 2


def test_frames_without_any_difference_are_not_covered():
    assert not covered(np.zeros((80, len(POINTS))), np.zeros((80, 3)), np.zeros(80)).any()


def test_exposure_changes_no_level(rng):
    gray = np.kron(rng.integers(20, 110, (20, 20)), np.ones((10, 10))).astype(np.uint8)
    mesh = rng.uniform(30, 170, (478, 2))
    plain, bright = skin_levels(gray, mesh), skin_levels(2 * gray + 10, mesh)
    np.testing.assert_allclose(plain, bright, atol=0.1)
    assert np.median(plain) == pytest.approx(0)


def test_points_outside_the_picture_take_its_edge(rng):
    gray = rng.integers(0, 255, (50, 50)).astype(np.uint8)
    assert np.isfinite(skin_levels(gray, rng.uniform(-80, 120, (478, 2)))).all()


def test_regions_share_no_point_and_mirror_each_other():
    assert len(set(POINTS)) == len(POINTS) == 56
    assert all(len(points) == 8 for points in REGIONS.values())
