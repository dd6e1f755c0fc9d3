"""The loops of the trainer: searching the index pairs, growing the leaves."""

import numba
import numpy as np

from core.records import F32, I32


@numba.njit(cache=True, nogil=True, parallel=True)
def inverse_deviations(
    covariances: F32,  # (P, P) of the intensities
    out: F32,  # (P, P)
) -> None:
    """Write 1 / standard deviation of every difference of two intensities; 0 if it is constant."""
    n_points = covariances.shape[0]
    for p in numba.prange(n_points):
        for q in range(n_points):
            variance = covariances[p, p] + covariances[q, q] - 2 * covariances[p, q]
            out[p, q] = 1 / np.sqrt(variance) if variance > 1e-6 else 0.0


@numba.njit(cache=True, nogil=True)
def best_pairs(
    covariances: F32,  # (F, P) of each target with the intensities
    inverse: F32,  # (P, P) from inverse_deviations
    pairs: I32,  # (F, 2) out
) -> None:
    """Find for every target the pair whose difference correlates most with it.

    cov(target, a - b) = cov(target, a) - cov(target, b), so no difference is ever formed
    [Cao et al. 2012].
    """
    n_tests, n_points = covariances.shape
    for f in range(n_tests):
        row = covariances[f]
        strongest = np.float32(-1)
        for p in range(n_points):
            mine, scales = row[p], inverse[p]
            best = np.float32(0)
            for q in range(n_points):
                # The swapped pair has the opposite sign, so the largest is also the strongest.
                score = (mine - row[q]) * scales[q]
                best = score if score > best else best
            if best > strongest:
                strongest = best
                pairs[f, 0] = p
        p = pairs[f, 0]
        strongest = np.float32(-1)
        for q in range(n_points):
            score = (row[p] - row[q]) * inverse[p, q]
            if score > strongest:
                strongest = score
                pairs[f, 1] = q


@numba.njit(cache=True, nogil=True)
def find_leaves(
    intensities: F32,  # (P, S)
    pairs: I32,  # (F, 2)
    places: F32,  # (F,) where between least and greatest difference each threshold lies
    thresholds: F32,  # (F,) out
    leaf: I32,  # (S,) out
) -> None:
    """Set the thresholds of one fern and find the leaf of every sample."""
    n_samples = intensities.shape[1]
    leaf[:] = 0
    for f in range(pairs.shape[0]):
        first, second = intensities[pairs[f, 0]], intensities[pairs[f, 1]]
        low, high = np.float32(np.inf), np.float32(-np.inf)
        for s in range(n_samples):
            difference = first[s] - second[s]
            low = difference if difference < low else low
            high = difference if difference > high else high
        threshold = low + places[f] * (high - low)
        thresholds[f] = threshold
        for s in range(n_samples):
            # Test 0 is the highest bit: choose_leaves numbers the leaves the same way.
            passed = np.int32(1) if first[s] - second[s] >= threshold else np.int32(0)
            leaf[s] = 2 * leaf[s] + passed


@numba.njit(cache=True, nogil=True)
def grow_leaves(
    leaf: I32,  # (S,)
    shrinkage: float,
    residuals: F32,  # (S, C) what is still missing; the fern's output is taken off
    counts: I32,  # (2**F,) scratch
    leaves: F32,  # (2**F, C) out
) -> None:
    """Fill the leaves with the shrunk mean residuals [Cao13, eq. 10] and apply the fern."""
    n_numbers = residuals.shape[1]
    leaves[:] = 0
    counts[:] = 0
    for s in range(residuals.shape[0]):
        total, missing = leaves[leaf[s]], residuals[s]
        counts[leaf[s]] += 1
        for c in range(n_numbers):
            total[c] += missing[c]
    for b in range(leaves.shape[0]):
        # sum / (n + shrinkage) is the mean times 1 / (1 + shrinkage / n), and 0 when empty.
        share = np.float32(1 / max(counts[b] + shrinkage, 1e-6))
        for c in range(n_numbers):
            leaves[b, c] *= share
    for s in range(residuals.shape[0]):
        output, missing = leaves[leaf[s]], residuals[s]
        for c in range(n_numbers):
            missing[c] -= output[c]
