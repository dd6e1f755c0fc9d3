"""The kernels' work written down plainly: slow, obvious, to compare with."""

import numpy as np

from core.camera import project
from core.geometry import register_rigid


def appearance(image, camera, points, shape_mm, rotation, center_mm, softening):
    """App of [Cao13]: grey levels (P,) at the points of a shape of the shape space.

    A point x of the shape space lies at rotation^T x + center in the camera frame.
    """
    values = []
    for corners, weights, offset in zip(
        points.corners, points.weights, points.offsets, strict=True
    ):
        place = weights @ shape_mm[corners] + offset
        u, v = project(camera, rotation.T @ place + center_mm)
        values.append(grey_level(image, u, v))
    return local_contrast(np.array(values), points, softening) if softening else np.array(values)


def grey_level(image, u, v):
    height, width = image.shape
    u, v = np.clip(u, 0, width - 1.01), np.clip(v, 0, height - 1.01)
    x, y = int(u), int(v)
    patch = image[y : y + 2, x : x + 2].astype(float)
    return np.array([1 - (v - y), v - y]) @ patch @ np.array([1 - (u - x), u - x])


def local_contrast(values, points, softening):
    around = values[points.members]
    mean, deviation = around.mean(axis=1), np.sqrt(around.var(axis=1) + softening**2)
    return (values - mean[points.cell]) / deviation[points.cell]


def leaf_index(intensities, pairs, thresholds):
    bits = [
        intensities[a] - intensities[b] >= t for (a, b), t in zip(pairs, thresholds, strict=True)
    ]
    return int("".join("1" if bit else "0" for bit in bits), 2)


def fern_sum(intensities, pairs, thresholds, leaves):
    """Return the summed output (D,) of the ferns of one stage."""
    outputs = [
        leaves[k, leaf_index(intensities, pairs[k], thresholds[k])] for k in range(len(pairs))
    ]
    return np.sum(outputs, axis=0, dtype=float)


def best_pair(intensities, target):
    """Return the pair of rows of (P, S) whose difference correlates most with target (S,)."""
    best, found = -1.0, (0, 0)
    for a in range(len(intensities)):
        for b in range(len(intensities)):
            difference = intensities[a] - intensities[b]
            if difference.std() > 1e-3:
                score = np.corrcoef(difference, target)[0, 1]
                if score > best:
                    best, found = score, (a, b)
    return found, best


def shrunk_means(leaf, residuals, n_leaves, shrinkage):
    """Leaves by [Cao13, eq. 10]."""
    leaves = np.zeros((n_leaves, residuals.shape[1]))
    for b in range(n_leaves):
        inside = residuals[leaf == b]
        if len(inside):
            leaves[b] = inside.mean(axis=0) / (1 + shrinkage / len(inside))
    return leaves


def one_pass(regressor, camera, gray, previous_mm, settings):
    """[Cao13, algorithm 2], line by line; returns the shape (Q, 3)."""
    center = previous_mm.mean(axis=0)
    centred = previous_mm - center
    originals = regressor.shapes_mm
    nearest = originals[((originals - centred) ** 2).sum(axis=(1, 2)).argmin()]
    rotation = register_rigid(centred, nearest)[0]
    turned = centred @ rotation.T
    if settings.same_pose:
        originals = np.array([s @ register_rigid(s, nearest)[0].T for s in originals])
    space = (originals[:, None] + regressor.translations_mm[:, None]).reshape(-1, *turned.shape)
    # A shape moved one way is exactly as far as moved the other way: rounded, the first wins.
    distances = np.round(((space - turned) ** 2).sum(axis=(1, 2)), 6)
    order = np.argsort(distances, kind="stable")
    runs = [
        _regress(regressor, camera, gray, space[start].copy(), rotation, center)
        for start in order[: settings.n_runs]
    ]
    combined = np.median(runs, axis=0) if settings.use_median else np.mean(runs, axis=0)
    return combined @ rotation + center


def _regress(regressor, camera, gray, shape, rotation, center):
    for t in range(len(regressor.pairs)):
        seen = appearance(
            gray, camera, regressor.points(t), shape, rotation, center, float(regressor.softening)
        )
        moves = fern_sum(seen, regressor.pairs[t], regressor.thresholds[t], regressor.leaves[t])
        shape = shape + np.tensordot(moves, regressor.basis_mm[t], axes=1)
    return shape
