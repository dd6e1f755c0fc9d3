"""A head that can be posed: its shapes, its parts and how they look."""

from dataclasses import dataclass

import numpy as np

from app.render.lip_seal import LipSeal
from app.render.scene import Material
from core.records import F32, I32, FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """What is drawn with one material.

    Attributes:
        material: How it looks.
        rows: (G,) avatar vertex that each drawn vertex repeats; texture seams need some twice.
        uv: (G, 2).
        extra: (G, 4), see `Mesh`.
        triangles: (T, 3) of drawn vertices, counter-clockwise seen from outside.
    """

    material: Material
    rows: I32
    uv: F32
    extra: F32
    triangles: I32

    def __post_init__(self) -> None:
        freeze(
            self,
            rows=(np.int32, ("G",)),
            uv=(np.float32, ("G", 2)),
            extra=(np.float32, ("G", 4)),
            triangles=(np.int32, ("T", 3)),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Eyes:
    """Both eyeballs, the subject's right one first, and the lids around them.

    Attributes:
        centers_mm: (2, 3).
        radii_mm: (2,).
        lid_rows: (2, 4) avatar vertices: corner at smaller x, at larger x, middle of the upper
            and of the lower lid.
        materials: Of the right and of the left eyeball.
    """

    centers_mm: FloatArray
    radii_mm: FloatArray
    lid_rows: I32
    materials: tuple[Material, Material]

    def __post_init__(self) -> None:
        freeze(
            self,
            centers_mm=(np.float64, (2, 3)),
            radii_mm=(np.float64, (2,)),
            lid_rows=(np.int32, (2, 4)),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Avatar:
    """A head with 46 blendshapes that `Puppet` can pose and draw.

    Attributes:
        name: For people.
        neutral_mm: (V, 3) in the model frame.
        delta_starts: (B+1,) entries of each blendshape in the two arrays below.
        delta_rows: (N,) vertex that an entry moves.
        deltas_mm: (N, 3) how far at weight 1.
        triangles: (T, 3) of vertices, for smooth normals.
        parts: What is drawn, eyes apart.
        eyes: The eyeballs.
        lip_rows: (2,) vertices of the middle of the upper and lower lip's inner edge.
        pivot_mm: (3,) where the skull turns on the neck.
        seal: Draws lips together that nearly touch; None: they are shown as they are.
    """

    name: str
    neutral_mm: F32
    delta_starts: I32
    delta_rows: I32
    deltas_mm: F32
    triangles: I32
    parts: tuple[Part, ...]
    eyes: Eyes
    lip_rows: I32
    pivot_mm: FloatArray
    seal: LipSeal | None = None

    def __post_init__(self) -> None:
        freeze(
            self,
            neutral_mm=(np.float32, ("V", 3)),
            delta_starts=(np.int32, ("B+1",)),
            delta_rows=(np.int32, ("N",)),
            deltas_mm=(np.float32, ("N", 3)),
            triangles=(np.int32, ("T", 3)),
            lip_rows=(np.int32, (2,)),
            pivot_mm=(np.float64, (3,)),
        )


def sparse_deltas(deltas_mm: F32, smallest_mm: float = 0.005) -> tuple[I32, I32, F32]:
    """Return starts, rows and entries of dense blendshapes (B, V, 3), without what is still."""
    moves = np.abs(deltas_mm).max(axis=2) > smallest_mm
    starts = np.concatenate([[0], moves.sum(axis=1).cumsum()]).astype(np.int32)
    shape, rows = np.nonzero(moves)
    return starts, rows.astype(np.int32), np.ascontiguousarray(deltas_mm[shape, rows], np.float32)


def part_of(material: Material, triangles: I32, corner_uv: F32, vertex_extra: F32) -> Part:
    """Return a part with vertices repeated where their texture coordinates differ.

    Args:
        material: How it looks.
        triangles: (T, 3) avatar vertices.
        corner_uv: (T, 3, 2).
        vertex_extra: (V, 4) of every avatar vertex.
    """
    keys = np.concatenate([triangles[..., None], np.round(corner_uv * 65535)], axis=-1)
    unique, flat = np.unique(keys.reshape(-1, 3).astype(np.int64), axis=0, return_inverse=True)
    rows = unique[:, 0].astype(np.int32)
    uv = (unique[:, 1:] / 65535).astype(np.float32)
    return Part(material, rows, uv, vertex_extra[rows], flat.reshape(-1, 3).astype(np.int32))
