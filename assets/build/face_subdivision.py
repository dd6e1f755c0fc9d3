"""Catmull-Clark subdivision as a sparse matrix, for smooth pictures of the face model."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, vstack


@dataclass(frozen=True)
class Refined:
    """A finer mesh: points = matrix @ coarse points; every quad became four."""

    matrix: csr_matrix
    quads: np.ndarray
    parent: np.ndarray


def edges_of(quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges (E, 2) and for each quad its four edge numbers (F, 4)."""
    ends = np.stack([quads, np.roll(quads, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges, number = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    return edges, number.reshape(-1, 4)


def averaging(rows: np.ndarray, columns: np.ndarray, shape: tuple[int, int]) -> csr_matrix:
    """Return the matrix whose rows average the listed columns."""
    matrix = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=shape).tocsr()
    count = np.maximum(np.asarray(matrix.sum(axis=1)).ravel(), 1)
    return csr_matrix(matrix.multiply(1 / count[:, None]))


def catmull_clark(quads: np.ndarray, n_vertices: int) -> Refined:
    """Return one step of subdivision; borders stay cubic splines."""
    edges, edge_of = edges_of(quads)
    n_faces, n_edges = len(quads), len(edges)
    face = averaging(np.repeat(np.arange(n_faces), 4), quads.ravel(), (n_faces, n_vertices))
    uses = np.bincount(edge_of.ravel(), minlength=n_edges)
    border = uses == 1
    ends = averaging(np.repeat(np.arange(n_edges), 2), edges.ravel(), (n_edges, n_vertices))
    beside = averaging(edge_of.ravel(), np.repeat(np.arange(n_faces), 4), (n_edges, n_faces))
    inner = (ends + beside @ face) * 0.5
    edge = csr_matrix(ends.multiply(border[:, None]) + inner.multiply(~border[:, None]))
    vertex = vertex_rule(quads, edges, (face, ends), border, n_vertices)
    corner = n_vertices + edge_of
    center = (n_vertices + n_edges + np.arange(n_faces))[:, None].repeat(4, axis=1)
    fine = np.stack([quads, corner, center, np.roll(corner, 1, axis=1)], axis=-1)
    parent = np.arange(n_faces).repeat(4)
    return Refined(csr_matrix(vstack([vertex, edge, face])), fine.reshape(-1, 4), parent)


def vertex_rule(
    quads: np.ndarray, edges: np.ndarray, points: tuple[csr_matrix, csr_matrix],
    border: np.ndarray, n_vertices: int,
) -> csr_matrix:  # fmt: skip
    """Return the new places of the old vertices, (V, V)."""
    face, ends = points
    n_faces, n_edges = len(quads), len(edges)
    around = averaging(quads.ravel(), np.repeat(np.arange(n_faces), 4), (n_vertices, n_faces))
    spokes = averaging(edges.ravel(), np.repeat(np.arange(n_edges), 2), (n_vertices, n_edges))
    valence = np.maximum(np.bincount(edges.ravel(), minlength=n_vertices), 3)[:, None]
    same = averaging(np.arange(n_vertices), np.arange(n_vertices), (n_vertices, n_vertices))
    inner = (around @ face + 2 * (spokes @ ends) + same.multiply(valence - 3)).multiply(1 / valence)
    rim = edges[border]
    neighbours = averaging(
        np.concatenate([rim[:, 0], rim[:, 1]]),
        np.concatenate([rim[:, 1], rim[:, 0]]),
        (n_vertices, n_vertices),
    )
    on_rim = np.zeros((n_vertices, 1), bool)
    on_rim[rim.ravel()] = True
    smooth = same * 0.75 + neighbours * 0.25
    used = np.zeros((n_vertices, 1), bool)
    used[quads.ravel()] = True
    kept = csr_matrix(inner.multiply(~on_rim & used) + same.multiply(~used))
    return csr_matrix(kept + smooth.multiply(on_rim))


def refine(quads: np.ndarray, n_vertices: int, levels: int) -> Refined:
    """Return several steps of subdivision."""
    out = catmull_clark(quads, n_vertices)
    for _ in range(levels - 1):
        finer = catmull_clark(out.quads, out.matrix.shape[0])
        out = Refined(csr_matrix(finer.matrix @ out.matrix), finer.quads, out.parent[finer.parent])
    return out
