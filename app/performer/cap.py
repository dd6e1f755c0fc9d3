"""A knitted cap over the scalp, for those who hide their hair."""

import numpy as np

from app.avatars.hair import Scalp
from app.avatars.looks import Color
from app.render.scene import Material, Mesh, Uniforms
from core.kernels.morph import vertex_normals
from core.records import F32, U8, FloatArray

#: The cap's edge is a slanted plane: height above the eyes at the forehead and fall to the back.
_FRONT_MM, _FALL = 66.0, 0.42
_THICK_MM, _TOP_MM = 9.0, 7.0


def cap_mesh(scalp: Scalp, head_mm: FloatArray, mean_mm: F32) -> Mesh:
    """Return a cap that fits a head.

    Args:
        scalp: Of the face model.
        head_mm: (V, 3) neutral face of the person.
        mean_mm: (V, 3) mean face, which decides where the edge runs.
    """
    points = np.ascontiguousarray(scalp.mix @ head_mm, np.float32)
    mean = np.asarray(scalp.mix @ mean_mm, float)
    above = -_FRONT_MM + _FALL * (mean[:, 2] + 5.0) - mean[:, 1]
    normals: F32 = np.empty_like(points)
    vertex_normals(points, scalp.triangles, normals)
    thick = _THICK_MM + _TOP_MM * np.clip((-60.0 - mean[:, 1]) / 50.0, 0, 1)
    # The rim is rolled up: thick right from the edge.
    lift = thick * np.sqrt(np.clip((above + 10.0) / 14.0, 0, 1))
    cap = np.ascontiguousarray(points + lift[:, None] * normals, np.float32)
    vertex_normals(cap, scalp.triangles, normals)
    turn = np.arctan2(mean[:, 0], -40.0 - mean[:, 1])
    uv = np.stack([mean[:, 2] / 60, turn / 1.2], axis=1).astype(np.float32)
    coverage = np.clip((above + 3.0) / 6.0, 0, 1)
    zero, one = np.zeros_like(coverage), np.ones_like(coverage)
    extra = np.stack([zero, one, coverage, one], axis=1).astype(np.float32)
    return Mesh(cap, normals, uv, extra, scalp.triangles)


def knit(color: Color, rng: np.random.Generator) -> Material:
    """Return ribbed wool of a colour."""
    rows, columns = np.mgrid[0:64, 0:64]
    rib = 0.8 + 0.2 * np.abs(np.sin(2 * np.pi * columns / 16))
    rib = rib * (1 + 0.06 * np.sin(2 * np.pi * rows / 4)) * (1 + 0.05 * rng.normal(size=rib.shape))
    wool = np.clip(np.array(color) * rib[..., None], 0, 255)
    texture: U8 = np.concatenate([wool, np.full((64, 64, 1), 255)], axis=2).astype(np.uint8)
    # The hair's shader cuts along the coverage, so the edge runs straight through triangles.
    values: Uniforms = {"cutoff": 0.5, "shine": 0.05}
    return Material("hair", texture, values, two_sided=True, repeated=True)
