"""One trained stage of the regressor, and how near it brings shapes to the truth.

The error against the stage is what [Cao13, algorithm 1] is watched by: as long as it falls on
pictures that training did not see, more stages help.
"""

from dataclasses import dataclass

import numpy as np

from core.appearance import AppearancePoints
from core.camera import project
from core.kernels.ferns import add_leaves, choose_leaves
from core.records import F32, I8, I32
from core.sampling import sample
from core.training_set import TrainingSet


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """One trained stage.

    Attributes:
        points: Where it looks.
        pairs: (K, F, 2) indices of appearance points.
        thresholds: (K, F).
        leaves: (K, 2**F, C) steps along the basis.
        basis: (C, Q, 3) mm per step.
    """

    points: AppearancePoints
    pairs: I32
    thresholds: F32
    leaves: I8
    basis: F32


def increments(stage: Stage, intensities: F32) -> F32:
    """Return how a stage moves shapes whose appearance is given.

    Args:
        stage: The stage.
        intensities: (S, P) grey levels at its points.

    Returns:
        (S, Q, 3) mm, the same as the live regression makes.
    """
    leaf = np.empty((len(stage.pairs), len(intensities)), np.int32)
    choose_leaves(np.ascontiguousarray(intensities.T), stage.pairs, stage.thresholds, leaf)
    return moved_by(stage.leaves, stage.basis, leaf)


def moved_by(leaves: I8, basis: F32, leaf: I32) -> F32:
    """Return the sum (S, Q, 3) in mm of the leaves (K, S) that were chosen."""
    steps = np.empty((leaf.shape[1], len(basis)), np.int32)
    add_leaves(leaves, leaf, np.empty(steps.shape, np.int16), steps)
    moved = np.einsum("sc,cqk->sqk", steps.astype(np.float32), basis, optimize=True)
    return np.asarray(moved, np.float32)


class Watched:
    """Pairs of guess and truth that are taken through the stages while these are trained."""

    def __init__(self, pairs: TrainingSet, softening: float) -> None:
        """Begin at the guesses.

        Args:
            pairs: Nothing is learned from them.
            softening: Of the contrast normalisation, as in training.
        """
        self._pairs, self._softening = pairs, softening
        self._shapes = pairs.guess_mm.copy()

    def pass_on(self, stage: Stage) -> None:
        """Move the shapes as the next stage does."""
        seen = sample(self._pairs, self._shapes, stage.points, self._softening)
        self._shapes += increments(stage, seen)

    def error_px(self) -> float:
        """Return the mean over the pairs of their RMS landmark distance, in px."""
        pairs = self._pairs
        shift = pairs.shift_mm[:, None].astype(np.float64)
        places = [
            project(pairs.camera, shapes + shift) for shapes in (self._shapes, pairs.truth_mm)
        ]
        squared = np.sum((places[0] - places[1]) ** 2, axis=2)
        return float(np.sqrt(squared.mean(axis=1)).mean())
