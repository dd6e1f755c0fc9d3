"""The mouth as a chart of 12 closed rings with 38 columns, and the seam of the lips."""

import numpy as np

from assets.build.face_model.head import Head
from assets.build.face_model.seam import Edges, Seam
from assets.build.face_model.surface import Loops, Surface

#: Vertex of each ring in the middle of the upper lip, from the skin to inside the mouth.
RING_STARTS = (1685, 362, 455, 466, 467, 509, 468, 474, 520, 537, 554, 571)
RING_NAMES = (
    "skin_far", "skin", "border", "outer", "full", "middle", "inner", "edge", "seam",
    "behind", "deep", "deepest",
)  # fmt: skip
N_COLUMNS = 38
#: Columns: 0 upper middle, 1-9 upper right, 10 right corner, 11-18 lower right, 19 lower middle.
CORNER_RIGHT, LOWER_MIDDLE, CORNER_LEFT = 10, 19, 28
#: Distance along the skin over which closing the lips fades out, and part of the mouth at each
#: corner over which it fades in: at the very corners both lips are one skin.
REACH_MM, CORNER_WIDTH = 16.0, 0.12


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


def lip_seam(chart: MouthChart, surface: Surface) -> Seam:
    """Return what keeps the lips together."""
    seam = chart.ring("seam")
    corners = seam[[CORNER_RIGHT, CORNER_LEFT]]
    place = surface.points[:, 0] / surface.points[corners[1], 0]
    edges = Edges(seam[chart.upper], seam[chart.lower], corners, place, CORNER_WIDTH)
    out = Seam(edges, surface, REACH_MM)
    for columns, is_upper in ((chart.upper, True), (chart.lower, False)):
        out.is_upper[chart.rings[:, columns]] = is_upper
    return out
