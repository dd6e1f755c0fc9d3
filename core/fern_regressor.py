"""What training leaves behind: the arrays of a regressor."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.appearance import AppearancePoints
from core.errors import ArrayShapeError
from core.records import F32, I8, I32, FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class FernRegressor:
    """A trained regressor: arrays only, so that it can be stored without pickle.

    The shapes of its shape space are kept around their centroids.

    Attributes:
        corners: (T, P, 3) appearance points: the shape points that carry them.
        weights: (T, P, 3) their barycentric coordinates.
        offsets_mm: (T, P, 3) their offsets in the frame of the shape space.
        members: (T, C, n) appearance points on which a contrast cell is measured.
        cell: (T, P) the cell of each appearance point.
        softening: () grey levels; 0: no contrast normalisation.
        pairs: (T, K, F, 2) indices of appearance points.
        thresholds: (T, K, F).
        leaves: (T, K, 2**F, D) steps along the basis of the stage. Whole numbers of 8 bits keep
            all leaves in the processor's nearest memory; later stages are trained on what the
            rounded leaves of earlier ones do.
        basis_mm: (T, D, Q, 3) mm per step.
        shapes_mm: (N, Q, 3) original shapes, each around its centroid.
        translations_mm: (m, 3).
        mean_mm: (Q, 3) mean shape, around its centroid.
        size_gauge: (Q, 3) weights that measure the size of a shape turned like the mean shape.
        check_corners: (R, 3) points of the failure check.
        check_weights: (R, 3).
        check_members: (E, k).
        check_cell: (R,).
        check_mean: (R,).
        check_basis: (M, R).
        check_level: () distance that 99 % of good frames stay below.
        check_softening: ().
    """

    corners: I32
    weights: F32
    offsets_mm: F32
    members: I32
    cell: I32
    softening: FloatArray
    pairs: I32
    thresholds: F32
    leaves: I8
    basis_mm: F32
    shapes_mm: FloatArray
    translations_mm: FloatArray
    mean_mm: FloatArray
    size_gauge: FloatArray
    check_corners: I32
    check_weights: F32
    check_members: I32
    check_cell: I32
    check_mean: F32
    check_basis: F32
    check_level: FloatArray
    check_softening: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            corners=(np.int32, ("T", "P", 3)),
            weights=(np.float32, ("T", "P", 3)),
            offsets_mm=(np.float32, ("T", "P", 3)),
            members=(np.int32, ("T", "C", "n")),
            cell=(np.int32, ("T", "P")),
            softening=(np.float64, ()),
            pairs=(np.int32, ("T", "K", "F", 2)),
            thresholds=(np.float32, ("T", "K", "F")),
            leaves=(np.int8, ("T", "K", "B", "D")),
            basis_mm=(np.float32, ("T", "D", "Q", 3)),
            shapes_mm=(np.float64, ("N", "Q", 3)),
            translations_mm=(np.float64, ("m", 3)),
            mean_mm=(np.float64, ("Q", 3)),
            size_gauge=(np.float64, ("Q", 3)),
            check_corners=(np.int32, ("R", 3)),
            check_weights=(np.float32, ("R", 3)),
            check_members=(np.int32, ("E", "k")),
            check_cell=(np.int32, ("R",)),
            check_mean=(np.float32, ("R",)),
            check_basis=(np.float32, ("M", "R")),
            check_level=(np.float64, ()),
            check_softening=(np.float64, ()),
        )
        n_leaves = 2 ** self.pairs.shape[2]
        if self.leaves.shape[2] != n_leaves:
            found = f"{self.leaves.shape[2]} leaves per fern"
            raise ArrayShapeError("FernRegressor.leaves", found, f"{n_leaves}")
        n_shape_points, n_points = self.shapes_mm.shape[1], self.corners.shape[1]
        self._check_indices("corners", n_shape_points)
        self._check_indices("check_corners", n_shape_points)
        self._check_indices("members", n_points)
        self._check_indices("pairs", n_points)
        self._check_indices("cell", self.members.shape[1])
        self._check_indices("check_members", len(self.check_corners))
        self._check_indices("check_cell", len(self.check_members))

    def _check_indices(self, name: str, end: int) -> None:
        """Refuse a damaged file here: the kernels would read outside their arrays."""
        indices = getattr(self, name)
        if indices.size and (indices.min() < 0 or indices.max() >= end):
            found = f"indices {indices.min()}..{indices.max()}"
            raise ArrayShapeError(f"FernRegressor.{name}", found, f"indices 0..{end - 1}")

    def arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return all arrays by name, as `from_arrays` takes them."""
        return {entry.name: getattr(self, entry.name) for entry in fields(self)}

    def points(self, stage: int) -> AppearancePoints:
        """Return the appearance points of a stage."""
        return AppearancePoints(
            self.corners[stage],
            self.weights[stage],
            self.offsets_mm[stage],
            self.members[stage],
            self.cell[stage],
        )

    def check_points(self) -> AppearancePoints:
        """Return the appearance points of the failure check."""
        offsets = np.zeros_like(self.check_weights)
        return AppearancePoints(
            self.check_corners, self.check_weights, offsets, self.check_members, self.check_cell
        )

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> "FernRegressor":
        """Return the regressor whose `arrays` these are; other names are ignored.

        Raises:
            ArrayShapeError: An array has another shape than it must.
            KeyError: An array is missing.
        """
        return cls(**{entry.name: arrays[entry.name] for entry in fields(cls)})
