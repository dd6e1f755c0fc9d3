"""Collects vertices and surfaces piece by piece and hands them over as an avatar."""

import numpy as np

from app.render.avatar import Avatar, Eyes, Part, part_of, sparse_deltas
from app.render.scene import Material
from core.records import F32, I32, FloatArray


class Assembly:
    """An avatar under construction: the face model's vertices, then those of each piece."""

    def __init__(self, neutral_mm: FloatArray, deltas_mm: F32, extra: F32) -> None:
        self._points: list[FloatArray] = [neutral_mm]
        self._deltas: list[F32] = [deltas_mm]
        self._extra: list[F32] = [extra]
        self._surfaces: list[tuple[Material, I32, F32]] = []
        self._count = len(neutral_mm)

    def add_vertices(self, points_mm: FloatArray, extra: F32, deltas_mm: F32 | None = None) -> int:
        """Add vertices (n, 3) with their `Mesh.extra` (n, 4); return the number of the first.

        Without deltas (46, n, 3) no expression moves them.
        """
        still = np.zeros((len(self._deltas[0]), len(points_mm), 3), np.float32)
        self._points.append(points_mm)
        self._deltas.append(still if deltas_mm is None else deltas_mm)
        self._extra.append(extra)
        first, self._count = self._count, self._count + len(points_mm)
        return first

    def add_surface(self, material: Material, triangles: I32, corner_uv: F32) -> None:
        """Add triangles (T, 3) of vertices with the uv (T, 3, 2) of their corners."""
        self._surfaces.append((material, triangles, corner_uv))

    def avatar(self, name: str, eyes: Eyes, lip_rows: I32, pivot_mm: FloatArray) -> Avatar:
        """Return the avatar."""
        starts, rows, deltas = sparse_deltas(np.concatenate(self._deltas, axis=1))
        return Avatar(
            name,
            np.concatenate(self._points).astype(np.float32),
            starts,
            rows,
            deltas,
            np.concatenate([triangles for _, triangles, _ in self._surfaces]),
            self._parts(),
            eyes,
            lip_rows,
            pivot_mm,
        )

    def _parts(self) -> tuple[Part, ...]:
        extra = np.concatenate(self._extra)
        return tuple(
            part_of(material, triangles, uv, extra) for material, triangles, uv in self._surfaces
        )
