"""The jaw: a hinge before the ears, the skin that follows it, lower teeth and tongue."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from assets.build.face_model.head import PART_NAMES, Head
from assets.build.face_model.sculptor import Sculptor
from assets.build.face_model.surface import smooth_step

#: Height over which the inside of the mouth goes from skull to jaw.
FLOOR_BLEND_MM = 14.0
#: Part of the lower lip, seen from its middle, whose inside follows the jaw fully.
FULL_SIDE = 0.6


@dataclass(frozen=True)
class JawMove:
    """A movement of the lower jaw about the hinge.

    Attributes:
        open_rad: Opening angle.
        left_rad: Turn of the chin to the subject's left.
        shift_mm: Glide of the whole jaw.
    """

    open_rad: float = 0.0
    left_rad: float = 0.0
    shift_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Jaw:
    """Which vertices follow the jaw.

    Attributes:
        weight: (V,) share of the jaw's movement.
        hinge: Vertices, symmetric, whose mean is the middle between the jaw's joints.
        bone: Vertices of lower teeth and tongue, which follow fully.
    """

    weight: np.ndarray
    hinge: np.ndarray
    bone: np.ndarray

    def move(self, points: np.ndarray, move: JawMove) -> np.ndarray:
        """Return the displacement (V, 3) of a jaw movement of a head (V, 3)."""
        return np.asarray(self.weight[:, None] * self.rigid(points, move))

    def rigid(self, points: np.ndarray, move: JawMove) -> np.ndarray:
        """Return the displacement (V, 3) as if every vertex were jaw bone."""
        pivot = points[self.hinge].mean(axis=0)
        turn = Rotation.from_rotvec([0, -move.left_rad, 0]) * Rotation.from_rotvec(
            [move.open_rad, 0, 0]
        )
        moved = (points - pivot) @ turn.as_matrix().T + pivot + np.array(move.shift_mm)
        return np.asarray(moved - points)


def hinge_vertices(head: Head, reference: np.ndarray) -> np.ndarray:
    """Return one skin vertex and its mirror image nearest to the joints before the ears."""
    distance = np.linalg.norm(reference[:4177] - [70.0, 31.0, 61.0], axis=1)
    left = int(distance.argmin())
    return np.array([left, head.mirror[left]])


def make_jaw(sculptor: Sculptor, move: JawMove) -> Jaw:
    """Return the jaw whose skin follows as it does in the source's open mouth target.

    Args:
        sculptor: The tools and the reference head.
        move: The rigid movement that the target stands for.
    """
    head, reference = sculptor.head, sculptor.reference
    opened = sculptor.unit("mouth-open")
    bone = np.concatenate([head.group["helper-lower-teeth"], head.group["helper-tongue"]])
    jaw = Jaw(np.ones(len(reference)), hinge_vertices(head, reference), bone)
    rigid = jaw.rigid(reference, move)
    weight = np.sum(opened * rigid, axis=1) / np.maximum(np.sum(rigid**2, axis=1), 1.0)
    weight = np.clip(weight, 0, 1.0)
    cavity = cavity_vertices(sculptor)
    weight[cavity] = floor_share(sculptor, jaw.hinge)[cavity]
    chart = sculptor.chart
    for ring in ("edge", "seam", "behind", "deep", "deepest"):
        weight[chart.ring(ring)[chart.lower & (np.abs(chart.side) < FULL_SIDE)]] = 1.0
    weight[bone] = 1.0
    return Jaw(weight, jaw.hinge, bone)


def cavity_vertices(sculptor: Sculptor) -> np.ndarray:
    """Return the vertices inside the mouth, behind the lips."""
    head = sculptor.head
    inside = head.part == PART_NAMES.index("mouth")
    shared = np.isin(head.quads[inside], head.quads[head.part == PART_NAMES.index("skin")])
    vertices = np.setdiff1d(head.quads[inside], head.quads[inside][shared])
    deep = [sculptor.chart.ring(name) for name in ("deep", "deepest")]
    return np.union1d(vertices, np.concatenate(deep))


def floor_share(sculptor: Sculptor, hinge: np.ndarray) -> np.ndarray:
    """Return (V,) 1 under the plane from the lips to the hinge, 0 above, smooth between.

    The source's target leaves the floor of the mouth before the teeth.
    """
    points = sculptor.reference
    lips, joint = points[sculptor.chart.ring("seam")[0]], points[hinge[0]]
    slope = (joint[1] - lips[1]) / (joint[2] - lips[2])
    below = points[:, 1] - lips[1] - slope * (points[:, 2] - lips[2])
    return smooth_step(0.5 + below / FLOOR_BLEND_MM)
