"""The landmark error of posed faces and its derivatives: what all fits minimise.

For every picture: 6 pose numbers and B coefficients. The pose step is a rotation vector applied
after the present rotation, and a translation: R <- exp(w) R, t <- t + d.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.camera import project, project_jacobian
from core.fit_space import Face
from core.geometry import matrix_from_quaternion
from core.landmarks import N_INTERNAL
from core.posit import pose_from_points
from core.records import I32, BoolArray, Camera, FloatArray, Landmarks2D

N_POSE = 6


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """The landmarks of all pictures and how far to trust them.

    Attributes:
        points_px: (N, L, 2).
        weights: (N, L) confidence over the variance, in 1/px^2.
        sigma_px: (N,) expected landmark noise, proportional to the size of the face.
    """

    points_px: FloatArray
    weights: FloatArray
    sigma_px: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """Poses and coefficients of all pictures.

    Attributes:
        rotations: (N, 3, 3) model to camera.
        translations_mm: (N, 3).
        expressions: (N, B).
    """

    rotations: FloatArray
    translations_mm: FloatArray
    expressions: FloatArray

    def moved(self, steps: FloatArray) -> "State":
        """Return the state after steps (N, 6 + B), coefficients kept in [0, 1]."""
        turns = turns_of(steps[:, :3])
        return State(
            turns @ self.rotations,
            self.translations_mm + steps[:, 3:N_POSE],
            np.clip(self.expressions + steps[:, N_POSE:], 0.0, 1.0),
        )

    def where(self, better: BoolArray, other: "State") -> "State":
        """Return the other state in the pictures where it is better, (N,) bool, else this."""
        return State(
            np.where(better[:, None, None], other.rotations, self.rotations),
            np.where(better[:, None], other.translations_mm, self.translations_mm),
            np.where(better[:, None], other.expressions, self.expressions),
        )


def turns_of(vectors_rad: FloatArray) -> FloatArray:
    """Return the matrices (N, 3, 3) of rotation vectors (N, 3)."""
    half = 0.5 * np.linalg.norm(vectors_rad, axis=1, keepdims=True)
    # numpy's sinc is sin(pi x) / (pi x).
    return matrix_from_quaternion(
        np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * vectors_rad], axis=1)
    )


@dataclass(frozen=True, slots=True, eq=False)
class Linearised:
    """Residuals and their derivatives at a state, all unweighted.

    Attributes:
        residuals_px: (N, L, 2) projection minus landmark.
        lift: (N, L, 2, 3) d(projection)/d(point in the model frame), px/mm.
        local: (N, L, 2, 6 + B) d(projection)/d(pose step, coefficients).
    """

    residuals_px: FloatArray
    lift: FloatArray
    local: FloatArray


def posed(points_mm: FloatArray, state: State) -> FloatArray:
    """Return model-frame points (N, P, 3) in the camera frame."""
    turned = points_mm @ np.swapaxes(state.rotations, 1, 2)
    return np.asarray(turned + state.translations_mm[:, None])


def picked(face: Face, state: State, picks: I32) -> FloatArray:
    """Return the picked points (N, L, 3) of each picture in the camera frame."""
    points = face.points_mm(state.expressions)
    return posed(np.take_along_axis(points, picks[..., None], axis=1), state)


def residuals_px(
    camera: Camera, face: Face, state: State, picks: I32, observations: Observations
) -> FloatArray:
    """Return projection minus landmark, (N, L, 2)."""
    return project(camera, picked(face, state, picks)) - observations.points_px


def linearise(
    camera: Camera, face: Face, state: State, picks: I32, observations: Observations
) -> Linearised:
    """Return the residuals of all pictures and their derivatives."""
    in_camera = picked(face, state, picks)
    to_image = project_jacobian(camera, in_camera)
    lift = to_image @ state.rotations[:, None]
    turned = in_camera - state.translations_mm[:, None]
    local = np.empty((*lift.shape[:3], N_POSE + len(face.deltas_mm)))
    # d(exp(w) x)/dw = -[x]_x, and row @ -[x]_x = x cross row.
    local[..., :3] = np.cross(turned[:, :, None], to_image)
    local[..., 3:N_POSE] = to_image
    deltas = face.deltas_mm.transpose(1, 2, 0)[picks]
    np.matmul(lift, deltas, out=local[..., N_POSE:])
    residuals = project(camera, in_camera) - observations.points_px
    return Linearised(residuals, lift, local)


def robust_weights(
    residuals: FloatArray, observations: Observations, huber_sigmas: float
) -> FloatArray:
    """Return the weights (N, L) that make a quadratic cost act like Huber's at this point."""
    distance = np.linalg.norm(residuals, axis=-1) / observations.sigma_px[:, None]
    return np.asarray(observations.weights * huber_sigmas / np.maximum(distance, huber_sigmas))


def landmark_energy(
    residuals: FloatArray, observations: Observations, huber_sigmas: float
) -> FloatArray:
    """Return Huber's cost (N,) of residuals (N, L, 2): squared sigmas, linear when far."""
    sigmas = np.linalg.norm(residuals, axis=-1) / observations.sigma_px[:, None]
    far = 2 * huber_sigmas * sigmas - huber_sigmas**2
    cost = np.where(sigmas < huber_sigmas, sigmas**2, far)
    trust = observations.weights * observations.sigma_px[:, None] ** 2
    return np.asarray(np.sum(trust * cost, axis=1))


def rms_px(residuals: FloatArray, observations: Observations) -> FloatArray:
    """Return the root mean square landmark distance (N,), weighted by confidence."""
    squares = np.sum(residuals**2, axis=-1)
    weights = observations.weights + 1e-12
    return np.asarray(np.sqrt(np.sum(weights * squares, axis=1) / weights.sum(axis=1)))


def start_state(
    camera: Camera, neutral_mm: FloatArray, landmarks: Sequence[Landmarks2D], n_shapes: int
) -> State:
    """Return poses from POSIT on the internal landmarks of a neutral face."""
    poses = [
        pose_from_points(
            camera, neutral_mm[:N_INTERNAL], one.points_px[:N_INTERNAL],
            one.confidence[:N_INTERNAL],
        )
        for one in landmarks
    ]  # fmt: skip
    rotations, translations = (np.stack(parts) for parts in zip(*poses, strict=True))
    return State(rotations, translations, np.zeros((len(poses), n_shapes)))
