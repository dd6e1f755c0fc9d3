"""One-dimensional search for the focal length [Cao13, camera calibration]."""

from collections.abc import Callable, Generator

import numpy as np

from core.errors import CoreError
from core.records import FloatArray, Progress

_GOLDEN = (np.sqrt(5.0) - 1) / 2
#: Places that a cubic is fitted to, at least, and how far its minimum may be from the best.
_LEAST_PLACES, _FINE = 5, 0.04


class FocalNotBracketedError(CoreError):
    """The fitting error has no minimum inside the searched focal lengths."""

    def __init__(self, low_px: float, high_px: float, best_px: float) -> None:
        self.low_px, self.high_px, self.best_px = low_px, high_px, best_px
        super().__init__(
            f"fitting error still falls at focal length {best_px:.0f} px, an end of "
            f"the searched interval [{low_px:.0f}, {high_px:.0f}] px; check the "
            "landmarks of the turned-head images, or widen the interval"
        )


def search_focal(
    error: Callable[[float], float], low_px: float, high_px: float, steps: int = 20
) -> Generator[Progress, None, float]:
    """Find the focal length with the least fitting error.

    The error, as a function of the focal length, falls and then rises [Cao13, camera
    calibration], so each step can drop the part of the interval beyond the worse of two
    inner points. The interval shrinks by the golden ratio rather than by halves: one of the two
    points is then reused, and one evaluation costs a fit of all setup pictures. Lengths are
    compared by ratio.

    Args:
        error: Fitting error at a focal length in px.
        low_px: Lower end of the interval.
        high_px: Upper end of the interval.
        steps: Number of evaluations after the first two.

    Yields:
        Progress, once per evaluation.

    Returns:
        The focal length in px.

    Raises:
        FocalNotBracketedError: The least error lies at an end of the interval.
    """
    low, high = np.log(low_px), np.log(high_px)
    inner = [high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)]
    errors = []
    for done, place in enumerate(inner, 1):
        errors.append(error(float(np.exp(place))))
        yield _progress(done, steps + 2, place, errors[-1])
    for done in range(3, steps + 3):
        worse = int(errors[0] < errors[1])
        low, high = (low, inner[1]) if worse else (inner[0], high)
        kept = inner[1 - worse]
        fresh = low + high - kept
        value = error(float(np.exp(fresh)))
        inner, errors = ([fresh, kept], [value, errors[1 - worse]])
        if fresh > kept:
            inner, errors = inner[::-1], errors[::-1]
        yield _progress(done, steps + 2, fresh, value)
    best = float(np.exp(inner[int(np.argmin(errors))]))
    # An end that was never dropped holds the minimum to within the last interval.
    if low == np.log(low_px) or high == np.log(high_px):
        raise FocalNotBracketedError(low_px, high_px, best)
    return best


def _progress(done: int, total: int, place: float, error: float) -> Progress:
    plot = {"focal_px": float(np.exp(place)), "error": error}
    return Progress(done, total, "Calibrating the camera", plot)


def smooth_minimum(
    places: FloatArray, errors: FloatArray, best: float, reach: float = 0.25
) -> tuple[float, float]:
    """Return where the cubic through the errors near the best is least, and its spread.

    A cubic, because a short focal length is told from a shorter one more easily than a long one
    from a longer: the parabola through such errors has its minimum too far out, by 2 % of the
    focal length where the errors are flat.

    Args:
        places: (K,).
        errors: (K,) twice a negative log probability.
        best: Place of the least error.
        reach: How far from it the cubic is fitted.
    """
    near = np.abs(places - best) < reach
    if near.sum() < _LEAST_PLACES:
        return best, reach
    cubic = np.polynomial.Polynomial.fit(places[near] - best, errors[near], 3)
    shifts = np.linspace(-_FINE, _FINE, 1001)
    shift = shifts[cubic(shifts).argmin()]
    curvature = cubic.deriv(2)(shift)
    if curvature <= 0:
        return best, reach
    return best + float(shift), float(np.sqrt(2 / curvature))
