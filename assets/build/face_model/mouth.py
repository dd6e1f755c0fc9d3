"""The mouth as a chart of 12 closed rings with 38 columns, and the sealing of the lips."""

import numpy as np
from scipy.sparse import csr_matrix, lil_matrix

from assets.build.face_model.head import Head
from assets.build.face_model.surface import Loops, Surface, smooth_step

#: Vertex of each ring in the middle of the upper lip, from the skin to inside the mouth.
RING_STARTS = (1685, 362, 455, 466, 467, 509, 468, 474, 520, 537, 554, 571)
RING_NAMES = (
    "skin_far", "skin", "border", "outer", "full", "middle", "inner", "edge", "seam",
    "behind", "deep", "deepest",
)  # fmt: skip
N_COLUMNS = 38
#: Columns: 0 upper middle, 1-9 upper right, 10 right corner, 11-18 lower right, 19 lower middle.
CORNER_RIGHT, LOWER_MIDDLE, CORNER_LEFT = 10, 19, 28


class MouthChart:
    """Names the vertices of lips and mouth by ring and column.

    Attributes:
        rings: (12, 38) vertices.
        upper: (38,) True for columns of the upper lip, corners excluded.
        lower: (38,) True for columns of the lower lip, corners excluded.
        side: (38,) -1 at the right corner, 0 in the middle, 1 at the left corner.
    """

    def __init__(self, head: Head, surface: Surface) -> None:
        loops = Loops(head)
        rings = [loops.along(start, to_the_right(loops, surface, start), N_COLUMNS)
                 for start in RING_STARTS]  # fmt: skip
        self.rings = np.array(rings)
        columns = np.arange(N_COLUMNS)
        self.lower = (columns > CORNER_RIGHT) & (columns < CORNER_LEFT)
        self.upper = (columns < CORNER_RIGHT) | (columns > CORNER_LEFT)
        x = surface.points[self.ring("seam"), 0]
        self.side = np.clip(x / x[CORNER_LEFT], -1, 1)

    def ring(self, name: str) -> np.ndarray:
        """Return the 38 vertices of a ring."""
        return np.asarray(self.rings[RING_NAMES.index(name)])


def to_the_right(loops: Loops, surface: Surface, start: int) -> int:
    """Return the neighbour furthest to the subject's right."""
    return min(loops.neighbours(start), key=lambda v: (surface.points[v, 0], v))


class Seal:
    """Makes upper and lower lip move as one where they touch.

    Both lips get the mean of their displacements along the seam; the change fades out with the
    distance along the skin. A fixed sparse matrix, so it keeps fields linear in identity.
    """

    #: Distance along the skin over which the change fades out.
    REACH_MM = 16.0

    def __init__(self, chart: MouthChart, surface: Surface) -> None:
        self._chart, self._n = chart, surface.n
        seam = chart.ring("seam")
        self._upper, self._lower = seam[chart.upper], seam[chart.lower]
        side = chart.side
        self._side_upper, self._side_lower = side[chart.upper], side[chart.lower]
        self._fade, self._along, self._is_upper = self._fields(surface)
        self._read_upper = self._reader(self._upper, self._side_upper)
        self._read_lower = self._reader(self._lower, self._side_lower)

    def _fields(self, surface: Surface) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return for every vertex fade, place along the seam, and whether it is upper."""
        corners = self._chart.ring("seam")[[CORNER_RIGHT, CORNER_LEFT]]
        to_upper = surface.distance([*self._upper, *corners])
        to_lower = surface.distance([*self._lower, *corners])
        fade = 1 - smooth_step(np.minimum(to_upper, to_lower) / self.REACH_MM)
        is_upper = to_upper < to_lower
        for columns, value in ((self._chart.upper, True), (self._chart.lower, False)):
            is_upper[self._chart.rings[:, columns]] = value
        corner_x = surface.points[corners[1], 0]
        return fade, np.clip(surface.points[:, 0] / corner_x, -1, 1), is_upper

    def _reader(self, vertices: np.ndarray, side: np.ndarray) -> csr_matrix:
        """Return the matrix that reads a lip's seam value at every vertex's place along it."""
        order = np.argsort(side)
        vertices, side = vertices[order], side[order]
        out = lil_matrix((self._n, self._n))
        for vertex in np.flatnonzero(self._fade > 0):
            place = self._along[vertex]
            high = int(np.clip(np.searchsorted(side, place), 1, len(side) - 1))
            span = max(side[high] - side[high - 1], 1e-6)
            share = float(np.clip((place - side[high - 1]) / span, 0, 1))
            out[vertex, vertices[high - 1]] += 1 - share
            out[vertex, vertices[high]] += share
        return csr_matrix(out)

    def __call__(self, field: np.ndarray, upper_share: float = 0.5) -> np.ndarray:
        """Return a displacement (V, 3) changed so that the lips stay together.

        Args:
            field: (V, 3) displacement.
            upper_share: How much the common movement is that of the upper lip, 0 to 1.
        """
        return self._joined(field, np.zeros(3), np.ones(3), upper_share)

    def close(self, points: np.ndarray, overlap_mm: float) -> np.ndarray:
        """Return a head (V, 3) whose lips touch: the lower's seam above the upper's."""
        gap = np.array([0.0, -overlap_mm, 0.0])
        return self._joined(points, gap, np.array([0.0, 1.0, 0.0]), 0.5)

    def _joined(
        self, field: np.ndarray, gap: np.ndarray, axes: np.ndarray, upper_share: float
    ) -> np.ndarray:
        """Return a field changed so that lower minus upper at the seam is `gap` along `axes`."""
        skin = field[: self._n]
        apart = (self._read_lower @ skin - self._read_upper @ skin - gap) * axes
        share = np.where(self._is_upper, 1 - upper_share, -upper_share)
        out = field.copy()
        out[: self._n] += (share * self._fade * corner_fade(self._along))[:, None] * apart
        return out


def corner_fade(along: np.ndarray) -> np.ndarray:
    """Return 1 along the lips, 0 at the very corners, where both lips are one skin."""
    return smooth_step((1 - np.abs(along)) / 0.12)
