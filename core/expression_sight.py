"""How well landmarks can tell each expression of one user, from geometry alone.

A blendshape that moves no landmark cannot be seen, and one that moves them as another does cannot
be told from it. Both follow from where the user's 75 landmarks go in the picture: the expected
error of each coefficient is that of a least-squares fit with the usual noise of landmarks and the
usual range of the others as a prior [cf. Cao13, eq. 7].
"""

from dataclasses import dataclass

import numpy as np

from core.camera import project
from core.face_model import FaceModel
from core.fit_priors import expression_spreads
from core.fit_problem import State
from core.fit_space import face_at
from core.landmarks import N_INTERNAL
from core.model_fit import FitSettings, choose_picks
from core.records import Camera, FloatArray, UserBlendshapes, freeze

#: Shapes that move the landmarks the opposite way are no rivals: a coefficient is never negative.
_OPPOSITE = -0.3


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """What landmarks tell about every expression.

    Attributes:
        largest_px: (B,) how far the full expression moves the landmark that it moves furthest.
        alone: (B,) share of the usual range that is told if no other shape may be there.
        certain: (B,) share that is told with all others there.
        likeness: (B, B) cosine between the ways in which two shapes move the landmarks.
    """

    largest_px: FloatArray
    alone: FloatArray
    certain: FloatArray
    likeness: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            largest_px=(np.float64, ("B",)),
            alone=(np.float64, ("B",)),
            certain=(np.float64, ("B",)),
            likeness=(np.float64, ("B", "B")),
        )


def sight_of(
    model: FaceModel, user: UserBlendshapes, camera: Camera, distance_mm: float,
    settings: FitSettings | None = None,
) -> Sight:  # fmt: skip
    """Return what the landmarks of a face that looks into the camera tell.

    Args:
        model: The face model.
        user: The user's blendshapes.
        camera: Of the setup pictures.
        distance_mm: Of the face from the camera.
        settings: Noise of the landmarks and weight of the outline.
    """
    settings = settings or FitSettings()
    moves = _moves_px(model, user, camera, distance_mm)
    trust = np.ones(moves.shape[1])
    trust[N_INTERNAL:] = settings.contour_weight
    noise_px = settings.noise_mm * camera.focal_px / distance_mm
    flat = (moves * np.sqrt(trust)[:, None] / noise_px).reshape(len(moves), -1)
    told = flat @ flat.T
    sizes = np.sqrt(np.diag(told)) + 1e-12
    likeness, spreads = told / np.outer(sizes, sizes), expression_spreads()
    return Sight(
        np.linalg.norm(moves, axis=2).max(axis=1),
        1 - 1 / np.sqrt(1 + (sizes * spreads) ** 2),
        np.array([_certain(told, likeness, spreads, b) for b in range(len(told))]),
        likeness - np.eye(len(told)),
    )


def _moves_px(
    model: FaceModel, user: UserBlendshapes, camera: Camera, distance_mm: float
) -> FloatArray:
    """Return how every full expression moves the landmarks, (B, 75, 2) px."""
    face = face_at(model, user)
    n_shapes = len(face.deltas_mm)
    ahead = State(np.eye(3)[None], np.array([[0.0, 0.0, distance_mm]]), np.zeros((1, n_shapes)))
    picks = choose_picks(face, ahead)[0]
    resting = face.neutral_mm[picks] + ahead.translations_mm[0]
    return np.asarray(
        project(camera, resting + face.deltas_mm[:, picks]) - project(camera, resting)
    )


def _certain(told: FloatArray, likeness: FloatArray, spreads: FloatArray, b: int) -> float:
    rivals = np.flatnonzero(likeness[b] > _OPPOSITE)
    precision = told[np.ix_(rivals, rivals)] + np.diag(spreads[rivals] ** -2.0)
    left = np.linalg.inv(precision)[(rivals == b).argmax(), (rivals == b).argmax()]
    return float(1 - np.sqrt(left) / spreads[b])
