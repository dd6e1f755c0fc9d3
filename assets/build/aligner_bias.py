"""Measures the mean error of the landmark network and writes assets/aligner/bias.npz.

`python -m assets.build.aligner_bias` renders 160 people of the face model, 34 pictures each, aligns
every picture, and fits each internal landmark's error, upright and in mm, by a regularised linear
function of `core.aligner_bias.features`. Mirror images count too. The virtual performers take no
part in it. It takes about ten minutes on one core.
"""

import numpy as np

import app  # noqa: F401 - sets up numba's cache before it is imported
from app.resources import asset
from assets.build.aligner_faces import Studio
from core.aligner_bias import AlignerBias, features, in_plane, unposed_mm
from core.alignment import FaceAligner
from core.face_model import load_face_model
from core.geometry import head_angles_from_matrix
from core.landmark_confidence import confidences, visibility
from core.landmarks import MESH478, MIRROR, N_INTERNAL
from core.mean_face import MeanFace, head_pose, load_mean_face
from core.outline import outline_lines
from core.records import I32

#: Rolls of the dice, 20 people each.
SEEDS = range(101, 109)
N_SHAPES = 100
#: Every network point so near to a landmark's is read too, in mm on the mean face.
REACH_MM = 7.0
#: Weight of the squared coefficients against the mean squared error, but for the polynomial.
RIDGE, RIDGE_ANGLES, N_ANGLE_TERMS = 1e-2, 1e-6, 11
#: Landmarks further off than this from what is foretold count less.
ROBUST_MM = 2.5
ROUNDS = 3
#: Pictures in which a point is not seen still count a little: there the network guesses.
UNSEEN = 0.02


def main() -> None:
    """Measure and write."""
    model, aligner = load_face_model(asset("face_model.npz")), FaceAligner(asset("aligner"))
    samples = []
    for seed in SEEDS:
        studio = Studio(model, seed)
        samples += studio.samples(aligner)
        studio.release()
        print(f"{len(samples)} pictures", flush=True)
    meshes, truths = (np.array(each, np.float64) for each in zip(*samples, strict=True))
    write(fitted(load_mean_face(asset("aligner") / "mean_face.npz"), meshes, truths))


def fitted(mean: MeanFace, meshes: np.ndarray, truths: np.ndarray) -> AlignerBias:
    """Return the bias that meshes (N, 478, 3) and true landmarks (N, 60, 2) show."""
    points = read_points(mean)
    swap = np.searchsorted(points, mirror_points(mean)[points])
    angles, shapes, errors, weights = both_sides(measured(mean, points, meshes, truths), swap)
    mean_mm = shapes.mean(axis=0)
    modes = whitening_modes((shapes - mean_mm).reshape(len(shapes), -1))
    terms = features(angles, (shapes - mean_mm).reshape(len(shapes), -1) @ modes.T)
    coefficients = np.stack([
        robust_ridge(terms, errors[:, one], weights[:, one]) for one in range(N_INTERNAL)
    ])  # fmt: skip
    report(angles, errors, errors - np.einsum("lcf,nf->nlc", coefficients, terms), weights)
    return AlignerBias(points, mean_mm, modes.reshape(len(modes), -1, 3), coefficients)


def measured(
    mean: MeanFace, points: I32, meshes: np.ndarray, truths: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Return yaw and pitch (N, 2), shapes (N, P, 3), errors (N, 60, 2) in mm, weights (N, 60)."""
    seen = visibility(mean, outline_lines(mean))
    rows = []
    for mesh, truth in zip(meshes, truths, strict=True):
        scale, rotation = head_pose(mean, mesh[:, :2], mesh[:, 2])
        yaw, pitch, roll = head_angles_from_matrix(rotation)
        off = mesh[MESH478[:N_INTERNAL], :2] - truth
        trust = confidences(seen, mesh[:, :2], mesh[:, 2], rotation)[:N_INTERNAL] + UNSEEN
        shape = unposed_mm(mesh[points], rotation, scale)
        rows.append((np.array([yaw, pitch]), shape, off @ in_plane(-roll).T / scale, trust))
    return tuple(np.array(column) for column in zip(*rows, strict=True))


def mirror_points(mean: MeanFace) -> I32:
    """Return the network point (468,) on the other side of each, 0-based."""
    there = mean.vertices_mm * [-1, 1, 1]
    distance = np.linalg.norm(mean.vertices_mm[:, None] - there[None], axis=2)
    return np.asarray(distance.argmin(axis=0), np.int32)


def read_points(mean: MeanFace) -> I32:
    """Return the network points (P,) whose places tell the shape: those at our landmarks."""
    marks = np.concatenate([mean.vertices_mm[MESH478], mean.vertices_mm[MESH478] * [-1, 1, 1]])
    distance = np.linalg.norm(mean.vertices_mm[:, None] - marks[None], axis=2).min(axis=1)
    near = np.flatnonzero(distance < REACH_MM)
    both = np.concatenate([near, mirror_points(mean)[near], mean.pose_points])
    return np.unique(np.concatenate([both, mirror_points(mean)[both]])).astype(np.int32)


def both_sides(columns: tuple[np.ndarray, ...], swap: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return what was measured, then the same of the mirror images."""
    angles, shapes, errors, weights = columns
    other = (
        angles * [-1, 1],
        shapes[:, swap] * [-1, 1, 1],
        errors[:, MIRROR[:N_INTERNAL]] * [-1, 1],
        weights[:, MIRROR[:N_INTERNAL]],
    )
    return tuple(np.concatenate(pair) for pair in zip(columns, other, strict=True))


def whitening_modes(centred: np.ndarray) -> np.ndarray:
    """Return (K, 3P) the strongest principal directions over their standard deviations."""
    variances, directions = np.linalg.eigh(centred.T @ centred / len(centred))
    strongest = slice(-1, -N_SHAPES - 1, -1)
    modes = directions.T[strongest] / np.sqrt(variances[strongest, None])
    # The sign of an eigenvector is arbitrary; the same file should come out everywhere.
    largest = np.take_along_axis(modes, np.abs(modes).argmax(axis=1)[:, None], axis=1)
    return np.asarray(modes * np.sign(largest))


def robust_ridge(terms: np.ndarray, errors: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return coefficients (2, F) of errors (N, 2) in terms (N, F), robust to single misses."""
    ridge = np.full(terms.shape[1], RIDGE)
    ridge[:N_ANGLE_TERMS] = RIDGE_ANGLES
    trust = weights
    for _ in range(ROUNDS):
        weighted = terms * trust[:, None]
        gram = weighted.T @ terms + np.diag(ridge * trust.sum())
        solved = np.linalg.solve(gram, weighted.T @ errors)
        missed = np.linalg.norm(errors - terms @ solved, axis=1)
        trust = weights / np.maximum(missed / ROBUST_MM, 1.0)
    return np.asarray(solved.T)


def report(angles: np.ndarray, before: np.ndarray, after: np.ndarray, weights: np.ndarray) -> None:
    """Print root mean square errors of the pictures measured."""
    yaw_deg = np.abs(np.rad2deg(angles[:, 0]))
    for low, high in ((0, 20), (20, 40), (40, 70)):
        near = (yaw_deg >= low) & (yaw_deg < high)
        sizes = [
            np.sqrt(np.average((e[near] ** 2).sum(axis=2), weights=weights[near]))
            for e in (before, after)
        ]
        print(f"yaw {low}-{high}: {near.sum()} pictures, {sizes[0]:.2f} mm, left {sizes[1]:.2f} mm")


def write(bias: AlignerBias) -> None:
    """Write the file; half precision moves no landmark by a hundredth of a pixel."""
    np.savez_compressed(
        asset("aligner") / "bias.npz",
        points=bias.points.astype(np.int16),
        mean_mm=bias.mean_mm.astype(np.float32),
        modes_per_mm=bias.modes_per_mm.astype(np.float16),
        coefficients_mm=bias.coefficients_mm.astype(np.float16),
    )


if __name__ == "__main__":
    main()
