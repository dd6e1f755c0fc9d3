"""One stage of ferns, applied to several shapes at once.

Loops over the runs are innermost where the compiler can turn them into vector instructions, and
several ferns or numbers are taken together, so that sums are fetched and put back less often.
Indices are made unsigned: a signed index would be tested for counting from the end.
"""

import numba
import numpy as np

from core.records import F32, I8, I16, I32

#: So many ferns of 8 bits cannot overflow a sum of 16 bits.
SAFE = 256


@numba.njit(cache=True, nogil=True)
def choose_leaves(
    intensities: F32,  # (P, R)
    pairs: I32,  # (K, F, 2)
    thresholds: F32,  # (K, F)
    leaf: I32,  # (K, R) out
) -> None:
    """Find the leaf of every fern for every run."""
    n_runs, n_tests = intensities.shape[1], pairs.shape[1]
    for k in range(pairs.shape[0]):
        mine, pair = leaf[k], pairs[k]
        mine[:] = 0
        # Test 0 is the highest bit: the trainer numbers its leaves the same way.
        for f in range(n_tests % 2):
            a, b = intensities[np.uint32(pair[f, 0])], intensities[np.uint32(pair[f, 1])]
            first = thresholds[k, f]
            for r in range(n_runs):
                mine[r] = np.int32(a[r] - b[r] >= first)
        for f in range(n_tests % 2, n_tests, 2):
            a, b = intensities[np.uint32(pair[f, 0])], intensities[np.uint32(pair[f, 1])]
            c, d = intensities[np.uint32(pair[f + 1, 0])], intensities[np.uint32(pair[f + 1, 1])]
            first, second = thresholds[k, f], thresholds[k, f + 1]
            for r in range(n_runs):
                high, low = np.int32(a[r] - b[r] >= first), np.int32(c[r] - d[r] >= second)
                mine[r] = 4 * mine[r] + 2 * high + low


@numba.njit(cache=True, nogil=True)
def add_leaves(
    leaves: I8,  # (K, 2**F, D) steps along the stage's basis
    leaf: I32,  # (K, L or more) as chosen
    short: I16,  # (L, D) scratch
    out: I32,  # (L, D) the sum of all ferns
) -> None:
    """Sum the output of every fern for every run."""
    n_runs, n_numbers = out.shape
    out[:] = 0
    for start in range(0, leaves.shape[0], SAFE):
        end = min(start + SAFE, leaves.shape[0])
        fours = end - (end - start) % 4
        short[:] = 0
        for k in range(start, fours, 4):
            for r in range(n_runs):
                a, b = leaves[k, np.uint32(leaf[k, r])], leaves[k + 1, np.uint32(leaf[k + 1, r])]
                c, d = (
                    leaves[k + 2, np.uint32(leaf[k + 2, r])],
                    leaves[k + 3, np.uint32(leaf[k + 3, r])],
                )
                total = short[r]
                for n in range(n_numbers):
                    two = np.int16(a[n]) + np.int16(b[n])
                    total[n] += two + np.int16(c[n]) + np.int16(d[n])
        for k in range(fours, end):
            for r in range(n_runs):
                for n in range(n_numbers):
                    short[r, n] += np.int16(leaves[k, leaf[k, r], n])
        for r in range(n_runs):
            for n in range(n_numbers):
                out[r, n] += short[r, n]


@numba.njit(cache=True, nogil=True, fastmath={"contract", "reassoc", "nsz"})
def take_steps(
    taken: I32,  # (L, D) steps along the basis
    basis: F32,  # (D, 3 Q) mm per step
    shapes: F32,  # (L or more, 3 Q) mm, the first L are moved
) -> None:
    """Move every shape by its steps."""
    n_steps, n_numbers = basis.shape
    fours = n_steps - n_steps % 4
    for r in range(taken.shape[0]):
        shape = shapes[r]
        for d in range(0, fours, 4):
            w, x = np.float32(taken[r, d]), np.float32(taken[r, d + 1])
            y, z = np.float32(taken[r, d + 2]), np.float32(taken[r, d + 3])
            i, j, k, m = basis[d], basis[d + 1], basis[d + 2], basis[d + 3]
            for n in range(n_numbers):
                shape[n] += (w * i[n] + x * j[n]) + (y * k[n] + z * m[n])
        for d in range(fours, n_steps):
            w, i = np.float32(taken[r, d]), basis[d]
            for n in range(n_numbers):
                shape[n] += w * i[n]
