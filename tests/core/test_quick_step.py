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
from core.quick_step import Guess, QuickProblem, quick_energy, quick_precision, quick_step
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


def test_energy_falls_as_much_as_a_nearly_linear_problem_promises(space):
    """Heavy damping makes a step a short way down the slope: its gain is its own prediction."""
    problem, start, _ = problem_and_start(space)
    small, _ = finished(quick_step(problem, start, 1e4))
    tiny, _ = finished(quick_step(problem, start, 1e5))
    assert 0 < tiny.before - tiny.after < small.before - small.after
    ratio = (small.before - small.after) / (tiny.before - tiny.after)
    assert ratio == pytest.approx(10, rel=0.05)


def test_work_comes_in_one_piece_per_frame_and_one_for_solving(space):
    problem, start, _ = problem_and_start(space, n_frames=5)
    _, pieces = finished(quick_step(problem, start, 1e-3))
    assert pieces == 6


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
