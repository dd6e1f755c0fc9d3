"""The bilinear model from examples: principal modes of neutral faces and of displacements.

Everything is split into mirror-symmetric and antisymmetric parts, so that the model's left and
right shapes are exact mirror images and a mirrored person is the same weights with some signs
changed.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from assets.build.face_model.head import Head
from core.arkit import EXPRESSION_NAMES

N_IDENTITY, N_DELTA_SYMMETRIC, N_DELTA_ANTISYMMETRIC = 64, 84, 72
#: Pull of the regression of displacements on identity weights towards none.
RIDGE = 2.0


@dataclass(frozen=True)
class Modes:
    """Orthogonal displacement modes (k, V, 3), and 1 or -1 for symmetric or antisymmetric."""

    fields: np.ndarray
    sign: np.ndarray


@dataclass(frozen=True)
class Factored:
    """The arrays of the model; see core.face_model.FaceModel."""

    mean: np.ndarray
    identity: Modes
    deltas: np.ndarray
    coefficients: np.ndarray


def halves(head: Head, fields: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the symmetric and antisymmetric parts of fields (..., V, 3)."""
    mirrored = head.mirrored(fields)
    return (fields + mirrored) / 2, (fields - mirrored) / 2


def principal(rows: np.ndarray, weight: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the strongest modes (k, V, 3) of rows (n, V, 3) and their singular values.

    Args:
        rows: Fields.
        weight: (V,) importance of each vertex.
        count: Number of modes.
    """
    flat = (rows * weight[:, None]).reshape(len(rows), -1)
    values, vectors = np.linalg.eigh(flat @ flat.T)
    order = np.argsort(values)[::-1][:count]
    size = np.sqrt(np.maximum(values[order], 1e-12))
    modes = (vectors[:, order].T @ flat) / size[:, None]
    # The sign of an eigenvector is arbitrary: choose it so that builds agree.
    largest = np.abs(modes).argmax(axis=1)
    modes *= np.sign(modes[np.arange(len(modes)), largest])[:, None]
    return (modes / np.repeat(weight, 3)).reshape(-1, *rows.shape[1:]), size


def identity_modes(head: Head, people: np.ndarray, weight: np.ndarray) -> tuple[np.ndarray, Modes]:
    """Return the symmetric mean (V, 3) and modes in mm per standard deviation."""
    symmetric, lopsided = halves(head, people)
    mean = symmetric.mean(axis=0)
    parts = [principal(part, weight, N_IDENTITY) for part in (symmetric - mean, lopsided)]
    fields = np.concatenate([modes * size[:, None, None] for modes, size in parts])
    size = np.concatenate([size for _, size in parts])
    sign = np.repeat([1.0, -1.0], [len(parts[0][1]), len(parts[1][1])])
    order = np.argsort(-size)[:N_IDENTITY]
    return mean, Modes(fields[order] / np.sqrt(len(people)), sign[order])


def scores(mean: np.ndarray, modes: Modes, people: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the identity weights (n, I) that come nearest to people (n, V, 3)."""
    scale = np.repeat(weight, 3)
    basis = modes.fields.reshape(len(modes.sign), -1) * scale
    rest = (people - mean).reshape(len(people), -1) * scale
    return np.asarray(np.linalg.solve(basis @ basis.T, basis @ rest.T).T)


def delta_rows(
    shapes: Callable[[np.ndarray], dict[str, np.ndarray]],
    mean: np.ndarray, modes: Modes, weights: np.ndarray,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Return each left or central shape's displacement for (1, w), (I+1, V, 3) float32.

    Args:
        shapes: Makes the expressions of a neutral face.
        mean: (V, 3).
        modes: Identity modes.
        weights: (n, I) identity weights to learn from.
    """
    design = np.hstack([np.ones((len(weights), 1)), weights])
    penalty = RIDGE * np.eye(design.shape[1])
    penalty[0, 0] = 0.0
    solve = np.linalg.solve(design.T @ design + penalty, design.T).astype(np.float32)
    rows: dict[str, np.ndarray] = {}
    for column, weight in zip(solve.T, weights, strict=True):
        face = mean + np.tensordot(weight, modes.fields, axes=1)
        for name, field in shapes(face).items():
            total = rows.setdefault(name, np.zeros((len(column), *field.shape), np.float32))
            total += column[:, None, None] * field.astype(np.float32)
    return rows


def factor_deltas(
    head: Head, rows: dict[str, np.ndarray], sign: np.ndarray, weight: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the displacement modes (M, V, 3) and coefficients (B, I+1, M)."""
    signs = np.concatenate([[1.0], sign])
    even, odd = [], []
    for name, fields in rows.items():
        symmetric, lopsided = halves(head, fields)
        sided = mirror_name(name) != name
        even.append(symmetric if sided else symmetric * (signs > 0)[:, None, None])
        odd.append(lopsided if sided else lopsided * (signs < 0)[:, None, None])
    modes, coefficients = [], []
    for part, count in ((even, N_DELTA_SYMMETRIC), (odd, N_DELTA_ANTISYMMETRIC)):
        stacked = np.concatenate(part)
        fields, _ = principal(stacked, weight, count)
        fields = snapped(head, fields, 1.0 if part is even else -1.0)
        modes.append(fields)
        coefficients.append(fitted(fields, stacked, weight).reshape(len(rows), len(signs), -1))
    table = np.zeros((len(EXPRESSION_NAMES), len(signs), sum(len(m) for m in modes)))
    for number, name in enumerate(rows):
        here, there = (EXPRESSION_NAMES.index(n) for n in (name, mirror_name(name)))
        left, right = coefficients[0][number], coefficients[1][number]
        table[here] = np.hstack([left, right])
        if there != here:
            table[there] = np.hstack([left, -right]) * signs[:, None]
    return np.concatenate(modes), table


def snapped(head: Head, fields: np.ndarray, sign: float) -> np.ndarray:
    """Return modes rounded as they are stored, scaled to 8 mm, exactly mirror-symmetric."""
    size = np.linalg.norm(fields, axis=-1).max(axis=1)
    fields = fields / size[:, None, None] * 8.0
    fields[np.abs(fields) < 2e-3] = 0.0
    return ((fields + sign * head.mirrored(fields)) / 2).astype(np.float16).astype(float)


def fitted(modes: np.ndarray, rows: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the mix (n, k) of modes nearest to rows (n, V, 3)."""
    scale = np.repeat(weight, 3)
    basis = modes.reshape(len(modes), -1) * scale
    return np.asarray(
        np.linalg.solve(basis @ basis.T, basis @ (rows.reshape(len(rows), -1) * scale).T).T
    )


def mirror_name(name: str) -> str:
    """Return the name of the shape's mirror image."""
    for side, other in (("Left", "Right"), ("Right", "Left")):
        if name.endswith(side):
            return name.removesuffix(side) + other
    return name
