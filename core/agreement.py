"""How far a tracker's landmarks are from those of the generic aligner."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from core.landmarks import N_INTERNAL
from core.records import FloatArray, Landmarks2D, Shape3D


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """What the generic aligner saw in a frame, and what the regressor made of the same frame.

    Attributes:
        landmarks: The aligner's.
        shape: The regressor's.
        disagreement: Distance between both, see `disagreement`.
        agrees: Whether the regressor can be followed from here.
    """

    landmarks: Landmarks2D
    shape: Shape3D
    disagreement: float
    agrees: bool


class Misfits(NamedTuple):
    """How far faces stay from landmarks, as `disagreement`, after pose and expression are fitted.

    Attributes:
        own: The profile's.
        mean: The face model's mean face.
    """

    own: float
    mean: float


def disagreement(points_px: FloatArray, landmarks: Landmarks2D) -> float:
    """Return the RMS distance from an aligner's internal landmarks in parts of the face's size.

    The unit is the distance of the outer eye corners, or on a turned head the height from brows
    to lower lip that goes with it; the aligner's confidence weighs the landmarks.

    Args:
        points_px: (L, 2).
        landmarks: The aligner's.
    """
    aligned = landmarks.points_px[:N_INTERNAL]
    weights = landmarks.confidence[:N_INTERNAL] + 1e-6
    squares = np.sum((points_px[:N_INTERNAL] - aligned) ** 2, axis=1)
    # Faces are about as high from brow to lip as wide from eye corner to eye corner.
    size = max(float(np.ptp(aligned[:, 0])), float(np.ptp(aligned[:, 1])))
    return float(np.sqrt(np.average(squares, weights=weights)) / max(size, 1.0))
