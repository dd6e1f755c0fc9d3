"""The fitted face as thin lines over the picture."""

import numpy as np

from core.blendshapes import mean_user
from core.camera import project
from core.face_model import FaceModel, shape_vertices
from core.geometry import matrix_from_quaternion
from core.records import F32, I32, Camera, FaceState, FloatArray, UserBlendshapes

#: Skin further than this from all landmarks is no face: ears, neck, back of the head.
REACH_MM = 22.0
#: Edges shorter than this would only blacken lids and lips.
SHORTEST_MM = 3.5
#: Cosine to the line of sight beyond which skin is taken for turned away.
GRAZING = -0.05


class FaceMesh:
    """Some edges of a user's face, to be posed and projected for every frame."""

    def __init__(self, model: FaceModel, user: UserBlendshapes | None) -> None:
        """Choose the edges; takes some 20 ms without a user, whose place the mean face takes."""
        user = user or mean_user(model)
        edges = face_edges(model)
        used, ends = np.unique(edges, return_inverse=True)
        self._ends = ends.reshape(edges.shape)
        self._neutral_mm = user.neutral_mm[used]
        self._deltas_mm: F32 = np.ascontiguousarray(user.deltas_mm[:, used])
        self._normals = vertex_normals(user.neutral_mm, model.triangles)[used]

    def lines_px(self, state: FaceState, camera: Camera) -> FloatArray:
        """Return the ends (N, 4) of the visible edges in pixels: x, y and x, y.

        Args:
            state: Pose and expression.
            camera: Of the picture.
        """
        rotation = matrix_from_quaternion(state.rotation_wxyz)
        moved = np.tensordot(state.expression.astype(np.float32), self._deltas_mm, axes=1)
        points_mm = (self._neutral_mm + moved) @ rotation.T + state.translation_mm
        facing = np.einsum("vc,vc->v", self._normals @ rotation.T, points_mm)
        seen = facing < GRAZING * np.linalg.norm(points_mm, axis=1)
        ends = self._ends[seen[self._ends].all(axis=1)]
        return np.asarray(project(camera, points_mm)[ends].reshape(-1, 4))


def face_edges(model: FaceModel) -> I32:
    """Return the edges (N, 2) of the face's quads that are drawn."""
    quads = model.quads[model.part_triangles("skin")[::2] // 2]
    sides = np.sort(np.stack([quads, np.roll(quads, 1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges = np.unique(sides, axis=0)
    mean = model.mean_mm
    landmarks = mean[shape_vertices(model)]
    places = mean[edges].mean(axis=1)
    away = np.linalg.norm(places[:, None] - landmarks, axis=2).min(axis=1)
    length = np.linalg.norm(mean[edges[:, 0]] - mean[edges[:, 1]], axis=1)
    return np.asarray(edges[(away < REACH_MM) & (length >= SHORTEST_MM)], np.int32)


def vertex_normals(points_mm: FloatArray, triangles: I32) -> FloatArray:
    """Return unit vectors (V, 3) out of a surface; zero for vertices in no triangle."""
    a, b, c = (points_mm[triangles[:, corner]] for corner in range(3))
    across = np.cross(b - a, c - a)
    normals = np.zeros((len(points_mm), 3))
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], across)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.maximum(lengths, 1e-9))
