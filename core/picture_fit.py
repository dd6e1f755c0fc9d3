"""Pose and expression of each picture while the face itself is known."""

from dataclasses import dataclass

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.box_least_squares import minimize_half_bounded
from core.fit_priors import ExpressionPrior
from core.fit_problem import (
    N_POSE,
    Linearised,
    Observations,
    State,
    landmark_energy,
    linearise,
    residuals_px,
    robust_weights,
)
from core.fit_space import Face
from core.records import I32, Camera, FloatArray

_JAW_OPEN = EXPRESSION_NAMES.index("jawOpen")
_MOUTH_CLOSE = EXPRESSION_NAMES.index("mouthClose")
#: Levenberg-Marquardt: start, factor after a good and after a bad step.
_DAMPING, _LESS, _MORE = 1e-3, 0.2, 10.0


@dataclass(frozen=True, slots=True)
class StepSettings:
    """How the fits iterate.

    Attributes:
        huber_sigmas: Landmarks further off than this many sigmas count linearly.
        iterations: Most Gauss-Newton steps of one call.
        tolerance: Stop when no energy falls by more than this share.
    """

    huber_sigmas: float = 2.0
    iterations: int = 12
    tolerance: float = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """What is held fixed while pictures are fitted."""

    camera: Camera
    observations: Observations
    prior: ExpressionPrior
    settings: StepSettings


def picture_energy(problem: Problem, face: Face, state: State, picks: I32) -> FloatArray:
    """Return the cost (N,) of each picture: landmarks and expression prior."""
    residuals = residuals_px(problem.camera, face, state, picks, problem.observations)
    huber = problem.settings.huber_sigmas
    return landmark_energy(residuals, problem.observations, huber) + problem.prior.energy(
        state.expressions
    )


def local_equations(
    problem: Problem, state: State, linear: Linearised
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return half Hessians (N, 6 + B, 6 + B), half gradients (N, 6 + B) and root weights (N, L)."""
    weights = robust_weights(
        linear.residuals_px, problem.observations, problem.settings.huber_sigmas
    )
    root = np.sqrt(weights)
    n_pictures, n_local = len(weights), linear.local.shape[-1]
    jacobian = (linear.local * root[..., None, None]).reshape(n_pictures, -1, n_local)
    residuals = (linear.residuals_px * root[..., None]).reshape(n_pictures, -1, 1)
    transposed = np.swapaxes(jacobian, 1, 2)
    hessians = transposed @ jacobian
    gradients = (transposed @ residuals)[..., 0]
    gradients[:, N_POSE:] += problem.prior.half_gradient(state.expressions)
    diagonal = np.arange(N_POSE, n_local)
    hessians[:, diagonal, diagonal] += problem.prior.precision
    return hessians, gradients, root


def step_bounds(expressions: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far each coefficient (N, B) may go down and up.

    mouthClose closes the lips over an open jaw, so it stays below jawOpen.
    """
    upper = 1.0 - expressions
    upper[:, _MOUTH_CLOSE] = np.maximum(
        expressions[:, _JAW_OPEN] - expressions[:, _MOUTH_CLOSE], 0.0
    )
    return -expressions, upper


def damped(hessians: FloatArray, damping: FloatArray) -> FloatArray:
    """Return Hessians with their diagonals enlarged by a factor 1 + damping (N,)."""
    out = hessians.copy()
    diagonal = np.arange(out.shape[-1])
    out[:, diagonal, diagonal] *= 1 + damping[:, None]
    return out


def fit_pictures(problem: Problem, face: Face, start: State, picks: I32) -> State:
    """Return the poses and coefficients that fit a known face best [Cao13, eq. 8].

    Levenberg-Marquardt on all pictures side by side, pose and coefficients together.

    Args:
        problem: Camera, landmarks and prior.
        face: The person.
        start: A start for every picture.
        picks: (N, L) point of each landmark.
    """
    state, damping = start, np.full(len(picks), _DAMPING)
    energy = picture_energy(problem, face, state, picks)
    for _ in range(problem.settings.iterations):
        linear = linearise(problem.camera, face, state, picks, problem.observations)
        hessians, gradients, _ = local_equations(problem, state, linear)
        lower, upper = step_bounds(state.expressions)
        steps = minimize_half_bounded(damped(hessians, damping), gradients, lower, upper)
        tried = state.moved(steps)
        tried_energy = picture_energy(problem, face, tried, picks)
        better = tried_energy < energy
        gain = np.where(better, energy - tried_energy, 0.0)
        state = state.where(better, tried)
        energy = np.where(better, tried_energy, energy)
        damping = np.clip(damping * np.where(better, _LESS, _MORE), 1e-6, 1e6)
        if better.any() and np.all(gain < problem.settings.tolerance * energy):
            break
    return state
