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


@numba.njit(cache=True, nogil=True, parallel=True)
def best_pairs(
    covariances: F32,  # (F, P) of each target with the intensities
    inverse: F32,  # (P, P) from inverse_deviations
    row_best: F32,  # (F, P) scratch
    pairs: I32,  # (F, 2) out
) -> None:
    """Find for every target the pair whose difference correlates most with it.

    cov(target, a - b) = cov(target, a) - cov(target, b), so no difference is ever formed
    [Cao et al. 2012].
    """
    n_tests, n_points = covariances.shape
    for p in numba.prange(n_points):
        for f in range(n_tests):
            best = np.float32(0)
            for q in range(n_points):
                # The swapped pair has the opposite sign, so the largest is also the strongest.
                score = (covariances[f, p] - covariances[f, q]) * inverse[p, q]
                best = max(best, score)
            row_best[f, p] = best
    for f in range(n_tests):
        p = np.argmax(row_best[f])
        best = np.float32(-1)
        for q in range(n_points):
            score = (covariances[f, p] - covariances[f, q]) * inverse[p, q]
            if score > best:
                best = score
                pairs[f, 1] = q
        pairs[f, 0] = p


@numba.njit(cache=True, nogil=True, parallel=True)
def difference_ranges(
    intensities: F32,  # (P, S)
    pairs: I32,  # (F, 2)
    out: F32,  # (F, 2) least and greatest difference
) -> None:
    """Find the range of every difference over all samples."""
    for f in numba.prange(pairs.shape[0]):
        first, second = intensities[pairs[f, 0]], intensities[pairs[f, 1]]
        low, high = np.float32(np.inf), np.float32(-np.inf)
        for s in range(intensities.shape[1]):
            difference = first[s] - second[s]
            low, high = min(low, difference), max(high, difference)
        out[f, 0], out[f, 1] = low, high


@numba.njit(cache=True, nogil=True, parallel=True)
def grow_fern(
    intensities: F32,  # (P, S)
    pairs: I32,  # (F, 2)
    thresholds: F32,  # (F,)
    shrinkage: float,
    residuals: F32,  # (S, C) what is still missing; the fern's output is taken off
    sums: F32,  # (chunks, 2**F, C) scratch
    counts: I32,  # (chunks, 2**F) scratch
    leaf: I32,  # (S,) scratch
    leaves: F32,  # (2**F, C) out
) -> None:
    """Fill the leaves with the shrunk mean residuals [Cao13, eq. 10] and apply the fern.

    The samples are summed in a fixed number of chunks, so the result does not depend on the
    number of threads.
    """
    n_samples, n_numbers = residuals.shape
    n_chunks = sums.shape[0]
    for chunk in numba.prange(n_chunks):
        start, stop = chunk * n_samples // n_chunks, (chunk + 1) * n_samples // n_chunks
        leaf[start:stop] = 0
        for f in range(pairs.shape[0]):
            first, second = intensities[pairs[f, 0]], intensities[pairs[f, 1]]
            for s in range(start, stop):
                # Test 0 is the highest bit: add_ferns numbers the leaves the same way.
                passed = np.int32(1) if first[s] - second[s] >= thresholds[f] else np.int32(0)
                leaf[s] = 2 * leaf[s] + passed
        sums[chunk] = 0
        counts[chunk] = 0
        for s in range(start, stop):
            counts[chunk, leaf[s]] += 1
            for c in range(n_numbers):
                sums[chunk, leaf[s], c] += residuals[s, c]
    for b in range(leaves.shape[0]):
        size = counts[:, b].sum()
        for c in range(n_numbers):
            # sum / (n + shrinkage) is the mean times 1 / (1 + shrinkage / n), and 0 when empty.
            leaves[b, c] = sums[:, b, c].sum() / max(size + shrinkage, 1e-6)
    for chunk in numba.prange(n_chunks):
        for s in range(chunk * n_samples // n_chunks, (chunk + 1) * n_samples // n_chunks):
            for c in range(n_numbers):
                residuals[s, c] -= leaves[leaf[s], c]
