"""The tools to sculpt expressions with on one head, the average of all groups."""

from collections.abc import Mapping

import numpy as np

from assets.build.face_model.head import Head
from assets.build.face_model.mouth import CORNER_LEFT, CORNER_RIGHT, MouthChart, lip_seam
from assets.build.face_model.people import RACES
from assets.build.face_model.source import Wheel
from assets.build.face_model.surface import Surface, smooth_step

#: Half width of the blend between the sides of the face.
MIDLINE_MM = 9.0
Vector = tuple[float, float, float]


class Sculptor:
    """Builds displacements (V, 3) mm on the reference head.

    Vectors are (towards the subject's left, down, into the head), so lips forward is z < 0.
    """

    def __init__(self, wheel: Wheel, head: Head, reference: np.ndarray) -> None:
        self.wheel, self.head, self.reference = wheel, head, reference
        self.surface = Surface(head, reference)
        self.chart = MouthChart(head, self.surface)
        self.lip_seam = lip_seam(self.chart, self.surface)
        x = reference[:, 0]
        self.left_share = smooth_step(0.5 + 0.5 * x / MIDLINE_MM)

    def seal(self, field: np.ndarray, upper_share: float = 0.5) -> np.ndarray:
        """Return a displacement changed so that the lips stay together."""
        return self.lip_seam.together(field, upper_share)

    def unit(self, name: str) -> np.ndarray:
        """Return one of the source's expression targets on the skin, mean of its versions."""
        fields = [self.wheel.target_mm(f"expression/units/{race}/{name}") for race in RACES]
        return self.skin_only(self.head.take(np.mean(fields, axis=0)))

    def skin_only(self, field: np.ndarray) -> np.ndarray:
        """Return a field without its values off the head crop."""
        out = np.zeros_like(field)
        out[: self.surface.n] = field[: self.surface.n]
        return out

    def left(self, field: np.ndarray) -> np.ndarray:
        """Return the left half of a field."""
        return field * self.left_share[:, None]

    def both(self, field: np.ndarray) -> np.ndarray:
        """Return a field plus its mirror image."""
        return field + self.head.mirrored(field)

    def bump(self, vertex: int, radius_mm: float, vector: Vector, inflate_mm: float = 0.0
    ) -> np.ndarray:  # fmt: skip
        """Return a soft push around a vertex: along a vector and along the skin's normals."""
        distance = self.surface.distance([vertex])
        weight = np.exp(-0.5 * (distance / radius_mm) ** 2)
        out = np.zeros_like(self.reference)
        push = np.array(vector) + inflate_mm * self.surface.normals
        out[: self.surface.n] = weight[:, None] * push
        return out

    def reach(
        self, base: np.ndarray, goals: Mapping[int, Vector], around_mm: float = 45.0,
        keep: tuple[int, ...] = (),
    ) -> np.ndarray:  # fmt: skip
        """Return a field changed as smoothly as possible so that some vertices reach goals.

        Args:
            base: (V, 3) displacement to start from.
            goals: vertex -> its displacement.
            around_mm: Skin further than this from every goal stays as in base.
            keep: Vertices that also stay as in base.
        """
        ids = np.array([*goals, *keep])
        want = np.array([*goals.values(), *(base[v] for v in keep)], float)
        free = self.surface.distance(list(goals)) < around_mm
        out = base.copy()
        out[: self.surface.n] += self.surface.spread(ids, want - base[ids], free)
        return out

    def lips(self, ring: str, middle: Vector, corner_left: Vector, corner_right: Vector,
             upper: bool | None = None, power: float = 1.6) -> dict[int, Vector]:  # fmt: skip
        """Return goals for a ring of a lip: middle and corner values, eased between.

        Args:
            ring: Name of the ring.
            middle: Displacement in the middle of the lip.
            corner_left: At the left corner.
            corner_right: At the right corner.
            upper: Upper lip (True), lower lip (False) or both.
            power: How long the middle's value holds towards the corner.
        """
        chart = self.chart
        use = np.ones(len(chart.side), bool)
        if upper is not None:
            use = chart.upper if upper else chart.lower
            use = use | np.isin(np.arange(len(use)), (CORNER_RIGHT, CORNER_LEFT))
        goals: dict[int, Vector] = {}
        for column in np.flatnonzero(use):
            side = float(chart.side[column])
            ease = abs(side) ** power
            corner = np.array(corner_left if side > 0 else corner_right)
            value = (1 - ease) * np.array(middle) + ease * corner
            goals[int(chart.ring(ring)[column])] = tuple(value)
        return goals
