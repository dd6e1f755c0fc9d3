"""Brings imported blendshape targets into one head frame [FaceIt19, sec. 3, eq. 4].

Scans of one person's expressions differ by the expression and by where the head was. What the
head did has to be taken out, or every blendshape nods. The back of the head tells it: expressions
do not move it.

As printed, eq. 4 cannot be used: it has no translation, it does not say what M is, and one symbol
stands for the singular values and for the signs that replace them. Here both point sets are
centred, M is the cross-covariance of target and neutral, and the rotation is U diag(1, 1,
det(U V')) V': the sign keeps a mirror image from being the best rotation.
"""

from dataclasses import dataclass

import numpy as np

from core.errors import CoreError
from core.geometry import register_rigid
from core.records import F32, I32, FloatArray, freeze

#: Anchors on a line, or nearly, leave the rotation about it open: width in parts of the length.
_LEAST_WIDTH = 0.02


class AnchorsError(CoreError):
    """The points to register targets by do not fix a rotation."""

    def __init__(self, n_anchors: int, width: float) -> None:
        self.n_anchors, self.width = n_anchors, width
        super().__init__(
            f"{n_anchors} anchors, {width:.3f} times as wide as long: expected at least 3 points "
            f"that are at least {_LEAST_WIDTH} times as wide as long; choose anchors spread over "
            "the back of the head"
        )


class TargetShapeError(CoreError):
    """Targets and neutral face do not have the same vertices."""

    def __init__(self, targets: tuple[int, ...], neutral: tuple[int, ...]) -> None:
        self.targets, self.neutral = targets, neutral
        super().__init__(
            f"targets have shape {targets}, the neutral face {neutral}: expected (targets, "
            "vertices, 3) and (vertices, 3) with equal vertices; export all from one mesh"
        )


@dataclass(frozen=True, slots=True, eq=False)
class AlignedTargets:
    """Targets in the frame of the neutral face, in delta form [FaceIt19, eq. 3].

    Attributes:
        deltas_mm: (B, V, 3) difference of each target from the neutral face.
        rotations: (B, 3, 3) that were applied to the targets.
        translations_mm: (B, 3), after the rotation.
        rms_mm: (B,) distance of the anchors that is left: what the registration cannot explain.
    """

    deltas_mm: F32
    rotations: FloatArray
    translations_mm: FloatArray
    rms_mm: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            deltas_mm=(np.float32, ("B", "V", 3)),
            rotations=(np.float64, ("B", 3, 3)),
            translations_mm=(np.float64, ("B", 3)),
            rms_mm=(np.float64, ("B",)),
        )


def back_of_head(neutral_mm: FloatArray, share: float = 0.3) -> I32:
    """Return the vertices (A,) furthest behind the face.

    Args:
        neutral_mm: (V, 3) model frame: z points into the head.
        share: Part of all vertices to return.
    """
    depth = neutral_mm[:, 2]
    return np.flatnonzero(depth >= np.quantile(depth, 1.0 - share)).astype(np.int32)


def align_targets(targets_mm: FloatArray, neutral_mm: FloatArray, anchors: I32) -> AlignedTargets:
    """Return every target registered onto the neutral face.

    Args:
        targets_mm: (B, V, 3) whole shapes, each anywhere.
        neutral_mm: (V, 3).
        anchors: (A,) vertices that no expression moves, see `back_of_head`.

    Raises:
        TargetShapeError: Targets of other vertices.
        AnchorsError: Too few anchors, or all on a line.
    """
    if targets_mm.ndim != 3 or targets_mm.shape[1:] != neutral_mm.shape:
        raise TargetShapeError(targets_mm.shape, neutral_mm.shape)
    fixed = neutral_mm[anchors]
    _check_spread(fixed)
    poses = [register_rigid(target[anchors], fixed) for target in targets_mm]
    rotations = np.array([rotation for rotation, _ in poses]).reshape(-1, 3, 3)
    translations = np.array([shift for _, shift in poses]).reshape(-1, 3)
    aligned = targets_mm @ rotations.transpose(0, 2, 1) + translations[:, None]
    left = np.sum((aligned[:, anchors] - fixed) ** 2, axis=2)
    rms = np.sqrt(left.mean(axis=1))
    return AlignedTargets(
        (aligned - neutral_mm).astype(np.float32), rotations, translations, rms
    )  # fmt: skip


def _check_spread(points: FloatArray) -> None:
    """Refuse points that leave a rotation open."""
    width = 0.0
    if len(points) >= 3:
        sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
        width = float(sizes[1] / sizes[0]) if sizes[0] > 0 else 0.0
    if len(points) < 3 or width < _LEAST_WIDTH:
        raise AnchorsError(len(points), width)
