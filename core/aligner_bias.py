"""How far the landmark network is off on such a face, seen from such a side.

The network was trained on pictures whose turned heads were labelled by eye: it draws the far half
of the face towards the outline, draws everybody towards the average, and its points are not quite
our vertices. How far it is off can be foretold from what it answers: from the head's angles, and
from the shape of all its points with the pose taken out, which tells of the person and of the
expression. It was measured on rendered people. Left in, the errors look like another focal
length: perspective, too, moves the points of turned heads.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.geometry import head_angles_from_matrix
from core.landmarks import N_INTERNAL
from core.records import I32, FloatArray, freeze

#: Yaw and pitch beyond these are treated like these; nothing was measured there.
FURTHEST_RAD = np.deg2rad([63.0, 34.0])
#: So many standard deviations a face's shape may differ from the average in one respect; stranger
#: shapes are treated like these, which bounds the correction.
STRANGEST = 3.0
#: The error of so many respects of shape, the strongest, changes with the head's angles.
N_TURNING = 60


@dataclass(frozen=True, slots=True, eq=False)
class AlignerBias:
    """The mean error of each internal landmark, linear in the `features` of angles and shape.

    Attributes:
        points: (P,) network points that tell the shape of a face.
        mean_mm: (P, 3) their mean, in the model frame around its centroid.
        modes_per_mm: (K, P, 3) products with a shape's difference from the mean give K numbers
            of standard deviation 1.
        coefficients_mm: (60, 2, F) in the head's upright picture plane.
    """

    points: I32
    mean_mm: FloatArray
    modes_per_mm: FloatArray
    coefficients_mm: FloatArray

    def __post_init__(self) -> None:
        n_features = features(np.zeros(2), np.zeros(len(self.modes_per_mm))).shape[-1]
        freeze(
            self,
            points=(np.int32, ("P",)),
            mean_mm=(np.float64, ("P", 3)),
            modes_per_mm=(np.float64, ("K", "P", 3)),
            coefficients_mm=(np.float64, (N_INTERNAL, 2, n_features)),
        )

    def error_px(
        self, mesh_px: FloatArray, depth_px: FloatArray, rotation: FloatArray, px_per_mm: float
    ) -> FloatArray:
        """Return the foretold error (60, 2) of the internal landmarks of a face.

        Args:
            mesh_px: (478, 2) all points of the network.
            depth_px: (478,) away from the camera.
            rotation: (3, 3) model to camera, as the network's own points give it.
            px_per_mm: Scale of the face in the picture.
        """
        points_px = np.column_stack([mesh_px[self.points], depth_px[self.points]])
        flat = (unposed_mm(points_px, rotation, px_per_mm) - self.mean_mm).ravel()
        shape = self.modes_per_mm.reshape(-1, flat.size) @ flat
        yaw, pitch, roll = head_angles_from_matrix(rotation)
        upright_mm = self.coefficients_mm @ features(np.array([yaw, pitch]), shape)
        return np.asarray(px_per_mm * upright_mm @ in_plane(roll).T)


def unposed_mm(points_px: FloatArray, rotation: FloatArray, px_per_mm: float) -> FloatArray:
    """Return points (P, 3) of a picture, with depth, in the model frame around their centroid."""
    return np.asarray((points_px - points_px.mean(axis=0)) @ rotation / px_per_mm)


def features(angles_rad: FloatArray, shape: FloatArray) -> FloatArray:
    """Return the terms (..., F) that errors are linear in.

    Args:
        angles_rad: (..., 2) yaw and pitch.
        shape: (..., K) in standard deviations, the strongest respects first.
    """
    yaw, pitch = np.moveaxis(np.clip(angles_rad, -FURTHEST_RAD, FURTHEST_RAD), -1, 0)
    one = np.ones_like(yaw)
    terms = [
        one, yaw, pitch, yaw**2, yaw * pitch, pitch**2,
        yaw**3, yaw**2 * pitch, yaw * pitch**2, pitch**3, yaw**4,
    ]  # fmt: skip
    shape = np.clip(shape, -STRANGEST, STRANGEST)
    turned = [shape[..., :N_TURNING] * by[..., None] for by in (yaw, pitch, yaw**2)]
    return np.concatenate([np.stack(terms, axis=-1), shape, *turned], axis=-1)


def in_plane(roll_rad: float) -> FloatArray:
    """Return the rotation (2, 2) of the picture plane by a head's roll."""
    c, s = np.cos(roll_rad), np.sin(roll_rad)
    return np.array([[c, -s], [s, c]])


def load_aligner_bias(path: Path) -> AlignerBias:
    """Return the bias of a file made by assets/build/aligner_bias.py."""
    with np.load(path, allow_pickle=False) as arrays:
        return AlignerBias(
            arrays["points"],
            arrays["mean_mm"],
            arrays["modes_per_mm"],
            arrays["coefficients_mm"],
        )
