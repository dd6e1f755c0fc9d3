"""One Gauss-Newton step over all pictures and the identity that they share.

[Cao13, 4.1] alternates: poses and expressions with the identity fixed, then the identity with
those fixed. Both move together here: the pictures are eliminated one by one by the Schur
complement, as in bundle adjustment. Alternation crawls where an identity weight can be traded
for an expression or a shift in depth; this takes about ten steps from a mean face.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.box_least_squares import minimize_half_bounded
from core.fit_problem import N_POSE, State, linearise
from core.fit_space import FitSpace
from core.landmarks import N_INTERNAL
from core.picture_fit import Problem, damped, local_equations, picture_energy, step_bounds
from core.records import I32, BoolArray, FloatArray
from core.shared_equations import N_OFFSETS, SharedJacobian


@dataclass(frozen=True, slots=True, eq=False)
class Person:
    """What all pictures share.

    Attributes:
        identity: (I,) weights, standard normal in the population.
        offsets_mm: (60, 3) displacement of the internal landmarks from the model.
    """

    identity: FloatArray
    offsets_mm: FloatArray

    def moved(self, step: FloatArray) -> "Person":
        """Return the person after a step (I + 180,)."""
        n_identity = len(self.identity)
        offsets = self.offsets_mm + step[n_identity:].reshape(-1, 3)
        return Person(self.identity + step[:n_identity], offsets)

    def values(self) -> FloatArray:
        """Return identity and offsets in one row (I + 180,)."""
        return np.concatenate([self.identity, self.offsets_mm.ravel()])


@dataclass(frozen=True, slots=True, eq=False)
class JointProblem:
    """What is held fixed while a person is fitted.

    Attributes:
        pictures: Camera, landmarks and expression prior.
        space: The model at the picked points.
        picks: (N, L) point of each landmark.
        precision: (I + 180,) prior of the person: inverse variances.
    """

    pictures: Problem
    space: FitSpace
    picks: I32
    precision: FloatArray


def person_precision(n_identity: int, identity_weight: float, offset_mm: float) -> FloatArray:
    """Return the inverse variances (I + 180,) of a person's identity weights and offsets.

    Args:
        n_identity: I.
        identity_weight: What a squared identity weight costs.
        offset_mm: Usual size of the offsets; tiny values switch them off.
    """
    offsets = np.full(N_OFFSETS, offset_mm**-2.0)
    return np.concatenate([np.full(n_identity, identity_weight), offsets])


def joint_energy(joint: JointProblem, person: Person, state: State) -> float:
    """Return the cost of a person and all pictures."""
    face = joint.space.face(person.identity, person.offsets_mm)
    pictures = picture_energy(joint.pictures, face, state, joint.picks)
    return float(pictures.sum() + np.sum(joint.precision * person.values() ** 2))


def joint_step(
    joint: JointProblem, person: Person, state: State, damping: float
) -> tuple[Person, State]:
    """Return the person and the pictures after one damped step; the energy may have risen.

    Args:
        joint: What is held fixed.
        person: Identity and offsets.
        state: Poses and coefficients.
        damping: Relative enlargement of the diagonals.
    """
    problem, picks = joint.pictures, joint.picks
    face = joint.space.face(person.identity, person.offsets_mm)
    linear = linearise(problem.camera, face, state, picks, problem.observations)
    hessians, gradients, root = local_equations(problem, state, linear)
    hessians = damped(hessians, np.full(len(picks), damping))
    weights = root[..., None, None]
    shared = shared_jacobian(joint.space, state, picks, linear.lift, weights)
    cross = shared.cross(linear.local * weights)
    shared_hessian = shared.hessian() + np.diag(joint.precision)
    shared_hessian[np.diag_indices(len(joint.precision))] *= 1 + damping
    shared_gradient = shared.gradient(linear.residuals_px * root[..., None])
    shared_gradient += joint.precision * person.values()

    lower, upper = step_bounds(state.expressions)
    free = ~locked(gradients, lower, upper)
    step = _reduced_step(
        [hessian[np.ix_(some, some)] for hessian, some in zip(hessians, free, strict=True)],
        [
            np.column_stack([slope[some], mixed[some]])
            for slope, mixed, some in zip(gradients, cross, free, strict=True)
        ],
        shared_hessian,
        shared_gradient,
    )
    follow = gradients + cross @ step
    return person.moved(step), state.moved(minimize_half_bounded(hessians, follow, lower, upper))


def shared_jacobian(
    space: FitSpace, state: State, picks: I32, lift: FloatArray, weights: FloatArray
) -> SharedJacobian:
    """Return d(projection)/d(identity, offsets), times weights (N, L, 1, 1)."""
    weighted = lift * weights
    modes = space.identity_jacobians(state.expressions, picks)
    # Written out, since a batched product of such small matrices is slow.
    identity = weighted[..., 0, None] * modes[:, :, None, 0]
    identity += weighted[..., 1, None] * modes[:, :, None, 1]
    identity += weighted[..., 2, None] * modes[:, :, None, 2]
    return SharedJacobian(identity, weighted[:, :N_INTERNAL])


def locked(gradients: FloatArray, lower: FloatArray, upper: FloatArray) -> BoolArray:
    """Return which local variables (N, 6 + B) rest at a bound that they push against."""
    slope = gradients[:, N_POSE:]
    held = ((lower >= 0) & (slope > 0)) | ((upper <= 0) & (slope < 0))
    return np.concatenate([np.zeros((len(held), N_POSE), bool), held], axis=1)


def _reduced_step(
    hessians: Sequence[FloatArray],
    right_sides: Sequence[FloatArray],
    shared_hessian: FloatArray,
    shared_gradient: FloatArray,
) -> FloatArray:
    """Return the step (I + 180,) of the person when every picture follows as it likes.

    Args:
        hessians: N pictures' Hessians (F, F) of their free variables.
        right_sides: (F, 1 + I + 180) their gradient, then their Hessian with the person.
        shared_hessian: (I + 180, I + 180).
        shared_gradient: (I + 180,).
    """
    reduced, gradient = shared_hessian.copy(), shared_gradient.copy()
    for hessian, right in zip(hessians, right_sides, strict=True):
        eliminated = right[:, 1:].T @ np.linalg.solve(hessian, right)
        reduced -= eliminated[:, 1:]
        gradient -= eliminated[:, 0]
    return np.asarray(np.linalg.solve(reduced, -gradient))
