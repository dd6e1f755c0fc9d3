"""Hair: a surface over the scalp, combed from the whorl, that frays at the hairline."""

from dataclasses import dataclass

import cv2
import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, vstack

from app.avatars.hairline import above_hairline_mm
from app.avatars.looks import Looks, rgb
from app.render.scene import Material
from core.face_model import FaceModel
from core.kernels.morph import vertex_normals
from core.records import F32, I32, U8, FloatArray

#: Where the hair's whorl is, seen from the middle of the skull.
_SKULL_MM = np.array([0.0, -25.0, 82.0])
_WHORL = np.array([0.0, -0.80, 0.60])


@dataclass(frozen=True, slots=True)
class Cut:
    """A hair cut.

    Attributes:
        top_mm: Thickness on top.
        side_mm: Thickness at the sides and the back.
        hangs: With hair down to the jaw.
    """

    top_mm: float
    side_mm: float
    hangs: bool = False


CUTS: dict[str, Cut] = {
    "short": Cut(19.0, 8.0),
    "cropped": Cut(6.0, 4.0),
    "bob": Cut(15.0, 11.0, hangs=True),
}


@dataclass(frozen=True, slots=True, eq=False)
class Scalp:
    """The part of the head that hair grows on, refined, as a mix of face model vertices.

    Attributes:
        mix: (S, V) rows sum to 1.
        triangles: (T, 3).
        above_mm: (S,) distance above the hairline, on the mean head.
    """

    mix: csr_matrix
    triangles: I32
    above_mm: FloatArray


def scalp_of(model: FaceModel) -> Scalp:
    """Return the scalp of the face model's head."""
    mean = model.mean_mm.astype(float)
    quads = model.quads[model.part[::2] == 0]
    above = above_hairline_mm(mean)
    ears = (np.abs(mean[:, 0]) > 77) & (np.abs(mean[:, 1] - 14) < 54)
    kept = quads[(above[quads].max(axis=1) > -6) & ~ears[quads].any(axis=1)]
    used, flat = np.unique(kept, return_inverse=True)
    quads = flat.reshape(-1, 4).astype(np.int32)
    pick = coo_matrix((np.ones(len(used)), (np.arange(len(used)), used)), (len(used), len(mean)))
    mix, quads = refined(pick.tocsr(), quads)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    above = np.asarray(mix @ above)
    for _ in range(2):
        mix = evened(mix, triangles)
    return Scalp(mix, triangles, above)


def refined(mix: csr_matrix, quads: I32) -> tuple[csr_matrix, I32]:
    """Return vertices and quads with each quad cut into four."""
    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middles = (mix[unique[:, 0]] + mix[unique[:, 1]]) * 0.5
    centers = sum(mix[quads[:, k]] for k in range(4)) * 0.25
    ab, bc, cd, da = (mix.shape[0] + inverse.reshape(-1, 4)).T
    center = mix.shape[0] + len(unique) + np.arange(len(quads))
    a, b, c, d = quads.T
    parts = [(a, ab, center, da), (b, bc, center, ab), (c, cd, center, bc), (d, da, center, cd)]
    fine = np.concatenate([np.stack(part, axis=1) for part in parts]).astype(np.int32)
    return vstack([mix, middles, centers]).tocsr(), fine


def evened(mix: csr_matrix, triangles: I32) -> csr_matrix:
    """Return the vertices averaged with their neighbours, those at the border as they are."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    n = mix.shape[0]
    pairs = np.concatenate([unique, unique[:, ::-1]])
    degree = np.bincount(pairs[:, 0], minlength=n)
    inner = np.ones(n)
    inner[unique[count == 1]] = 0
    weight = 0.6 * inner[pairs[:, 0]] / degree[pairs[:, 0]]
    spread = coo_matrix((weight, pairs.T), (n, n)) + coo_matrix(
        (1 - 0.6 * inner, (np.arange(n), np.arange(n))), (n, n)
    )
    return (spread @ mix).tocsr()


def thickness_mm(scalp_mm: FloatArray, above_mm: FloatArray, cut: Cut) -> FloatArray:
    """Return how thick hair lies over each point of the scalp (S, 3): it lifts at the forehead."""
    top = np.clip((-22 - scalp_mm[:, 1]) / 55, 0, 1)
    top = top * top * (3 - 2 * top)
    lift = np.clip((above_mm + 4) / 20, 0, 1)
    thickness = (cut.side_mm + (cut.top_mm - cut.side_mm) * top) * np.sqrt(lift) * lift**0.25
    # The back of the head tapers to the nape.
    nape = np.clip((scalp_mm[:, 1] - 20) / 40, 0, 1) * (scalp_mm[:, 2] > 90)
    return np.asarray(thickness * (1 - 0.6 * nape))


def combed(scalp_mm: FloatArray) -> FloatArray:
    """Return (S, 2): place across the strands and along them, from the whorl outwards."""
    look = scalp_mm - _SKULL_MM
    look /= np.linalg.norm(look, axis=1, keepdims=True)
    whorl = _WHORL / np.linalg.norm(_WHORL)
    forward = np.array([0.0, whorl[2], -whorl[1]]) * -1
    along = np.arccos(np.clip(look @ whorl, -1, 1))
    ahead = look @ forward
    turn = np.arctan2(np.abs(look[:, 0]), -ahead if ahead.mean() > 0 else ahead)
    # Locks wander a little, not alike on both sides.
    wander = 0.05 * np.sin(scalp_mm[:, 0] / 9 + 2 * along) + 0.05 * np.sin(scalp_mm[:, 2] / 13)
    return np.stack([(turn + wander) / np.pi, along / np.pi], axis=1)


def hair_mm(scalp: Scalp, head_mm: FloatArray, cut: Cut) -> FloatArray:
    """Return the points (S, 3) of the hair's surface over a head (V, 3)."""
    points = np.ascontiguousarray(scalp.mix @ head_mm, np.float32)
    normals: F32 = np.empty_like(points)
    vertex_normals(points, scalp.triangles, normals)
    thickness = thickness_mm(points.astype(float), scalp.above_mm, cut)
    across, along = combed(points.astype(float)).T
    locks = np.sin(across * 58 + 3 * np.sin(along * 9)) + 0.7 * np.sin(across * 97 + along * 14)
    lift = thickness * (1 + 0.075 * locks)
    out = points + lift[:, None] * normals
    # Combed: the ends of the hair lie lower and further out than their roots.
    out[:, 1] += 0.10 * lift * np.clip(along * 3 - 0.8, 0, 1)
    return np.asarray(out, float)


def strands(looks: Looks, rng: np.random.Generator) -> Material:
    """Return hair running along v; the surface frays into strands where coverage falls."""
    shape = (256, 1024)
    fine = rng.normal(size=(1, shape[1])).repeat(shape[0], axis=0)
    locks = cv2.resize(rng.normal(size=(1, 96)), (shape[1], 1), interpolation=cv2.INTER_CUBIC)
    drift = cv2.resize(rng.normal(size=(10, 512)), shape[::-1], interpolation=cv2.INTER_CUBIC)
    field = cv2.GaussianBlur(fine + 1.1 * locks + 0.9 * drift, (0, 0), 0.9)
    field = (field - field.mean()) / field.std()
    color = rgb(*looks.hair) * (0.98 + 0.17 * field[..., None])
    coverage = 0.74 + 0.26 * np.tanh(field)
    picture = np.concatenate([color, 255 * coverage[..., None]], axis=2)
    texture: U8 = np.clip(picture, 0, 255).astype(np.uint8)
    return Material("hair", texture, two_sided=True, repeated=True)
