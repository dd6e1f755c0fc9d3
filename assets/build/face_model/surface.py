"""Smooth fields on the skin of the head: distances along it and displacements spread over it."""

from collections import defaultdict

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, diags
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.linalg import splu

from assets.build.face_model.head import PART_NAMES, Head


def skin_quads(head: Head) -> np.ndarray:
    """Return the quads of skin and mouth cavity."""
    return head.quads[head.part <= PART_NAMES.index("mouth")]


def smooth_step(t: np.ndarray) -> np.ndarray:
    """Return 0 below 0, 1 above 1 and a smooth curve between."""
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)


class Surface:
    """The skin of one head with its Laplacian.

    Attributes:
        points: (n, 3) mm, the vertices of the head crop.
        n: Their number.
    """

    def __init__(self, head: Head, points: np.ndarray) -> None:
        quads = skin_quads(head)
        self.n = int(quads.max()) + 1
        self.points = points[: self.n]
        self._graph = length_graph(quads, self.points)
        self._bilaplacian = bilaplacian(quads, self.points)
        self.normals = normals(quads, self.points)

    def distance(self, sources: np.ndarray | list[int]) -> np.ndarray:
        """Return the distance along the skin (n,) mm to the nearest source vertex."""
        return np.asarray(dijkstra(self._graph, indices=list(sources), min_only=True))

    def spread(self, ids: np.ndarray, values: np.ndarray, free: np.ndarray) -> np.ndarray:
        """Return the smoothest field (n, 3) with given values at some vertices.

        Args:
            ids: (k,) vertices.
            values: (k, 3) their displacements.
            free: (n,) True where the field may differ from zero.
        """
        out = np.zeros((self.n, 3))
        out[ids] = values
        unknown = free.copy()
        unknown[ids] = False
        rows = self._bilaplacian[unknown]
        solver = splu(rows[:, unknown].tocsc())
        out[unknown] = solver.solve(-(rows @ out))
        return out


def length_graph(quads: np.ndarray, points: np.ndarray) -> csr_matrix:
    """Return the graph of edges and diagonals with their lengths."""
    pairs = [quads[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3))]
    a, b = np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0).T
    length = np.linalg.norm(points[a] - points[b], axis=1)
    graph = coo_matrix((length, (a, b)), shape=(len(points),) * 2).tocsr()
    return csr_matrix(graph + graph.T)


def bilaplacian(quads: np.ndarray, points: np.ndarray) -> csr_matrix:
    """Return L' M^-1 L with cotangent weights over both cuts of every quad."""
    cuts = ((0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3))
    triangles = np.concatenate([quads[:, list(cut)] for cut in cuts])
    count = len(points)
    laplacian = csr_matrix((count, count))
    mass = np.zeros(count)
    for k in range(3):
        apex, a, b = (triangles[:, (k + j) % 3] for j in range(3))
        u, v = points[a] - points[apex], points[b] - points[apex]
        area = np.linalg.norm(np.cross(u, v), axis=1)
        weight = np.clip(np.sum(u * v, axis=1) / np.maximum(area, 1e-9), -0.3, 8.0) / 4
        part = coo_matrix((weight, (a, b)), shape=(count, count)).tocsr()
        laplacian = laplacian + part + part.T
        mass += np.bincount(apex, area / 12, count)
    degree = np.asarray(laplacian.sum(axis=1)).ravel()
    matrix = diags(degree) - laplacian
    return csr_matrix(matrix.T @ diags(1 / np.maximum(mass, 0.05)) @ matrix)


def normals(quads: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return unit vertex normals (n, 3) that point out of the head."""
    across = np.cross(
        points[quads[:, 2]] - points[quads[:, 0]], points[quads[:, 3]] - points[quads[:, 1]]
    )
    out = np.zeros_like(points)
    for k in range(4):
        np.add.at(out, quads[:, k], across)
    return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9)


class Loops:
    """Walks along the edge loops of the quads."""

    def __init__(self, head: Head) -> None:
        self._near: dict[int, set[int]] = defaultdict(set)
        self._faces: dict[int, set[int]] = defaultdict(set)
        for number, quad in enumerate(skin_quads(head).tolist()):
            for k in range(4):
                self._near[quad[k]] |= {quad[k - 1], quad[(k + 1) % 4]}
                self._faces[quad[k]].add(number)

    def neighbours(self, vertex: int) -> set[int]:
        """Return the vertices that an edge joins to this one."""
        return self._near[vertex]

    def along(self, first: int, second: int, closed_length: int) -> list[int]:
        """Return a closed loop of a known length that starts with an edge."""
        out = [first, second]
        while len(out) < closed_length:
            before, here = out[-2:]
            behind = self._faces[before] & self._faces[here]
            ahead = [v for v in self._near[here] if v != before and not self._faces[v] & behind]
            out.append(min(ahead))
        return out
