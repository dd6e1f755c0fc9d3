"""Hair and caps: shells over the scalp of a face model's head."""

from dataclasses import dataclass

import cv2
import numpy as np

from app.render.scene import Material, Mesh
from core.face_model import FaceModel
from core.kernels.morph import vertex_normals
from core.records import F32, I32, U8, FloatArray

#: The axis that hair is combed around runs through here, from the forehead to the back (y, z).
_CROWN_MM = (-40.0, 80.0)
#: Lowest hair (y, mm from the eyes, down) by the angle from straight ahead, for the mean head:
#: forehead, its corners, temples, in front of the ears, above and behind them, nape.
_LINE_DEG = (0.0, 22.0, 42.0, 58.0, 70.0, 80.0, 104.0, 122.0, 145.0, 180.0)
_LINE_MM = (-66.0, -69.0, -62.0, -44.0, -6.0, -24.0, -22.0, 26.0, 52.0, 58.0)


@dataclass(frozen=True, slots=True)
class Style:
    """What covers the head.

    Attributes:
        color: (r, g, b) as shown.
        top_mm: Thickness on the crown.
        side_mm: Thickness above the ears and at the back.
        lower_mm: The hairline lies this much lower than on the mean head.
        cloth: A knitted cap instead of hair.
    """

    color: tuple[int, int, int]
    top_mm: float = 22.0
    side_mm: float = 11.0
    lower_mm: float = 0.0
    cloth: bool = False


def above_hairline_mm(points_mm: FloatArray) -> FloatArray:
    """Return (n,) how far points of the mean head are above its hairline."""
    x, y, z = np.asarray(points_mm, float).T
    angle = np.rad2deg(np.abs(np.arctan2(x, _CROWN_MM[1] - z)))
    return np.asarray(np.interp(angle, _LINE_DEG, _LINE_MM) - y)


def _above_edge_mm(points_mm: FloatArray, style: Style) -> FloatArray:
    """Return (n,) how far points of the mean head are above the lower edge of hair or cap."""
    if style.cloth:
        # A cap's edge is a plane, low at the back of the head.
        return np.asarray(-56.0 + 0.42 * (points_mm[:, 2] + 5.0) - points_mm[:, 1] + style.lower_mm)
    return above_hairline_mm(points_mm) + style.lower_mm


def hair_meshes(
    model: FaceModel, head_mm: FloatArray, style: Style, rng: np.random.Generator
) -> list[tuple[Mesh, Material]]:
    """Return the shells of hair or cap that fit a head, the inner one first.

    Args:
        model: Gives the scalp's faces and, by its mean face, the hairline.
        head_mm: (V, 3) neutral face of the person.
        style: What to wear.
        rng: Source of strands and unevenness.
    """
    height = _above_edge_mm(model.mean_mm, style)
    quads = model.quads[model.part[::2] == 0]
    # The ears stick through the hair: their outer rims lie far from the skull's middle.
    ears = (np.abs(model.mean_mm[:, 0]) > 79) & (np.abs(model.mean_mm[:, 1] - 12) < 52)
    kept = quads[(height[quads].max(axis=1) > -8) & ~ears[quads].any(axis=1)]
    fields = np.column_stack([head_mm, model.mean_mm, height])
    fields, kept = fields[np.unique(kept)], np.unique(kept, return_inverse=True)[1].reshape(-1, 4)
    fields, kept = _refined(fields, kept)
    triangles = np.concatenate([kept[:, [0, 1, 2]], kept[:, [0, 2, 3]]]).astype(np.int32)
    points, height = _rounded(fields[:, :3], triangles), fields[:, 6]
    if style.cloth:
        return [_shell(points, height, triangles, style, 1.0) + (_knit(style, rng),)]
    shells = ((0.55, 0.0), (0.8, 0.45), (1.0, 0.6))
    return [
        (_shell(points, height, triangles, style, share)[0], _strands(style, sparse, rng))
        for share, sparse in shells
    ]


def _shell(
    scalp_mm: FloatArray, height_mm: FloatArray, triangles: I32, style: Style, share: float
) -> tuple[Mesh]:
    """Return the scalp lifted by a share of the hair's thickness."""
    scalp = np.ascontiguousarray(scalp_mm, np.float32)
    normals: F32 = np.empty_like(scalp)
    vertex_normals(scalp, triangles, normals)
    crown = np.clip((-_CROWN_MM[0] - 10 - scalp[:, 1]) / 70, 0, 1)
    thickness = style.side_mm + (style.top_mm - style.side_mm) * crown
    edge_mm = 14.0 if style.cloth else 26.0
    rise = np.clip((height_mm + (12 if style.cloth else 4)) / edge_mm, 0, 1)
    rise = np.sqrt(rise) if style.cloth else rise * (2 - rise)
    angle = np.arctan2(scalp[:, 0], _CROWN_MM[0] + 40 - scalp[:, 1] + 40)
    waves = 1 + 0.09 * np.sin(scalp[:, 2] / 5.5 + 2 * np.sin(3 * angle)) * (not style.cloth)
    lifted = scalp + (share * rise * thickness * waves)[:, None] * normals
    lifted = np.ascontiguousarray(lifted, np.float32)
    vertex_normals(lifted, triangles, normals)
    uv = np.stack([scalp[:, 2] / 60 + 0.06 * np.sin(5 * angle), angle / 1.2], axis=1)
    coverage = np.clip((height_mm + 3) / (6.0 if style.cloth else 12.0), 0, 1)
    # Deep hair gets less light.
    openness = np.full(len(scalp), 0.62 + 0.38 * share)
    extra = np.stack([np.zeros(len(scalp)), openness, coverage, coverage], axis=1)
    return (Mesh(lifted, normals, uv.astype(np.float32), extra.astype(np.float32), triangles),)


def _refined(fields: FloatArray, quads: I32) -> tuple[FloatArray, I32]:
    """Return vertices (n, D) and quads with each quad cut into four."""
    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middles, centers = fields[unique].mean(axis=1), fields[quads].mean(axis=1)
    ab, bc, cd, da = (len(fields) + inverse.reshape(-1, 4)).T
    center = len(fields) + len(middles) + np.arange(len(quads))
    a, b, c, d = quads.T
    parts = [(a, ab, center, da), (b, bc, center, ab), (c, cd, center, bc), (d, da, center, cd)]
    fine = np.concatenate([np.stack(part, axis=1) for part in parts])
    return np.concatenate([fields, middles, centers]), fine


def _rounded(points: FloatArray, triangles: I32, rounds: int = 3) -> FloatArray:
    """Return the points averaged with their neighbours, the border left where it is."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    border = np.unique(unique[count == 1])
    pairs = np.concatenate([unique, unique[:, ::-1]])
    degree = np.bincount(pairs[:, 0], minlength=len(points))[:, None]
    out = points.copy()
    for _ in range(rounds):
        total = np.zeros_like(out)
        np.add.at(total, pairs[:, 0], out[pairs[:, 1]])
        moved = 0.4 * out + 0.6 * total / degree
        moved[border] = points[border]
        out = moved
    return out


def _strands(style: Style, sparse: float, rng: np.random.Generator) -> Material:
    """Return hair that runs along v; a share `sparse` of it is left out."""
    lanes = rng.normal(size=(1, 512)) + 0.7 * rng.normal(size=(1, 128)).repeat(4, axis=1)
    along = cv2.resize(rng.normal(size=(24, 512)).astype(np.float32), (512, 256))
    field = cv2.GaussianBlur((lanes + 0.8 * along).astype(np.float32), (0, 0), 0.8)
    field = (field - field.mean()) / field.std()
    shade = np.clip(0.95 + 0.16 * field, 0.4, 1.6)
    color = np.clip(np.array(style.color) * shade[..., None], 0, 255)
    if sparse:
        threshold = np.quantile(field, sparse)
        alpha = np.clip(0.5 + 0.9 * (field - threshold), 0, 1)
    else:
        alpha = np.clip(0.85 + 0.12 * field, 0.55, 1)
    texture: U8 = np.concatenate([color, 255 * alpha[..., None]], axis=2).astype(np.uint8)
    values = {"cutoff": 0.45, "shine": 0.5}
    return Material("hair", texture, values, two_sided=True, repeated=True)


def _knit(style: Style, rng: np.random.Generator) -> Material:
    """Return the material of a knitted cap."""
    rows, columns = np.mgrid[0:64, 0:64]
    rib = 0.8 + 0.2 * np.abs(np.sin(2 * np.pi * columns / 16))
    rib = rib * (1 + 0.06 * np.sin(2 * np.pi * rows / 4)) * (1 + 0.05 * rng.normal(size=rib.shape))
    color = np.clip(np.array(style.color) * rib[..., None], 0, 255)
    texture: U8 = np.concatenate([color, np.full((64, 64, 1), 255)], axis=2).astype(np.uint8)
    values = {"cutoff": 0.5, "shine": 0.05}
    return Material("hair", texture, values, two_sided=True, repeated=True)
