"""Neck and shirt below a head, fitted to its neck."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.avatars.head import HOLD_AT_LOOP
from core.face_model import FaceModel
from core.records import F32, I32, FloatArray

#: Size of the cells in which a shirt's vertices are joined.
_CELL_MM = 17.0
#: Texture coordinates this far apart belong to different islands.
_ISLANDS_APART = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class Bust:
    """What hangs below the head's open neck.

    Attributes:
        ring: (R,) vertices of the face model at the edge of its neck.
        neck_mm: (N, 3), the first R of them the ring.
        neck_triangles: (T, 3).
        neck_holds: (N,) how much the body holds them.
        shirt_mm: (S, 3).
        shirt_triangles: (U, 3).
    """

    ring: I32
    neck_mm: FloatArray
    neck_triangles: I32
    neck_holds: F32
    shirt_mm: FloatArray
    shirt_triangles: I32


def load_bust(path: Path) -> Bust:
    """Return the bust of the mean head."""
    with np.load(path, allow_pickle=False) as data:
        ring, neck = data["ring_vertices"].astype(np.int32), data["neck_mm"].astype(float)
        shirt, triangles = thinned(data["shirt_mm"].astype(float), data["shirt_triangles"])
        loop = neck[: len(ring)]
        away = np.linalg.norm(neck[:, None] - loop[None], axis=2).min(axis=1)
        share = np.clip(away / 45.0, 0, 1)
        return Bust(
            ring,
            neck,
            data["neck_triangles"].astype(np.int32),
            (HOLD_AT_LOOP + (1 - HOLD_AT_LOOP) * share).astype(np.float32),
            shirt,
            triangles,
        )


def thinned(points_mm: FloatArray, triangles: I32) -> tuple[FloatArray, I32]:
    """Return a mesh with fewer vertices away from its upper rim.

    The shirt is made for close film; here it lies at the picture's edge, and every triangle costs
    a software renderer time. Vertices that share a cell of a grid become one.
    """
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    rim = np.unique(unique[count == 1])
    rim = rim[points_mm[rim, 1] < 300]
    away = np.linalg.norm(points_mm[:, None] - points_mm[rim][None, ::2], axis=2).min(axis=1)
    cell = np.floor(points_mm / _CELL_MM).astype(np.int64)
    key = np.where((away < 20)[:, None], [[-1000, -1000, 0]], cell)
    key[away < 20, 2] = np.flatnonzero(away < 20)
    _, cluster = np.unique(key, axis=0, return_inverse=True)
    cluster = cluster.reshape(-1)
    size = np.bincount(cluster)[:, None]
    middle = np.stack([np.bincount(cluster, points_mm[:, c]) for c in range(3)], axis=1) / size
    faces = cluster[triangles]
    a, b, c = faces.T
    kept = faces[(a != b) & (b != c) & (c != a)]
    return middle, kept.astype(np.int32)


def fitted_bust(bust: Bust, neutral_mm: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return neck (N, 3) and shirt (S, 3) moved to fit the neck of a head (V, 3).

    Everything takes part in the shift of the ring's middle; near the ring the skin also follows
    the ring's own shape, so that no gap opens.
    """
    loop, target = bust.neck_mm[: len(bust.ring)], neutral_mm[bust.ring]
    shift = (target - loop).mean(axis=0)
    scale = float(np.std(target[:, [0, 2]]) / np.std(loop[:, [0, 2]]))
    # Shoulders vary less than necks.
    scale = 0.5 + 0.5 * scale
    middle = loop.mean(axis=0)
    neck = middle + shift + scale * (bust.neck_mm - middle)
    gap = target - neck[: len(loop)]
    distance = np.linalg.norm(bust.neck_mm[:, None] - loop[None], axis=2)
    weight = np.exp(-distance / 8.0) + 1e-12
    local = weight @ gap / weight.sum(axis=1, keepdims=True)
    neck += np.clip(1 - distance.min(axis=1) / 40.0, 0, 1)[:, None] * local
    neck[: len(loop)] = target
    return neck, middle + shift + scale * (bust.shirt_mm - middle)


def neck_openness(bust: Bust, openness: F32) -> F32:
    """Return how open the neck (N,) is to the light, going on from the head's (V,) own values."""
    ring = openness[bust.ring]
    away = np.linalg.norm(bust.neck_mm[:, None] - bust.neck_mm[None, : len(ring)], axis=2)
    share = np.clip(away.min(axis=1) / 45.0, 0, 1)
    return np.asarray(ring[away.argmin(axis=1)] * (1 - share) + 0.85 * share, np.float32)


def neck_uv(bust: Bust, model: FaceModel) -> F32:
    """Return where the neck's triangles (T, 3, 2) take the skin's texture from.

    The texture ends at the head's edge; below, the edge's own colours go on downwards. At the
    nape and at the sides the texture has seams, so a triangle keeps to its side of the body and
    to one island of the texture.
    """
    skin = model.part_triangles("skin")
    corner, uv = model.triangles[skin].reshape(-1), model.uv[skin].reshape(-1, 2)
    out = np.empty((len(bust.neck_triangles), 3, 2), np.float32)
    for side in (-1, 1):
        ring = bust.ring[side * model.mean_mm[bust.ring, 0] >= -0.5]
        rows = np.flatnonzero(np.isin(corner, ring) & (side * (uv[:, 0] - 0.5) >= 0))
        places, colors = model.mean_mm[corner[rows]], uv[rows]
        mine = side * bust.neck_mm[bust.neck_triangles][..., 0].mean(axis=1) >= 0
        points = bust.neck_mm[bust.neck_triangles[mine]]
        middle = np.linalg.norm(points.mean(axis=1)[:, None] - places, axis=-1).argmin(axis=1)
        apart = np.linalg.norm(colors[middle][:, None] - colors, axis=-1) > _ISLANDS_APART
        away = np.linalg.norm(points[:, :, None] - places, axis=-1)
        away[np.repeat(apart[:, None], 3, axis=1)] = np.inf
        out[mine] = colors[away.argmin(axis=-1)]
    return out
