"""Two edges of skin that touch, lips or closed lids, made to move or rest together.

Both edges are read at the same place along the seam, and the difference is shared between
them, fading out with the distance along the skin. All of it is one fixed sparse matrix, so
closing a linear family of faces keeps it linear, and closed.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, lil_matrix

from assets.build.face_model.surface import Surface, smooth_step


@dataclass(frozen=True)
class Edges:
    """The two edges of a seam.

    Attributes:
        upper: Vertices of the upper edge without the corners.
        lower: Vertices of the lower edge without the corners.
        corners: The two vertices where the edges meet.
        place: (n,) place along the seam of all vertices of the skin, -1 to 1 between corners.
        corner_width: Part of the seam at each corner over which closing fades in.
    """

    upper: np.ndarray
    lower: np.ndarray
    corners: np.ndarray
    place: np.ndarray
    corner_width: float


class Seam:
    """Closes the gap between two edges."""

    def __init__(self, edges: Edges, surface: Surface, reach_mm: float) -> None:
        self._n = surface.n
        to_upper = surface.distance([*edges.upper, *edges.corners])
        to_lower = surface.distance([*edges.lower, *edges.corners])
        place = np.clip(edges.place, -1, 1)
        near = 1 - smooth_step(np.minimum(to_upper, to_lower) / reach_mm)
        self._fade = near * smooth_step((1 - np.abs(place)) / edges.corner_width)
        self.is_upper = to_upper < to_lower
        self._upper, self._lower = (
            self._reader(vertices, edges.place[vertices], place)
            for vertices in (edges.upper, edges.lower)
        )

    def _reader(self, vertices: np.ndarray, at: np.ndarray, place: np.ndarray) -> csr_matrix:
        """Return the matrix that reads an edge's value at every vertex's place along it."""
        order = np.argsort(at)
        vertices, at = vertices[order], at[order]
        out = lil_matrix((self._n, self._n))
        for vertex in np.flatnonzero(self._fade > 0):
            high = int(np.clip(np.searchsorted(at, place[vertex]), 1, len(at) - 1))
            span = max(at[high] - at[high - 1], 1e-6)
            share = float(np.clip((place[vertex] - at[high - 1]) / span, 0, 1))
            out[vertex, vertices[high - 1]] += 1 - share
            out[vertex, vertices[high]] += share
        return csr_matrix(out)

    def together(self, field: np.ndarray, upper_share: float = 0.5) -> np.ndarray:
        """Return a displacement (V, 3) changed so that both edges move as one.

        Args:
            field: (V, 3) displacement.
            upper_share: How much the common movement is that of the upper edge, 0 to 1.
        """
        return self._joined(field, np.zeros(3), np.ones(3), upper_share)

    def close(
        self, points: np.ndarray, overlap_mm: float, ahead_mm: float | None = None,
        upper_share: float = 0.5,
    ) -> np.ndarray:  # fmt: skip
        """Return a head (V, 3) whose upper edge reaches below the lower one.

        Args:
            points: (V, 3) mm.
            overlap_mm: How far below.
            ahead_mm: How far the upper edge is in front of the lower one; None leaves that.
            upper_share: How much of the place where they meet is the upper edge's own.
        """
        axes = np.array([0.0, 1.0, 0.0 if ahead_mm is None else 1.0])
        return self._joined(points, np.array([0, -overlap_mm, ahead_mm or 0.0]), axes, upper_share)

    def _joined(
        self, field: np.ndarray, gap: np.ndarray, axes: np.ndarray, upper_share: float
    ) -> np.ndarray:
        """Return a field changed so that lower minus upper is `gap` along `axes`."""
        skin = field[: self._n]
        apart = (self._lower @ skin - self._upper @ skin - gap) * axes
        share = np.where(self.is_upper, 1 - upper_share, -upper_share)
        out = field.copy()
        out[: self._n] += (share * self._fade)[:, None] * apart
        return out
