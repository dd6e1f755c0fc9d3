"""One Gauss-Newton step over a few frames, the face and the focal length, in small pieces.

The step is that of `joint_step`: each frame is eliminated by its Schur complement. Live tracking
cannot wait for all frames, so it is cut: two frames are eliminated per piece, then the shared
unknowns are solved for, then the frames are fitted to the new face, a few per piece. That last
part `joint_step` does without; with it four to eight steps do what took eighteen, because
coefficients that the step drove into their bounds find their places before it is judged.

The logarithm of the focal length is one more shared unknown. Perspective and the depth of a face
look alike; solved for together they are traded for what both usually are, and the system tells how
well the focal length is known.
"""

from collections.abc import Generator
from dataclasses import dataclass, replace

import numpy as np

from core.box_least_squares import minimize_half_bounded
from core.fit_priors import ExpressionPrior
from core.fit_problem import Linearised, Observations, State, linearise
from core.fit_space import Face, FitSpace
from core.joint_step import Person, locked
from core.landmarks import N_INTERNAL
from core.picture_fit import (
    Problem,
    damped,
    fit_pictures,
    local_equations,
    picture_energy,
    step_bounds,
)
from core.records import I32, Camera, FloatArray
from core.shared_equations import N_OFFSETS, SharedJacobian

#: Frames eliminated, and frames fitted to the new face, in one piece of work.
AT_ONCE, FOLLOWING = 2, 8


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """What is fitted: the face, the camera and every frame.

    Attributes:
        person: Identity and offsets.
        face: The face of this person.
        camera: Its focal length is part of the guess.
        state: Poses and coefficients of N frames.
    """

    person: Person
    face: Face
    camera: Camera
    state: State


@dataclass(frozen=True, slots=True, eq=False)
class QuickProblem:
    """What is held fixed during a step.

    Attributes:
        space: The model at the points of a fit.
        pictures: Landmarks and expression prior of N frames.
        picks: (N, L) point of each landmark.
        precision: (I + 1 + 180,) inverse variances of identity, log focal length and offsets.
        usual_focal_px: Middle of the focal length's prior.
    """

    space: FitSpace
    pictures: Problem
    picks: I32
    precision: FloatArray
    usual_focal_px: float


@dataclass(frozen=True, slots=True, eq=False)
class Stepped:
    """The outcome of a step.

    Attributes:
        guess: After the step.
        before: Energy of the start.
        after: Energy of `guess`; the step is a bad one if it rose.
        focal_spread: Standard deviation of the logarithm of the focal length.
    """

    guess: Guess
    before: float
    after: float
    focal_spread: float


@dataclass(frozen=True, slots=True, eq=False)
class _Eliminated:
    """One frame's equations, and what they leave for the shared unknowns."""

    hessian: FloatArray
    gradient: FloatArray
    cross: FloatArray
    reduced: FloatArray
    slope: FloatArray


def quick_precision(
    n_identity: int, identity_weight: float, focal_spread: float, offset_mm: float
) -> FloatArray:
    """Return the inverse variances (I + 1 + 180,) of identity, log focal length and offsets."""
    focal = [focal_spread**-2.0]
    offsets = np.full(N_OFFSETS, offset_mm**-2.0)
    return np.concatenate([np.full(n_identity, identity_weight), focal, offsets])


def quick_energy(problem: QuickProblem, guess: Guess) -> float:
    """Return the cost of a guess."""
    pictures = replace(problem.pictures, camera=guess.camera)
    energies = picture_energy(pictures, guess.face, guess.state, problem.picks)
    return float(energies.sum() + np.sum(problem.precision * _values(problem, guess) ** 2))


def quick_step(
    problem: QuickProblem, guess: Guess, damping: float
) -> Generator[None, None, Stepped]:
    """Return the guess after one damped step.

    Args:
        problem: What is held fixed.
        guess: The start.
        damping: Relative enlargement of the diagonals.

    Yields:
        Nothing, after each piece of work of a few milliseconds.
    """
    eliminated = []
    for frame in range(len(problem.picks)):
        eliminated.append(_eliminate(problem, guess, frame, damping))
        if frame % AT_ONCE:
            yield
    step, focal_spread = _solve(problem, guess, eliminated, damping)
    yield
    moved = _moved(problem, guess, step, eliminated)
    yield
    everyone = np.arange(len(problem.picks), dtype=np.int32)
    moved = yield from follow(problem, moved, everyone, 1)
    before, after = quick_energy(problem, guess), quick_energy(problem, moved)
    return Stepped(moved, before, after, focal_spread)


def follow(
    problem: QuickProblem, guess: Guess, frames: I32, iterations: int
) -> Generator[None, None, Guess]:
    """Return the guess with some frames fitted to its face.

    Args:
        problem: What is held fixed.
        guess: The start.
        frames: Numbers of the frames.
        iterations: Most Levenberg-Marquardt steps of each.

    Yields:
        Nothing, after each piece of work.
    """
    settings = replace(problem.pictures.settings, iterations=iterations)
    n_pieces = -(-len(frames) // FOLLOWING)
    for rows in np.array_split(frames, max(n_pieces, 1)):
        pictures = replace(_picture(problem.pictures, guess.camera, rows), settings=settings)
        fitted = fit_pictures(pictures, guess.face, _rows(guess.state, rows), problem.picks[rows])
        guess = replace(guess, state=_with_rows(guess.state, rows, fitted))
        yield
    return guess


def _values(problem: QuickProblem, guess: Guess) -> FloatArray:
    log_focal = np.log(guess.camera.focal_px / problem.usual_focal_px)
    person = guess.person
    return np.concatenate([person.identity, [log_focal], person.offsets_mm.ravel()])


def _solve(
    problem: QuickProblem, guess: Guess, eliminated: list[_Eliminated], damping: float
) -> tuple[FloatArray, float]:
    """Return the step (I + 1 + 180,) of what is shared, and the spread of the log focal length."""
    reduced = np.diag(problem.precision * (1 + damping))
    slope = problem.precision * _values(problem, guess)
    for one in eliminated:
        reduced += one.reduced
        slope += one.slope
    focal = guess.person.identity.size
    wanted = np.stack([-slope, np.eye(len(slope))[focal]], axis=1)
    solved = np.linalg.solve(reduced, wanted)
    return solved[:, 0], float(np.sqrt(solved[focal, 1]))


def _eliminate(problem: QuickProblem, guess: Guess, frame: int, damping: float) -> _Eliminated:
    """Return one frame's equations."""
    one = np.array([frame], dtype=np.int32)
    state, picks = _rows(guess.state, one), problem.picks[one]
    pictures = _picture(problem.pictures, guess.camera, one)
    linear = linearise(guess.camera, guess.face, state, picks, pictures.observations)
    hessians, gradients, root = local_equations(pictures, state, linear)
    hessian, gradient = damped(hessians, np.array([damping]))[0], gradients[0]
    shared = _shared_jacobian(problem.space, pictures, state, picks, linear, root)
    cross = shared.cross(linear.local * root[..., None, None])[0]
    lower, upper = step_bounds(state.expressions)
    free = ~locked(gradients, lower, upper)[0]
    right = np.column_stack([gradient[free], cross[free]])
    known = right[:, 1:].T @ np.linalg.solve(hessian[np.ix_(free, free)], right)
    own = shared.hessian()
    own[np.diag_indices(len(own))] *= 1 + damping
    slope = shared.gradient(linear.residuals_px * root[..., None])
    return _Eliminated(hessian, gradient, cross, own - known[:, 1:], slope - known[:, 0])


def _shared_jacobian(
    space: FitSpace, pictures: Problem, state: State, picks: I32, linear: Linearised,
    root: FloatArray,
) -> SharedJacobian:  # fmt: skip
    """Return the derivatives of one frame's landmarks by what all frames share."""
    lift = linear.lift * root[..., None, None]
    identity = lift @ _identity_modes(space, state.expressions[0], picks[0])
    # d(focal x / z)/d(log focal) is the place in the picture, counted from its centre.
    centred = linear.residuals_px + pictures.observations.points_px - pictures.camera.center_px
    focal = (centred * root[..., None])[..., None]
    return SharedJacobian(np.concatenate([identity, focal], axis=-1), lift[:, :N_INTERNAL])


def _identity_modes(space: FitSpace, expression: FloatArray, picks: I32) -> FloatArray:
    """Return d(picked points)/d(identity), (L, 3, I) in mm, touching only the shapes in use."""
    modes = space.identity_modes_mm[picks]
    for shape in np.flatnonzero(expression):
        modes += expression[shape] * space.delta_modes_mm[shape, picks, :, 1:]
    return modes


def _moved(
    problem: QuickProblem, guess: Guess, step: FloatArray, eliminated: list[_Eliminated]
) -> Guess:
    """Return the guess after a step (I + 1 + 180,), the frames following it."""
    n_identity = guess.person.identity.size
    person = guess.person.moved(np.delete(step, n_identity))
    focal_px = guess.camera.focal_px * float(np.exp(step[n_identity]))
    follow = np.stack([one.gradient + one.cross @ step for one in eliminated])
    hessians = np.stack([one.hessian for one in eliminated])
    lower, upper = step_bounds(guess.state.expressions)
    state = guess.state.moved(minimize_half_bounded(hessians, follow, lower, upper))
    face = problem.space.face(person.identity, person.offsets_mm)
    return Guess(person, face, replace(guess.camera, focal_px=focal_px), state)


def _rows(state: State, rows: I32) -> State:
    return State(state.rotations[rows], state.translations_mm[rows], state.expressions[rows])


def _with_rows(state: State, rows: I32, fitted: State) -> State:
    """Return the state with some frames replaced."""
    chosen = np.isin(np.arange(len(state.rotations)), rows)
    out = State(state.rotations.copy(), state.translations_mm.copy(), state.expressions.copy())
    out.rotations[chosen] = fitted.rotations
    out.translations_mm[chosen] = fitted.translations_mm
    out.expressions[chosen] = fitted.expressions
    return out


def _picture(pictures: Problem, camera: Camera, rows: I32) -> Problem:
    """Return the problem of some of the frames."""
    seen, prior = pictures.observations, pictures.prior
    return replace(
        pictures,
        camera=camera,
        observations=Observations(seen.points_px[rows], seen.weights[rows], seen.sigma_px[rows]),
        prior=ExpressionPrior(prior.mean[rows], prior.precision[rows], prior.slope[rows]),
    )
