"""One stage of ferns, applied to several shapes at once."""

import numba
import numpy as np

from core.records import F32, I8, I32


@numba.njit(cache=True, nogil=True)
def add_ferns(
    intensities: F32,  # (P, L)
    pairs: I32,  # (K, F, 2)
    thresholds: F32,  # (K, F)
    leaves: I8,  # (K, 2**F, C) steps along the stage's basis
    leaf: I32,  # (L,) scratch
    out: I32,  # (L, C), added to
) -> None:
    """Add the output of every fern of one stage to `out`."""
    n_runs = intensities.shape[1]
    for k in range(pairs.shape[0]):
        for r in range(n_runs):
            leaf[r] = 0
        for f in range(pairs.shape[1]):
            first, second = intensities[pairs[k, f, 0]], intensities[pairs[k, f, 1]]
            threshold = thresholds[k, f]
            for r in range(n_runs):
                # Test 0 is the highest bit: the trainer numbers its leaves the same way.
                passed = np.int32(1) if first[r] - second[r] >= threshold else np.int32(0)
                leaf[r] = 2 * leaf[r] + passed
        for r in range(n_runs):
            row = leaves[k, leaf[r]]
            for c in range(leaves.shape[2]):
                out[r, c] += row[c]
