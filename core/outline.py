"""The 15 outline landmarks of a face whose 478 points are known.

The network's own face oval stays on the skin: on the far side of a turned head it lies hidden
behind the cheek. The outline that a person would draw slides over the skin instead, and so do
the contour vertices of the face model, see contour.
"""

from dataclasses import dataclass

import numpy as np

from core.landmarks import CONTOUR_STARTS478, GROUPS, MESH478, N_INTERNAL
from core.mean_face import MeanFace, barycentric
from core.records import I32, FloatArray, freeze

_N_SAMPLES = 16


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Lines over the face on which the outline landmarks slide.

    Attributes:
        corners: (15, S, 3) surface points around each sample, from the front to the edge.
        weights: (15, S, 3) their weights.
        outward: (15, 3) the way out of the face, in the model frame.
    """

    corners: I32
    weights: FloatArray
    outward: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            corners=(np.int32, ("C", "S", 3)),
            weights=(np.float64, ("C", "S", 3)),
            outward=(np.float64, ("C", 3)),
        )


def outline_lines(mean: MeanFace) -> Lines:
    """Return the lines of the outline landmarks: straight in the frontal view.

    They run from a point beside eye, nose or mouth to the network's face oval, like the strips
    of the face model do. The way out is sideways above the mouth and away from it below.
    """
    vertices = mean.vertices_mm
    start, end = vertices[CONTOUR_STARTS478], vertices[MESH478[N_INTERNAL:]]
    parts = np.linspace(0.0, 1.0, _N_SAMPLES)[None, :, None]
    samples = start[:, None] * (1 - parts) + end[:, None] * parts
    corners, weights = _lift(mean, samples.reshape(-1, 3)[:, :2])
    outward = 0.5 * (start + end) - vertices[MESH478[list(GROUPS["lips_outer"])]].mean(axis=0)
    outward[:, 1] = np.maximum(outward[:, 1], 0.0)
    outward[:, 2] = 0.0
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    shape = (len(start), _N_SAMPLES, 3)
    return Lines(corners.reshape(shape), weights.reshape(shape), outward)


def outline(lines: Lines, mesh_px: FloatArray, rotation: FloatArray) -> FloatArray:
    """Return the outline landmarks (15, 2) in px.

    On the far side that is the point of each line that lies furthest out in the picture. The
    near side shows the jaw line well inside the silhouette of the head; there the oval is meant.

    Args:
        lines: Of the mean face.
        mesh_px: (478, 2).
        rotation: (3, 3) model to camera.
    """
    turned = lines.outward @ rotation.T
    samples = np.einsum("csk,cskd->csd", lines.weights, mesh_px[lines.corners])
    along = np.einsum("csd,cd->cs", samples, turned[:, :2])
    outermost = np.take_along_axis(samples, along.argmax(axis=1)[:, None, None], axis=1)[:, 0]
    return np.where(turned[:, 2:] < 0, samples[:, -1], outermost)


def _lift(mean: MeanFace, points: FloatArray) -> tuple[I32, FloatArray]:
    """Return the triangle corners (P, 3) and weights under points (P, 2) of the frontal view."""
    flat = mean.vertices_mm[mean.triangles][:, :, :2]
    weights = barycentric(flat[None], points[:, None])
    best = weights.min(axis=2).argmax(axis=1)
    inside = np.clip(weights[np.arange(len(points)), best], 0.0, None)
    return mean.triangles[best], inside / inside.sum(axis=1, keepdims=True)
