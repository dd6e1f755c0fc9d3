"""Paints the lashes: where each pixel of the lash cards lies between root and tip, then hairs."""

import cv2
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree

from assets.build.textures_canvas import fill_triangle, stroke
from core.face_model import PART_NAMES, FaceModel


def lash_coverage(model: FaceModel, size_px: int, rng: np.random.Generator) -> np.ndarray:
    """Return the coverage (S, S) in [0, 1] of all four rows of lashes."""
    quads = model.quads[model.part[::2] == PART_NAMES.index("lashes")]
    coordinates = np.zeros((len(model.mean_mm), 2))
    for card in cards(quads, len(model.mean_mm)):
        vertices, column, row = grid(card, model)
        upper = model.mean_mm[vertices, 1].mean() < 2.5
        coordinates[vertices] = np.column_stack([column, row + (2 if upper else 0)])
    out = np.zeros((size_px, size_px), np.float32)
    place, inside = np.zeros((size_px, size_px, 2), np.float32), np.zeros((size_px, size_px), bool)
    for number in model.part_triangles("lashes"):
        corner = model.uv[number].astype(float) * size_px - 0.5
        fill_triangle(place, inside, corner, coordinates[model.triangles[number]])
    strips = {True: strip(rng, 95, 1.0), False: strip(rng, 60, 0.5)}
    for upper, picture in strips.items():
        mine = inside & ((place[..., 1] >= 1.5) == upper)
        x = place[..., 0] * (picture.shape[1] - 1)
        y = (place[..., 1] - (2 if upper else 0)) * (picture.shape[0] - 1)
        found = cv2.remap(picture, x.astype(np.float32), y.astype(np.float32), cv2.INTER_LINEAR)
        out[mine] = found[mine]
    return out


def cards(quads: np.ndarray, n: int) -> list[np.ndarray]:
    """Return the quads of each connected card."""
    edges = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    _, label = connected_components(coo_matrix((np.ones(len(edges)), edges.T), (n, n)))
    return [quads[label[quads[:, 0]] == card] for card in np.unique(label[quads[:, 0]])]


def grid(card: np.ndarray, model: FaceModel) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return vertices of a card, their way along the lid and from root (1) to tip (0)."""
    vertices, local = np.unique(card, return_inverse=True)
    quads = local.reshape(-1, 4)
    edges = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    unique, count = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    graph = coo_matrix((np.ones(len(unique)), unique.T), (len(vertices), len(vertices)))
    corners = np.flatnonzero(np.bincount(quads.reshape(-1)) == 1)
    hops = dijkstra(graph, directed=False, unweighted=True)
    border = unique[count == 1]
    rim = coo_matrix((np.ones(len(border)), border.T), graph.shape)
    along_rim = dijkstra(rim, directed=False, unweighted=True, indices=corners)
    # The opposite corner on a short side is four quads away along the rim.
    first = 0
    short = int(np.argmin([along_rim[first, c] if c != corners[first] else 99 for c in corners]))
    others = [k for k in range(4) if k not in (first, short)]
    mate = others[int(np.argmin([along_rim[first, corners[k]] for k in others]))]
    skin = np.unique(model.triangles[model.part_triangles("skin")])
    tree = cKDTree(model.mean_mm[skin])

    def side(a: int, b: int) -> np.ndarray:
        length = along_rim[a, corners[b]]
        return np.flatnonzero(np.abs(along_rim[a] + along_rim[b] - length) < 0.5)

    far = [k for k in range(4) if k not in (first, mate)]
    sides = [side(first, mate), side(far[0], far[1])]
    away = [tree.query(model.mean_mm[vertices[s]])[0].mean() for s in sides]
    tip, root = sides[int(np.argmax(away))], sides[int(np.argmin(away))]
    to_tip, to_root = hops[tip].min(axis=0), hops[root].min(axis=0)
    end = side(first, short)
    column = hops[end].min(axis=0)
    return vertices, column / column.max(), to_tip / (to_tip + to_root)


def strip(rng: np.random.Generator, count: int, length: float) -> np.ndarray:
    """Return lashes in a strip (256, 2048): row 0 the tips, three quarters down the roots."""
    out = np.zeros((256, 2048), np.float32)
    root = 0.74 * 255
    for group in np.linspace(30, 2018, count // 3):
        meet = group + rng.normal(0, 6)
        for offset in (-14, 0, 14):
            start = group + offset + rng.normal(0, 7)
            reach = root * length * rng.uniform(0.72, 1.0)
            steps = np.linspace(0, 1, 9)
            lean = (meet - start) * 0.75 + (group - 1024) * 0.03
            x = start + lean * steps**1.5
            y = root + 14 - (reach + 14) * steps
            for k in range(8):
                width = 13 * (1 - k / 8) ** 0.7 + 2
                stroke(out, np.column_stack([x[k : k + 2], y[k : k + 2]]), width, 1 - 0.04 * k)
    return cv2.GaussianBlur(out, (0, 0), 1.5)
