"""Points that ride on a face shape, and their grey levels in a picture."""

from dataclasses import dataclass

import numpy as np

from core.kernels.appearance import Room, read_appearance
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
        shapes: (R, Q, 3) mm, the shapes to read at, to be written by the caller.
        intensities: (P, R) what was read last.
    """

    def __init__(self, n_shape_points: int, points: AppearancePoints, n_runs: int) -> None:
        """Make room for R shapes at these points."""
        self.shapes: F32 = np.zeros((n_runs, n_shape_points, 3), np.float32)
        self.intensities: F32 = np.empty((len(points.corners), n_runs), np.float32)
        self._points = points
        self._room = room_for(n_shape_points, points, n_runs)
        self._to_camera = np.eye(3, dtype=np.float32)
        self._shift = np.zeros(3, np.float32)

    def place(self, rotation: FloatArray, center_mm: FloatArray) -> None:
        """Set the inverse of M^a: turn the shapes back by `rotation`, move them to `center_mm`."""
        self._to_camera[:] = rotation.T
        self._shift[:] = center_mm

    def read(self, gray: U8, projection: F32, softening: float) -> F32:
        """Return the appearance (P, R) of the shapes, valid until the next call.

        Args:
            gray: (H, W).
            projection: (3,) focal length and principal point, px.
            softening: Grey levels added to the local contrast; 0: raw grey levels.
        """
        points = self._points
        read_appearance(
            gray,
            self.shapes,
            self._to_camera,
            self._shift,
            projection,
            points.corners,
            points.weights,
            points.offsets,
            points.members,
            points.cell,
            softening,
            self._room,
            self.intensities,
        )
        return self.intensities


def room_for(n_shape_points: int, points: AppearancePoints, n_runs: int) -> Room:
    """Return the work space to read R shapes at points like these."""
    n_points, n_cells = len(points.corners), len(points.members)
    return Room(
        in_camera=np.empty((n_shape_points, 3, n_runs), np.float32),
        positions=np.empty((2, n_points, n_runs), np.float32),
        pixels=np.empty((n_points, n_runs), np.uint32),
        mean=np.empty((n_cells, n_runs), np.float32),
        scale=np.empty((n_cells, n_runs), np.float32),
    )
