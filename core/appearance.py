"""Points that ride on a face shape, and their grey levels in a picture."""

from dataclasses import dataclass

import numpy as np

from core.kernels.appearance import move_shapes, normalise_cells, project_points, sample_image
from core.records import F32, I32, U8, FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class AppearancePoints:
    """Points that ride on a face shape, and the cells in which their contrast is measured.

    Attributes:
        corners: (P, 3) shape points that carry each point.
        weights: (P, 3) barycentric coordinates, sum 1; negative outside the triangle.
        offsets: (P, 3) mm, added in the frame of the shape space; zero for barycentric points.
        members: (C, n) points on which a cell's mean and contrast are measured.
        cell: (P,) the cell of each point.
    """

    corners: I32
    weights: F32
    offsets: F32
    members: I32
    cell: I32

    def __post_init__(self) -> None:
        freeze(
            self,
            corners=(np.int32, ("P", 3)),
            weights=(np.float32, ("P", 3)),
            offsets=(np.float32, ("P", 3)),
            members=(np.int32, ("C", "n")),
            cell=(np.int32, ("P",)),
        )


class AppearanceReader:
    """Reads the appearance of several shapes at once, without allocating.

    Attributes:
        shapes: (Q, 3, R) mm, the shapes to read at, to be written by the caller.
        intensities: (P, R) what was read last.
    """

    def __init__(self, n_shape_points: int, points: AppearancePoints, n_runs: int) -> None:
        """Make room for R shapes and for points like the given ones."""
        n_points, n_cells = len(points.corners), len(points.members)
        self.shapes: F32 = np.zeros((n_shape_points, 3, n_runs), np.float32)
        self.intensities: F32 = np.empty((n_points, n_runs), np.float32)
        self._in_camera = np.empty((n_shape_points, 3, n_runs), np.float32)
        self._offsets = np.empty((n_points, 3), np.float32)
        self._positions = np.empty((n_points, 2, n_runs), np.float32)
        self._mean = np.empty((n_cells, n_runs), np.float32)
        self._scale = np.empty((n_cells, n_runs), np.float32)
        self._to_camera = np.eye(3, dtype=np.float32)
        self._shift = np.zeros(3, np.float32)

    def place(self, rotation: FloatArray, center_mm: FloatArray) -> None:
        """Set the inverse of M^a: turn the shapes back by `rotation`, move them to `center_mm`."""
        self._to_camera[:] = rotation.T
        self._shift[:] = center_mm

    def read(self, gray: U8, projection: F32, points: AppearancePoints, softening: float) -> F32:
        """Return the appearance (P, R) of the shapes, valid until the next call.

        Args:
            gray: (H, W).
            projection: (3,) focal length and principal point, px.
            points: Where to look.
            softening: Grey levels added to the local contrast; 0: raw grey levels.
        """
        move_shapes(self.shapes, self._to_camera, self._shift, self._in_camera)
        np.matmul(points.offsets, self._to_camera.T, out=self._offsets)
        project_points(
            self._in_camera,
            points.corners,
            points.weights,
            self._offsets,
            projection,
            self._positions,
        )
        sample_image(gray, self._positions, self.intensities)
        if softening > 0:
            normalise_cells(
                self.intensities,
                points.members,
                points.cell,
                softening,
                self._mean,
                self._scale,
                self.intensities,
            )
        return self.intensities
