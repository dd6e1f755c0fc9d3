"""Quadratic steps with bounds: the inner solver of the fits.

A Gauss-Newton step of an image is a quadratic in 6 free numbers (the pose) and B coefficients
in boxes. [Cao13, 4.2] uses projected BFGS for the coefficients and alternates with the pose;
here the pose is eliminated exactly, so both move together, and the remaining small quadratic is
solved by coordinate descent, which respects the bounds at every step.
"""

import numpy as np

from core.kernels.fitting import descend_in_boxes
from core.records import FloatArray

SWEEPS = 60
TOLERANCE = 1e-4


def minimize_in_boxes(
    hessians: FloatArray,
    gradients: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    start: FloatArray,
) -> FloatArray:
    """Return the minimisers (N, B) of x'Hx / 2 + g'x within lower <= x <= upper.

    Args:
        hessians: (N, B, B) symmetric positive definite.
        gradients: (N, B) gradient at x = 0.
        lower: (N, B).
        upper: (N, B), nowhere below `lower`.
        start: (N, B), clipped into the box; a near start saves time.
    """
    out = np.clip(start, lower, upper)
    arrays = [np.ascontiguousarray(a, np.float64) for a in (hessians, gradients, lower, upper)]
    descend_in_boxes(*arrays, SWEEPS, TOLERANCE, np.empty(out.shape[1]), out)
    return out


def minimize_half_bounded(
    hessians: FloatArray,
    gradients: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
) -> FloatArray:
    """Return the minimisers (N, P + B) where only the last B variables are bounded.

    The first P variables are eliminated by the Schur complement.

    Args:
        hessians: (N, P + B, P + B) symmetric positive definite.
        gradients: (N, P + B) gradient at zero.
        lower: (N, B), not above 0: zero is the start.
        upper: (N, B), not below 0.
    """
    n_free = hessians.shape[1] - lower.shape[1]
    cross = hessians[:, :n_free, n_free:]
    right = np.concatenate([gradients[:, :n_free, None], cross], axis=2)
    solved = np.linalg.solve(hessians[:, :n_free, :n_free], right)
    reduced = hessians[:, n_free:, n_free:] - np.swapaxes(cross, 1, 2) @ solved[:, :, 1:]
    slope = gradients[:, n_free:] - np.einsum("npb,np->nb", cross, solved[:, :, 0])
    bounded = minimize_in_boxes(reduced, slope, lower, upper, np.zeros_like(lower))
    free = -solved[:, :, 0] - np.einsum("npb,nb->np", solved[:, :, 1:], bounded)
    return np.concatenate([free, bounded], axis=1)
