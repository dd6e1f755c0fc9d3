"""Makes every generated neutral face wearable: lips touch, eyes fit their lids and look ahead."""

from dataclasses import dataclass

import numpy as np

from assets.build.face_model.head import Head
from assets.build.face_model.lids import LidMove, Lids, move_lids, right_lids
from assets.build.face_model.sculptor import Sculptor
from assets.build.face_model.seam import Seam

#: The source's lids hang a little low.
REST = LidMove(upper=-0.12, lower=0.05)
LIP_OVERLAP_MM = 0.85
#: Distance of lids from the ball: their inner edge, on average and at least, and their skin.
EDGE_MM, EDGE_LEAST_MM, SKIN_LEAST_MM, FAR_LEAST_MM = 1.0, 0.35, 1.1, 0.8
#: The source's teeth are hidden behind the lips of an open mouth and meet edge to edge; smooth
#: subdivision shortens them by another 2 mm.
TEETH_MM = {
    "helper-upper-teeth": np.array([0.0, 4.0, 0.0]),
    "helper-lower-teeth": np.array([0.0, -0.6, 1.8]),
}
#: The source's balls are this much too large for lids that close along straight paths.
BALL_SCALE = 0.97


@dataclass(frozen=True)
class Settler:
    """Finishes neutral faces (V, 3) of any identity.

    Attributes:
        head: The topology.
        lips: The seam of the lips.
        lids: The lids of the right eye.
        ball: (72, 3) unit vectors of the right eyeball's vertices.
        radius_mm: Radius of the reference's eyeballs.
        rim_width_mm: Width of the reference's eye opening.
        center_mm: (3,) eyeball centre of the reference relative to the middle of its rim.
    """

    head: Head
    lips: Seam
    lids: Lids
    ball: np.ndarray
    radius_mm: float
    rim_width_mm: float
    center_mm: np.ndarray

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Return the face with closed lips and fitting eyes, origin between the eyes."""
        out = self.lips.close(points, LIP_OVERLAP_MM)
        for name, shift_mm in TEETH_MM.items():
            out[self.head.group[name]] += shift_mm
        out = self._fit_right_eye(out)
        out = self.head.mirrored(self._fit_right_eye(self.head.mirrored(out)))
        return np.asarray(out - out[-2:].mean(axis=0))

    def _fit_right_eye(self, points: np.ndarray) -> np.ndarray:
        """Return the face with a round right eyeball behind the lids, which rest on it."""
        out = points.copy()
        rim = out[[*self.lids.upper_rim, *self.lids.lower_rim[1:-1]]]
        size = float(np.ptp(rim[:, 0])) / self.rim_width_mm
        radius = self.radius_mm * size**0.5
        center = rim.mean(axis=0) + self.center_mm * size
        center[2] += self._depth(out[self.lids.inner_edge] - center, radius)
        out[-2] = center
        out[self.head.group["helper-r-eye"]] = center + radius * self.ball
        out += move_lids(self.lids, out, center, REST)
        return self._pushed_out(out, center, radius)

    def _depth(self, edge: np.ndarray, radius: float) -> float:
        """Return how far to move the ball into the head so that the lids' edge rests on it."""
        around = np.maximum((radius + EDGE_MM) ** 2 - edge[:, 0] ** 2 - edge[:, 1] ** 2, 0)
        return float(np.median(edge[:, 2] + np.sqrt(around)))

    def _pushed_out(self, points: np.ndarray, center: np.ndarray, radius: float) -> np.ndarray:
        """Return the face with no part of the lids inside or too near the ball."""
        out = points.copy()
        lids = self.lids
        # Triangles are larger away from the rim and cut deeper into the ball's roundness.
        skin_least = SKIN_LEAST_MM + FAR_LEAST_MM * np.minimum(lids.rim_mm / 12.0, 1.0)
        for ids, least in (
            (lids.around, skin_least), (lids.inner_edge, EDGE_LEAST_MM)
        ):  # fmt: skip
            offset = out[ids] - center
            distance = np.linalg.norm(offset, axis=1)
            front = offset[:, 2] < 0
            lift = np.where(front, softly_above(distance, radius + least) - distance, 0.0)
            out[ids] += offset / distance[:, None] * lift[:, None]
        return out

    def lid_move(self, points: np.ndarray, move: LidMove, left: bool) -> np.ndarray:
        """Return the displacement of moving one eye's lids."""
        if not left:
            return move_lids(self.lids, points, points[-2], move)
        mirrored = self.head.mirrored(points)
        field = move_lids(self.lids, mirrored, mirrored[-2], move)
        return np.asarray(self.head.mirrored(field))


def softly_above(value: np.ndarray, least: float, width: float = 0.4) -> np.ndarray:
    """Return values that never fall below a bound, with a soft bend at it."""
    over = value - least
    return np.asarray(least + 0.5 * (over + np.sqrt(over**2 + width**2)))


def make_settler(sculptor: Sculptor) -> Settler:
    """Return the settler whose charts are drawn on the sculptor's head."""
    head, points = sculptor.head, sculptor.reference
    lids = right_lids(head, sculptor.surface, points[-2])
    rim = points[[*lids.upper_rim, *lids.lower_rim[1:-1]]]
    ball = points[head.group["helper-r-eye"]] - points[-2]
    radius = float(np.linalg.norm(ball, axis=1).mean())
    return Settler(
        head,
        sculptor.lip_seam,
        lids,
        ball / np.linalg.norm(ball, axis=1, keepdims=True),
        radius * BALL_SCALE,
        float(np.ptp(rim[:, 0])),
        points[-2] - rim.mean(axis=0),
    )
