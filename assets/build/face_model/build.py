"""The steps from the wheel to the arrays of the model and of the people outside it."""

from dataclasses import dataclass

import numpy as np

from assets.build.face_model import landmarks
from assets.build.face_model.factor import (
    Factored,
    delta_rows,
    factor_deltas,
    identity_modes,
    mirror_name,
    scores,
)  # fmt: skip
from assets.build.face_model.head import PART_NAMES, Head, build_head
from assets.build.face_model.people import average_person, make_people, neutral_of
from assets.build.face_model.sculpt import sculpt
from assets.build.face_model.sculptor import Sculptor
from assets.build.face_model.settle import Settler, make_settler
from assets.build.face_model.source import Wheel
from assets.build.face_model.surface import smooth_step
from assets.build.face_model.texture_space import corner_uv
from assets.build.face_model.transfer import Transfer
from core.arkit import EXPRESSION_NAMES

N_PEOPLE, SEED = 170, 20130721
N_OUTSIDE, OUTSIDE_SEED = 3, 7


@dataclass(frozen=True)
class Workshop:
    """What all steps share."""

    wheel: Wheel
    head: Head
    sculptor: Sculptor
    settle: Settler
    transfer: Transfer


def open_workshop(wheel: Wheel) -> Workshop:
    """Return the sculpted reference head and what carries it to others."""
    head = build_head(wheel)
    average = neutral_of(wheel, head, average_person(wheel))
    settle = make_settler(Sculptor(wheel, head, average))
    sculptor = Sculptor(wheel, head, settle(average))
    return Workshop(wheel, head, sculptor, settle, Transfer(sculptor, sculpt(sculptor), settle))


def vertex_importance(shop: Workshop) -> np.ndarray:
    """Return (V,) how much an error at each vertex matters: most at lips and lids."""
    surface, chart, lids = shop.sculptor.surface, shop.sculptor.chart, shop.settle.lids
    rim = [*lids.upper_rim, *lids.lower_rim]
    near = surface.distance([*rim, *shop.head.mirror[rim], *chart.ring("seam")])
    back = smooth_step((surface.points[:, 2] - 20.0) / 60.0)
    out = np.full(shop.head.n_vertices, 1.0)
    out[: surface.n] = (1 + 2.5 * (1 - smooth_step(near / 8.0))) * (1 - 0.7 * back)
    out[-2:] = 3.0
    return (out + out[shop.head.mirror]) / 2


def build_model(shop: Workshop) -> Factored:
    """Return the bilinear model of generated people."""
    rng = np.random.default_rng(SEED)
    people = np.stack([shop.settle(p) for p in make_people(shop.wheel, shop.head, rng, N_PEOPLE)])
    people = np.concatenate([people, shop.head.mirrored(people)])
    weight = vertex_importance(shop)
    mean, modes = identity_modes(shop.head, people, weight)
    known = scores(mean, modes, people, weight)
    rows = delta_rows(shop.transfer.deltas, mean, modes, known)
    deltas, coefficients = factor_deltas(shop.head, rows, modes.sign, weight)
    return Factored(mean, modes, deltas, coefficients)


def all_sides(head: Head, left: dict[str, np.ndarray], right: dict[str, np.ndarray]) -> np.ndarray:
    """Return the 46 expressions (B, V, 3) from those of a face and of its mirror image."""
    out = np.zeros((len(EXPRESSION_NAMES), head.n_vertices, 3))
    for name, field in left.items():
        other = mirror_name(name)
        out[EXPRESSION_NAMES.index(name)] = field
        if other != name:
            out[EXPRESSION_NAMES.index(other)] = head.mirrored(right[name])
    return out


def build_outsiders(shop: Workshop) -> tuple[np.ndarray, np.ndarray]:
    """Return people outside the model: neutral faces (n, V, 3) and their deltas (n, B, V, 3).

    Some of their local targets occur in no person of the model, and each makes faces in a
    personal way: stronger or weaker, lopsided, with traces of other expressions.
    """
    rng = np.random.default_rng(OUTSIDE_SEED)
    people = make_people(shop.wheel, shop.head, rng, N_OUTSIDE, held_out=True)
    neutrals = np.stack([shop.settle(person) for person in people])
    deltas = []
    for face in neutrals:
        left = shop.transfer.deltas(face)
        right = shop.transfer.deltas(shop.head.mirrored(face))
        deltas.append(personal(all_sides(shop.head, left, right), rng))
    return neutrals, np.stack(deltas)


def personal(deltas: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return expressions (B, V, 3) with a person's own strengths and mixtures."""
    names = EXPRESSION_NAMES
    exact = np.array([n.startswith(("eyeBlink", "jawOpen", "mouthClose")) for n in names])
    closed = np.array([not n.startswith(OPENING) for n in names])
    strength = np.where(exact, 1.0, rng.uniform(0.82, 1.15, len(names)))
    traces = rng.normal(0, 0.035, (len(names), len(names)))
    traces[exact] = 0.0
    traces[:, ~closed | exact] = 0.0
    return np.tensordot(np.diag(strength) + traces, deltas, axes=1)


OPENING = (
    "jaw", "mouthClose", "mouthFunnel", "mouthLowerDown", "mouthUpperUp", "eyeBlink", "eyeWide",
)  # fmt: skip


def topology_arrays(shop: Workshop) -> dict[str, np.ndarray]:
    """Return the arrays of the model that do not depend on shape."""
    head = shop.head
    uv = corner_uv(head, shop.sculptor.reference)
    triangles = np.stack([head.quads[:, [0, 1, 2]], head.quads[:, [0, 2, 3]]], axis=1)
    corners = np.stack([uv[:, [0, 1, 2]], uv[:, [0, 2, 3]]], axis=1)
    strips = np.full((15, max(map(len, landmarks.STRIPS))), -1)
    for row, strip in zip(strips, landmarks.STRIPS, strict=True):
        row[: len(strip)] = strip
    return {
        "expression_names": np.array(EXPRESSION_NAMES),
        "part_names": np.array(PART_NAMES),
        "triangles": triangles.reshape(-1, 3).astype(np.uint16),
        "part": np.repeat(head.part, 2).astype(np.uint8),
        "uv": np.round(np.clip(corners.reshape(-1, 3, 2), 0, 1) * 65535).astype(np.uint16),
        "landmark_vertices": np.array(landmarks.INTERNAL, np.uint16),
        "replacement_vertices": np.array(landmarks.REPLACEMENTS, np.uint16),
        "contour_strips": strips.astype(np.int16),
        "eyeball_vertices_right": head.group["helper-r-eye"].astype(np.uint16),
        "eyeball_vertices_left": head.group["helper-l-eye"].astype(np.uint16),
        "eye_center_vertices": np.array([head.n_vertices - 2, head.n_vertices - 1], np.uint16),
        "mirror_vertices": head.mirror.astype(np.uint16),
    }


def model_arrays(shop: Workshop, model: Factored) -> dict[str, np.ndarray]:
    """Return the arrays of face_model.npz."""
    ball = shop.head.group["helper-r-eye"]
    radius = np.linalg.norm(model.mean[ball] - model.mean[-2], axis=1).mean()
    symmetric = (model.mean + shop.head.mirrored(model.mean)) / 2
    return topology_arrays(shop) | {
        "mean_mm": symmetric.astype(np.float32),
        "identity_modes_mm": model.identity.fields.astype(np.float16),
        "identity_mirror": model.identity.sign.astype(np.float32),
        "delta_modes_mm": model.deltas.astype(np.float16),
        "delta_coefficients": model.coefficients.astype(np.float16),
        "eyeball_radius_mm": np.float32(radius),
    }
