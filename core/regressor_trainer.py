"""Training samples -> the two-level boosted fern regressor [Cao13, algorithm 1]."""

from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from core.appearance import AppearancePoints
from core.appearance_check import CHECK_POINTS, AppearanceCheck, learn_check
from core.head_size import size_gauge
from core.kernels.training import best_pairs, find_leaves, grow_leaves, inverse_deviations
from core.point_drawing import PointSettings, draw_points, mean_shape
from core.records import F32, I8, I32, Progress
from core.regressor import FernRegressor
from core.sampling import sample
from core.trained_stage import Stage, Watched, moved_by
from core.training_set import TrainingSet


@dataclass(frozen=True, slots=True)
class TrainSettings:
    """Size and regularisation of the regressor; the paper's values in brackets.

    Attributes:
        n_stages: T [10].
        n_ferns: K, ferns per stage [300].
        n_tests: F, tests per fern [5].
        shrinkage: beta, pulls leaves with few samples towards zero [250].
        n_numbers: C, principal components of a stage's residuals in which its leaves are kept;
            0 keeps all 3Q numbers of a shape, as in the paper.
        n_parts: The search for index pairs looks at one part in so many of the samples per fern.
        balance: Random directions favour small components of the residuals by this power of
            1 / standard deviation; 0: the paper, where moving the head drowns moving a lip.
        points: How the appearance points are drawn.
    """

    n_stages: int = 7
    n_ferns: int = 300
    n_tests: int = 5
    shrinkage: float = 250.0
    n_numbers: int = 24
    n_parts: int = 5
    balance: float = 0.5
    points: PointSettings = field(default_factory=PointSettings)


#: The regressor of the paper, for comparison; its training set has no augmentation of its own.
PAPER_SETTINGS = TrainSettings(
    n_stages=10,
    n_ferns=300,
    n_tests=5,
    shrinkage=250.0,
    n_numbers=0,
    n_parts=1,
    balance=0.0,
    points=PointSettings(n_points=400, spread=0.2, reach=0.5, barycentric=False, softening=0.0),
)


def train(
    training_set: TrainingSet, rng: np.random.Generator, settings: TrainSettings | None = None,
    watched: Mapping[str, TrainingSet] | None = None,
) -> Generator[Progress, None, FernRegressor]:  # fmt: skip
    """Learn to move guesses to truths; the same seed gives the same regressor.

    Args:
        training_set: Pictures, guesses and truths.
        rng: Source of all random choices.
        settings: Size of the regressor.
        watched: Pairs that are taken through the stages, too; nothing is learned from them.

    Yields:
        Progress, after every stage, with the mean distance that is left; of watched pairs also
        the error in px after each stage, and before the first, under their keys.

    Returns:
        The regressor.
    """
    settings = settings or TrainSettings()
    shape = mean_shape(training_set.shapes_mm)
    guess = training_set.guess_mm.copy()
    stages: list[Stage] = []
    watches = {
        key: Watched(pairs, settings.points.softening) for key, pairs in (watched or {}).items()
    }
    if watches:
        yield Progress(0, settings.n_stages, "training", _watched(0, watches))
    for done in range(settings.n_stages):
        points = draw_points(shape, training_set.triangles, rng, settings.points)
        intensities = sample(training_set, guess, points, settings.points.softening)
        stage = _train_stage(points, intensities, training_set.truth_mm - guess, rng, settings)
        stages.append(stage[0])
        guess += stage[1]
        left = np.sqrt(np.mean(np.sum((training_set.truth_mm - guess) ** 2, axis=2)))
        for watch in watches.values():
            watch.pass_on(stage[0])
        told = {"left_mm": float(left)} | _watched(done + 1, watches)
        yield Progress(done + 1, settings.n_stages, "training", told)
    check = learn_check(training_set, shape, rng)
    return _assemble(training_set, stages, check, settings.points.softening)


def _watched(stage: int, watches: Mapping[str, Watched]) -> dict[str, float]:
    """Return what is to be plotted of watched pairs."""
    errors = {key: watch.error_px() for key, watch in watches.items()}
    return {"stage": float(stage)} | errors if errors else {}


def _train_stage(
    points: AppearancePoints,
    intensities: F32,
    missing_mm: F32,
    rng: np.random.Generator,
    settings: TrainSettings,
) -> tuple[Stage, F32]:
    """Return a stage and the increments (S, Q, 3) that it makes on its training samples."""
    columns = np.ascontiguousarray(intensities.T)
    centred = columns - columns.mean(axis=1, keepdims=True)
    basis = _principal_basis(missing_mm, settings.n_numbers)
    start = np.einsum("sqk,cqk->sc", missing_mm, basis, optimize=True).astype(np.float32)
    residuals = np.ascontiguousarray(start)
    search = _PairSearch(centred, settings.n_parts)
    n_leaves = 2**settings.n_tests
    pairs = np.zeros((settings.n_ferns, settings.n_tests, 2), np.int32)
    thresholds = np.zeros((settings.n_ferns, settings.n_tests), np.float32)
    leaves = np.zeros((settings.n_ferns, n_leaves, len(basis)), np.float32)
    counts = np.empty(n_leaves, np.int32)
    leaf = np.empty((settings.n_ferns, len(residuals)), np.int32)
    deviations = (residuals.std(axis=0) + np.float32(1e-3)) ** np.float32(settings.balance)
    for k in range(settings.n_ferns):
        directions = rng.normal(size=(len(basis), settings.n_tests)).astype(np.float32)
        directions /= deviations[:, None]
        search.find(residuals, directions, pairs[k])
        places = rng.random(settings.n_tests).astype(np.float32)
        find_leaves(columns, pairs[k], places, thresholds[k], leaf[k])
        grow_leaves(leaf[k], settings.shrinkage, residuals, counts, leaves[k])
    steps, basis = _quantise(leaves, basis)
    return Stage(points, pairs, thresholds, steps, basis), moved_by(steps, basis, leaf)


def _quantise(leaves: F32, basis: F32) -> tuple[I8, F32]:
    """Return leaves (K, 2**F, C) in whole steps and the basis scaled to one step."""
    step = np.maximum(np.abs(leaves).max(axis=(0, 1)), 1e-6) / 127
    return np.rint(leaves / step).astype(np.int8), (basis * step[:, None, None]).astype(np.float32)


class _PairSearch:
    """Finds the differences of intensities that correlate most with targets.

    In covariance form: the variances of all P * P differences follow from the P * P covariances
    of the intensities, once per stage; each target then costs one product with the intensities.
    That product reads all intensities, so every fern uses another part of the samples.
    """

    def __init__(self, centred: F32, n_parts: int) -> None:
        """Take the intensities (P, S) in random order of samples, each row with mean zero."""
        n_points, n_samples = centred.shape
        cuts = np.linspace(0, n_samples, n_parts + 1).astype(int)
        self._spans = [slice(a, b) for a, b in pairwise(cuts)]
        self._parts = [np.ascontiguousarray(centred[:, span]) for span in self._spans]
        self._turn = 0
        self._inverse = np.empty((n_points, n_points), np.float32)
        inverse_deviations(centred @ centred.T / np.float32(n_samples), self._inverse)

    def find(self, residuals: F32, directions: F32, pairs: I32) -> None:
        """Write the best pair (F, 2) for residuals (S, C) seen along directions (C, F)."""
        span, part = self._spans[self._turn], self._parts[self._turn]
        self._turn = (self._turn + 1) % len(self._parts)
        covariances = (residuals[span] @ directions).T @ part.T
        best_pairs(np.ascontiguousarray(covariances), self._inverse, pairs)


def _principal_basis(missing_mm: F32, n_numbers: int) -> F32:
    """Return the orthonormal basis (C, Q, 3) that holds most of the residuals (S, Q, 3)."""
    n_samples, n_points, _ = missing_mm.shape
    flat = missing_mm.reshape(n_samples, -1)
    if n_numbers == 0 or n_numbers >= flat.shape[1]:
        return np.eye(flat.shape[1], dtype=np.float32).reshape(-1, n_points, 3)
    # Not centred: a common shift is part of what has to be moved.
    _, vectors = np.linalg.eigh((flat.T @ flat).astype(np.float64))
    best = vectors[:, ::-1][:, :n_numbers].T
    return np.ascontiguousarray(best.reshape(n_numbers, n_points, 3), dtype=np.float32)


def _assemble(
    training_set: TrainingSet, stages: list[Stage], check: AppearanceCheck, softening: float
) -> FernRegressor:
    shapes = training_set.shapes_mm
    mean = mean_shape(shapes)
    points = [stage.points for stage in stages]
    return FernRegressor(
        corners=np.stack([p.corners for p in points]),
        weights=np.stack([p.weights for p in points]),
        offsets_mm=np.stack([p.offsets for p in points]),
        members=np.stack([p.members for p in points]),
        cell=np.stack([p.cell for p in points]),
        softening=np.array(softening),
        pairs=np.stack([stage.pairs for stage in stages]),
        thresholds=np.stack([stage.thresholds for stage in stages]),
        leaves=np.stack([stage.leaves for stage in stages]),
        basis_mm=np.stack([stage.basis for stage in stages]),
        shapes_mm=shapes - shapes.mean(axis=1, keepdims=True),
        translations_mm=training_set.translations_mm,
        mean_mm=mean,
        size_gauge=size_gauge(shapes, mean),
        check_corners=check.points.corners,
        check_weights=check.points.weights,
        check_members=check.points.members,
        check_cell=check.points.cell,
        check_mean=check.mean,
        check_basis=check.basis,
        check_level=np.array(check.level),
        check_softening=np.array(CHECK_POINTS.softening),
    )
