"""The mean face of the 478-point network: its surface, and the head's pose from it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.geometry import procrustes
from core.records import I32, FloatArray, freeze

#: Points of the mean face; the network's last ten are the irises.
N_SURFACE = 468
#: Rounds of averaging with the neighbours that take lids and lips out of the normals.
_SMOOTHING = 8


@dataclass(frozen=True, slots=True, eq=False)
class MeanFace:
    """The mean face of the landmark network, in the model frame.

    Attributes:
        vertices_mm: (468, 3).
        triangles: (T, 3), seen from outside their normals point out of the face.
        pose_points: (P,) points that expressions move little.
    """

    vertices_mm: FloatArray
    triangles: I32
    pose_points: I32

    def __post_init__(self) -> None:
        freeze(
            self,
            vertices_mm=(np.float64, (N_SURFACE, 3)),
            triangles=(np.int32, ("T", 3)),
            pose_points=(np.int32, ("P",)),
        )


def load_mean_face(path: Path) -> MeanFace:
    """Return the mean face of a file made by assets/build/aligner.py."""
    with np.load(path) as arrays:
        return MeanFace(arrays["vertices_mm"], arrays["triangles"], arrays["pose_points"])


def head_rotation(mean: MeanFace, mesh_px: FloatArray, depth_px: FloatArray) -> FloatArray:
    """Return the model-to-camera rotation (3, 3) of the head under weak perspective.

    Args:
        mean: The mean face.
        mesh_px: (478, 2).
        depth_px: (478,) growing away from the camera.
    """
    return head_pose(mean, mesh_px, depth_px)[1]


def head_pose(
    mean: MeanFace, mesh_px: FloatArray, depth_px: FloatArray
) -> tuple[float, FloatArray]:
    """Return the scale in px/mm of the mean face and its rotation; see `head_rotation`."""
    points = np.column_stack([mesh_px, depth_px])[mean.pose_points]
    scale, rotation, _ = procrustes(mean.vertices_mm[mean.pose_points], points)
    return scale, rotation


def smooth_normals(mean: MeanFace) -> FloatArray:
    """Return outward unit normals (468, 3) that follow the face but not its folds."""
    vertices, triangles = mean.vertices_mm, mean.triangles
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normals, triangles[:, k], np.cross(b - a, c - a))
    for _ in range(_SMOOTHING):
        spread = np.zeros_like(normals)
        total = normals[triangles].sum(axis=1)
        for k in range(3):
            np.add.at(spread, triangles[:, k], total)
        normals = spread / np.linalg.norm(spread, axis=1, keepdims=True)
    return normals


def barycentric(corners: FloatArray, points: FloatArray) -> FloatArray:
    """Return weights (..., 3) of points (..., 2) in triangles (..., 3, 2), 0 in degenerate ones."""
    a, b, c = (corners[..., k, :] for k in range(3))
    whole = _cross(b - a, c - a)
    areas = np.stack([_cross(b - points, c - points), _cross(c - points, a - points)], axis=-1)
    first = areas / np.where(np.abs(whole) > 1e-12, whole, np.inf)[..., None]
    return np.concatenate([first, 1 - first.sum(axis=-1, keepdims=True)], axis=-1)


def _cross(u: FloatArray, v: FloatArray) -> FloatArray:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
