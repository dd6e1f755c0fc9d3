"""How far the landmark network is off, on average over people, from each side of the head.

The network was trained on pictures whose turned heads were labelled by eye: it draws the far half
of the face towards the outline, and its points are not quite our vertices. Both differ little from
person to person, so they can be measured on rendered people and taken off again. Left in, they
look like another focal length: perspective, too, moves the points of turned heads.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.geometry import head_angles_from_matrix
from core.landmarks import N_INTERNAL
from core.records import FloatArray, freeze

#: Angles beyond these are treated like these; nothing was measured there.
FURTHEST_RAD = np.deg2rad([60.0, 30.0])


@dataclass(frozen=True, slots=True, eq=False)
class AlignerBias:
    """The mean error of each internal landmark as a polynomial of the head's angles.

    Attributes:
        coefficients_mm: (60, 2, K) in the head's upright picture plane, for K `features`.
    """

    coefficients_mm: FloatArray

    def __post_init__(self) -> None:
        freeze(self, coefficients_mm=(np.float64, (N_INTERNAL, 2, "K")))

    def error_px(self, rotation: FloatArray, px_per_mm: float) -> FloatArray:
        """Return the mean error (60, 2) of the landmarks of a head.

        Args:
            rotation: (3, 3) model to camera, as the network's own points give it.
            px_per_mm: Scale of the face in the picture.
        """
        yaw, pitch, roll = head_angles_from_matrix(rotation)
        upright = self.coefficients_mm @ features(np.array([yaw, pitch]))
        return px_per_mm * upright @ in_plane(roll).T


def features(angles_rad: FloatArray) -> FloatArray:
    """Return the terms (..., K) of the polynomial at yaw and pitch (..., 2)."""
    yaw, pitch = np.moveaxis(np.clip(angles_rad, -FURTHEST_RAD, FURTHEST_RAD), -1, 0)
    one = np.ones_like(yaw)
    terms = [one, yaw, pitch, yaw**2, yaw * pitch, pitch**2, yaw**3, yaw**2 * pitch]
    return np.stack(terms, axis=-1)


def in_plane(roll_rad: float) -> FloatArray:
    """Return the rotation (2, 2) of the picture plane by a head's roll."""
    c, s = np.cos(roll_rad), np.sin(roll_rad)
    return np.array([[c, -s], [s, c]])


def load_aligner_bias(path: Path) -> AlignerBias:
    """Return the bias of a file made by assets/build/aligner_bias.py."""
    with np.load(path, allow_pickle=False) as arrays:
        return AlignerBias(arrays["coefficients_mm"])
