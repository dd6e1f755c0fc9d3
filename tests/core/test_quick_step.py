"""The Gauss-Newton step of the quick identity fit: exact slope, and what it recovers."""

from dataclasses import replace

import numpy as np
import pytest

from core.camera import camera_for
from core.fit_priors import PriorSettings, expression_prior
from core.fit_problem import Observations, State
from core.joint_step import Person
from core.model_fit import choose_picks
from core.picture_fit import Problem, StepSettings
from core.quick_step import (
    AT_ONCE,
    FOLLOWING,
    Guess,
    QuickProblem,
    follow,
    quick_energy,
    quick_precision,
    quick_step,
)
from tests.core.synthetic_fit import SIZE_PX, synthetic_pictures, synthetic_space

N_IDENTITY, FOCAL_PX = 8, 600.0


@pytest.fixture(scope="module")
def space():
    return synthetic_space(N_IDENTITY)


def problem_and_start(space, *, n_frames=8, focal_px=FOCAL_PX, focal_spread=0.3, huber=1e9):
    """Frames of a known person seen through 600 px, and the mean face in their true poses."""
    truth = synthetic_pictures(
        space, np.linspace(-1, 1, N_IDENTITY), np.random.default_rng(0), n_frames
    )
    camera = camera_for(SIZE_PX, focal_px)
    person = Person(np.zeros(N_IDENTITY), np.zeros((60, 3)))
    face = space.face(person.identity, person.offsets_mm)
    moved = truth.state.translations_mm * [1, 1, focal_px / FOCAL_PX]
    state = State(truth.state.rotations, moved, truth.state.expressions)
    points = np.stack([one.points_px for one in truth.landmarks])
    observations = Observations(points, np.full(points.shape[:2], 100.0), np.full(n_frames, 0.1))
    prior = expression_prior(np.full((n_frames, 46), np.nan), PriorSettings(slope=0.1))
    pictures = Problem(camera, observations, prior, StepSettings(huber_sigmas=huber))
    precision = quick_precision(N_IDENTITY, 0.01, focal_spread, 0.01)
    picks = choose_picks(space.face(truth.identity, person.offsets_mm), truth.state)
    problem = QuickProblem(space, pictures, picks, precision, focal_px)
    return problem, Guess(person, face, camera, state), truth


def finished(steps):
    """Return what a generator returns, and how many pieces it took."""
    pieces = 0
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value, pieces
        pieces += 1


def iterated(problem, guess, steps=12):
    for _ in range(steps):
        stepped, _ = finished(quick_step(problem, guess, 1e-5))
        guess = stepped.guess if stepped.after < stepped.before else guess
    return guess, stepped


def test_shared_slope_is_that_of_the_energy(space):
    """Heavy damping makes a step a short way down the slope: the gain falls as damping grows."""
    problem, start, _ = problem_and_start(space)
    everyone = np.arange(8, dtype=np.int32)
    start, _ = finished(follow(problem, start, everyone, 50))
    long, short, shorter = (
        finished(quick_step(problem, start, damping))[0].after for damping in (1e4, 1e5, 1e6)
    )
    assert long < short < shorter
    assert (short - long) / (shorter - short) == pytest.approx(10, rel=0.02)


def test_only_the_frames_asked_for_follow(space):
    problem, start, _ = problem_and_start(space, n_frames=5)
    followed, _ = finished(follow(problem, start, np.array([1, 3], np.int32), 5))
    changed = np.abs(followed.state.expressions - start.state.expressions).max(axis=1) > 0
    assert changed.tolist() == [False, True, False, True, False]
    assert quick_energy(problem, followed) < quick_energy(problem, start)


def test_work_comes_in_pieces_of_few_frames(space):
    problem, start, _ = problem_and_start(space, n_frames=12)
    _, pieces = finished(quick_step(problem, start, 1e-3))
    assert pieces == 12 / AT_ONCE + 2 + np.ceil(12 / FOLLOWING)


def test_recovers_identity_with_the_focal_length_known(space):
    problem, start, truth = problem_and_start(space, focal_spread=1e-4)
    guess, _ = iterated(problem, start)
    assert np.abs(guess.person.identity - truth.identity).max() < 0.1
    assert guess.camera.focal_px == pytest.approx(FOCAL_PX, rel=1e-5)


def test_recovers_focal_length_and_identity_together_from_turned_heads(space):
    problem, start, truth = problem_and_start(space, focal_px=700.0)
    guess, stepped = iterated(problem, start, 25)
    assert guess.camera.focal_px == pytest.approx(FOCAL_PX, rel=0.03)
    assert np.abs(guess.person.identity - truth.identity).max() < 0.15
    assert stepped.focal_spread < 0.1


def test_focal_length_stays_where_the_prior_has_it_if_the_prior_is_narrow(space):
    problem, start, _ = problem_and_start(space, focal_px=700.0, focal_spread=1e-5)
    guess, stepped = iterated(problem, start)
    assert guess.camera.focal_px == pytest.approx(700.0, rel=1e-4)
    assert stepped.focal_spread == pytest.approx(1e-5, rel=0.1)


def test_coefficients_stay_in_their_range(space):
    problem, start, _ = problem_and_start(space)
    wild = replace(start, state=replace(start.state, expressions=np.ones((8, 46))))
    guess, _ = iterated(problem, wild)
    assert guess.state.expressions.min() >= 0
    assert guess.state.expressions.max() <= 1


def test_energy_counts_the_distance_from_the_usual_focal_length(space):
    problem, start, _ = problem_and_start(space, focal_spread=0.1)
    other = replace(problem, usual_focal_px=problem.usual_focal_px * np.exp(0.2))
    assert quick_energy(other, start) - quick_energy(problem, start) == pytest.approx(4.0)
