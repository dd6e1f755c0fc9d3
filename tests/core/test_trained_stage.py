"""Facts about the stages while they are trained."""

from dataclasses import replace

import numpy as np
import pytest

from core.camera import project
from core.regressor_trainer import train
from core.sampling import undisturbed
from core.trained_stage import Watched
from tests.synthetic_face import SMALL, finish, small_world


@pytest.fixture(scope="module")
def pairs():
    """The pictures of the small world in their own light, some guesses off."""
    plain = undisturbed(small_world().training_set)
    moved = plain.truth_mm + np.array([4.0, -3.0, 6.0], np.float32)
    return replace(plain, guess_mm=moved)


@pytest.fixture(scope="module")
def watched(pairs):
    world = small_world()
    steps = train(world.training_set, np.random.default_rng(8), SMALL, {"held_px": pairs})
    return finish(steps)


def test_watching_changes_nothing_of_what_is_learned(watched):
    world = small_world()
    alone, progress = finish(train(world.training_set, np.random.default_rng(8), SMALL))
    for one, other in zip(watched[0].arrays().values(), alone.arrays().values(), strict=True):
        assert np.array_equal(one, other)
    assert all("stage" not in step.plot for step in progress)


def test_the_error_of_watched_pairs_is_told_before_the_first_and_after_each_stage(watched, pairs):
    told = [step.plot for step in watched[1]]
    assert [plot["stage"] for plot in told] == [0, 1, 2, 3, 4]
    places = [project(pairs.camera, points) for points in (pairs.guess_mm, pairs.truth_mm)]
    off = np.sqrt(np.mean(np.sum((places[0] - places[1]) ** 2, axis=2), axis=1)).mean()
    assert told[0]["held_px"] == pytest.approx(off, rel=1e-5)
    errors = [plot["held_px"] for plot in told]
    assert np.all(np.diff(errors) < 0) and errors[-1] < 0.4 * errors[0]


def test_pairs_are_moved_as_the_finished_regressor_moves_them(watched, pairs):
    """The last error told is that of the finished stages applied one by one."""
    from core.appearance import AppearancePoints
    from core.trained_stage import Stage

    regressor, progress = watched
    watch = Watched(pairs, SMALL.points.softening)
    for t in range(len(regressor.pairs)):
        points = AppearancePoints(
            regressor.corners[t], regressor.weights[t], regressor.offsets_mm[t],
            regressor.members[t], regressor.cell[t],
        )  # fmt: skip
        stage = Stage(
            points, regressor.pairs[t], regressor.thresholds[t], regressor.leaves[t],
            regressor.basis_mm[t],
        )  # fmt: skip
        watch.pass_on(stage)
    assert watch.error_px() == pytest.approx(progress[-1].plot["held_px"], rel=1e-6)


def test_a_moved_truth_is_measured_where_the_picture_shows_it(pairs):
    away = np.full((len(pairs.image), 3), 5.0, np.float32)
    moved = replace(
        pairs, shift_mm=-away, truth_mm=pairs.truth_mm + away[:, None],
        guess_mm=pairs.guess_mm + away[:, None],
    )  # fmt: skip
    here, there = (Watched(one, SMALL.points.softening).error_px() for one in (pairs, moved))
    assert there == pytest.approx(here, rel=1e-5)
