"""Does the picture look, at the found shape, like the face the regressor was trained on?"""

from dataclasses import dataclass

import numpy as np

from core.appearance import AppearancePoints
from core.point_drawing import PointSettings, draw_points
from core.records import F32, FloatArray, freeze
from core.sampling import sample, uncovered, undisturbed
from core.training_set import TrainingSet

#: Raw grey levels would call every change of the light a failure.
CHECK_POINTS = PointSettings(n_points=256, spread=0.12, softening=6.0)
N_COMPONENTS = 24
N_SAMPLES = 1500
N_FOLDS = 6
#: The 99 % level on another take, in parts of that on held-out pictures of the setup itself: the
#: face does things that it did not do then. Measured on the real clips.
OTHER_TAKE = 1.4


@dataclass(frozen=True, slots=True, eq=False)
class AppearanceCheck:
    """A linear model of the appearance at the right shape.

    Attributes:
        points: Where it looks.
        mean: (P,) mean appearance of the training pictures.
        basis: (C, P) orthonormal, how the appearance varies among them.
        level: Distance from the model that 99 % of good frames stay below.
    """

    points: AppearancePoints
    mean: F32
    basis: F32
    level: float

    def __post_init__(self) -> None:
        freeze(self, mean=(np.float32, ("P",)), basis=(np.float32, ("C", "P")))


def learn_check(
    training_set: TrainingSet, shape_mm: FloatArray, rng: np.random.Generator
) -> AppearanceCheck:
    """Learn what the training pictures look like at their true shapes.

    The model is learned from disturbed samples, so that another lamp is no failure. The level
    comes from given pictures that the model was not learned from: each sixth in turn is held out,
    with what was made from it.

    Args:
        training_set: Pictures and shapes.
        shape_mm: (Q, 3) mean shape, for drawing the points.
        rng: Source of the points.
    """
    points = draw_points(shape_mm, training_set.triangles, rng, CHECK_POINTS)
    plain, lit = undisturbed(training_set), uncovered(training_set, N_SAMPLES)
    softening = CHECK_POINTS.softening
    appearances = np.concatenate([sample(s, s.truth_mm, points, softening) for s in (plain, lit)])
    origin = training_set.origin
    fold = origin[np.concatenate([plain.image, lit.image])] % N_FOLDS
    tested = np.flatnonzero(origin == np.arange(len(origin)))
    distances = np.zeros(len(tested))
    for k in range(N_FOLDS):
        if np.any(fold == k) and np.any(fold != k):
            mean, basis = _linear_model(appearances[fold != k])
            away = tested[fold[tested] == k]
            distances[away] = residuals(appearances[away], mean, basis)
    mean, basis = _linear_model(appearances)
    return AppearanceCheck(points, mean, basis, OTHER_TAKE * _level(distances))


def residuals(appearances: F32, mean: F32, basis: F32) -> FloatArray:
    """Return the RMS distance (N,) of appearances (N, P) from the linear model."""
    difference = (appearances - mean).astype(np.float64)
    inside = difference @ basis.T.astype(np.float64)
    squared = (difference**2).sum(axis=1) - (inside**2).sum(axis=1)
    return np.asarray(np.sqrt(np.maximum(squared, 0) / appearances.shape[1]))


def _linear_model(appearances: F32) -> tuple[F32, F32]:
    mean = appearances.mean(axis=0)
    n_components = min(N_COMPONENTS, (len(appearances) - 1) // 2)
    basis = np.linalg.svd(appearances - mean, full_matrices=False)[2][:n_components]
    return mean.astype(np.float32), basis.astype(np.float32)


def _level(distances: FloatArray) -> float:
    """Return the 99 % level of distances that are about normally distributed.

    Some tens of pictures have no 99th percentile of their own, and one bad label among them
    must not set it: median and quartiles are extrapolated.
    """
    low, middle, high = np.percentile(distances, [25, 50, 75])
    # The quartiles of a normal distribution are 1.349 deviations apart; 2.326 is its 99 % point.
    return float(max(middle + 2.326 * (high - low) / 1.349, 1e-6))
