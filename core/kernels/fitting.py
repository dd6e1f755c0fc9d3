"""Coordinate descent on small box-constrained quadratics."""

import numba
import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


@numba.njit(cache=True, nogil=True)
def descend_in_boxes(
    hessians: F64,  # (N, B, B) symmetric, positive diagonal
    gradients: F64,  # (N, B) at zero
    lower: F64,  # (N, B)
    upper: F64,  # (N, B)
    sweeps: int,
    tolerance: float,
    slope: F64,  # (B,) scratch
    out: F64,  # (N, B) start in, minimiser out
) -> None:
    """Minimise x'Hx / 2 + g'x in each box, one coordinate after the other."""
    n_values = out.shape[1]
    for n in range(out.shape[0]):
        for b in range(n_values):
            slope[b] = gradients[n, b]
            for c in range(n_values):
                slope[b] += hessians[n, b, c] * out[n, c]
        for _ in range(sweeps):
            largest = 0.0
            for b in range(n_values):
                value = out[n, b] - slope[b] / hessians[n, b, b]
                value = min(max(value, lower[n, b]), upper[n, b])
                step = value - out[n, b]
                if step != 0.0:
                    out[n, b] = value
                    for c in range(n_values):
                        slope[c] += step * hessians[n, b, c]
                    largest = max(largest, abs(step))
            if largest < tolerance:
                break
