"""Turns a face of the bilinear model into parts that can be drawn."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from core.face_model import FaceModel
from core.landmarks import NAMES
from core.records import F32, I32, BoolArray, FloatArray

#: How far above the neck's loop the body begins to hold the skin.
_BEND_MM = 42.0
#: Hold at the loop itself; the neck below goes on to 1.
HOLD_AT_LOOP = 0.55


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles with the texture coordinates of their corners.

    Attributes:
        triangles: (T, 3) vertices.
        uv: (T, 3, 2).
    """

    triangles: I32
    uv: F32


def surface(model: FaceModel, *parts: str) -> Surface:
    """Return the triangles of some parts of the model."""
    mine = np.concatenate([model.part_triangles(part) for part in parts])
    return Surface(model.triangles[mine], model.uv[mine])


def neck_loop(model: FaceModel) -> I32:
    """Return the vertices at the open edge of the neck."""
    triangles = model.triangles[np.isin(model.part, [0, 1])]
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    border = np.unique(unique[count == 1])
    return np.asarray(border[model.mean_mm[border, 1] > 50], np.int32)


def holds(model: FaceModel) -> F32:
    """Return how much the body holds each vertex, (V,): more towards the neck's edge."""
    points, triangles = model.mean_mm.astype(float), model.triangles
    pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    lengths = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    graph = coo_matrix((lengths, pairs.T), shape=(len(points), len(points)))
    away = dijkstra(graph, directed=False, indices=neck_loop(model), min_only=True)
    share = np.clip(1 - away / _BEND_MM, 0, 1)
    # What carries landmarks moves with the head alone: its truth is one rigid pose.
    share[model.contour_strips[model.contour_strips >= 0]] *= 0.0
    return np.asarray(HOLD_AT_LOOP * share * share * (3 - 2 * share), np.float32)


def lid_rows(model: FaceModel) -> I32:
    """Return for the right and left eye: corners by growing x, middle of upper, lower lid."""
    row = dict(zip(NAMES, model.landmark_vertices, strict=False))
    out = []
    for side, first, second in (("R", "outer", "inner"), ("L", "inner", "outer")):
        names = (first, second, "up_mid", "lo_mid")
        out.append([row[f"{side}_eye_{name}"] for name in names])
    return np.array(out, np.int32)


def lip_rows(model: FaceModel) -> I32:
    """Return the middle of the upper and lower lip's inner edge."""
    row = dict(zip(NAMES, model.landmark_vertices, strict=False))
    return np.array([row["lipin_up_mid"], row["lipin_lo_mid"]], np.int32)


def eye_radii_mm(model: FaceModel, neutral: FloatArray, centers_mm: FloatArray) -> FloatArray:
    """Return the radius of the right and the left eyeball of a face (V, 3)."""
    balls = (model.eyeball_vertices_right, model.eyeball_vertices_left)
    return np.array(
        [
            np.linalg.norm(neutral[ball] - center, axis=1).mean()
            for ball, center in zip(balls, centers_mm, strict=True)
        ]
    )


#: Parts inside the mouth: depth in mm over which the light falls to a third, least light.
_INNER = (("mouth", 13.0, 0.03), ("teeth", 25.0, 0.10), ("tongue", 20.0, 0.05))


def inner_shade(model: FaceModel) -> tuple[BoolArray, F32]:
    """Return which vertices (V,) lie inside the mouth, and how much light reaches them.

    The lips are the window: what lies behind them darkens with the distance.
    """
    lips = model.mean_mm[lip_rows(model)].mean(axis=0)
    away = np.linalg.norm((model.mean_mm - lips) * [0.8, 0.7, 1.0], axis=1)
    skin = np.unique(model.triangles[model.part_triangles("skin")])
    inside, shade = np.zeros(len(away), bool), np.ones(len(away), np.float32)
    for part, reach_mm, least in _INNER:
        rows = np.setdiff1d(np.unique(model.triangles[model.part_triangles(part)]), skin)
        inside[rows] = True
        shade[rows] = np.maximum(np.exp(-np.maximum(away[rows] - 7, 0) / reach_mm), least)
    return inside, shade
