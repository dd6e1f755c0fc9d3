"""The expressions of the last frames, sampled as the animation prior wants them."""

import numpy as np

from core.animation_prior import N_LAGS
from core.kernels.tracking import sample_history
from core.records import FloatArray


class History:
    """The expressions of the last frames, on the prior's own time grid."""

    def __init__(self, n_coefficients: int, frame_s: float, capacity: int = 64) -> None:
        self._frame_s = frame_s
        self._times_s = np.full(capacity, -np.inf)
        self._values = np.zeros((capacity, n_coefficients))
        self._count = 0

    def clear(self) -> None:
        """Forget everything."""
        self._count = 0

    def append(self, time_s: float, expression: FloatArray) -> None:
        """Remember a frame; the oldest one makes room."""
        if self._count == self._times_s.size:
            half = self._count // 2
            self._times_s[:half] = self._times_s[half:]
            self._values[:half] = self._values[half:]
            self._count = half
        self._times_s[self._count], self._values[self._count] = time_s, expression
        self._count += 1

    def first_lag(self, time_s: float) -> int:
        """Return the first of the lags 1..N_LAGS at which a frame is known; N_LAGS + 1 = none."""
        if self._count < 2:
            return N_LAGS + 1
        oldest, newest = self._times_s[0], self._times_s[self._count - 1]
        # A third of a frame of clock jitter is no missing frame.
        if time_s - oldest < (N_LAGS - 1 / 3) * self._frame_s:
            return N_LAGS + 1
        frames_since = round(float(time_s - newest) / self._frame_s)
        return min(max(frames_since, 1), N_LAGS + 1)

    def sample(self, time_s: float, first_lag: int) -> FloatArray:
        """Return the expressions (N_LAGS + 1 - first_lag, B) at the lags before `time_s`."""
        out = np.empty((N_LAGS + 1 - first_lag, self._values.shape[1]))
        if first_lag <= N_LAGS:
            newest = time_s - self._frame_s * first_lag
            sample_history(self._times_s, self._values, self._count, newest, self._frame_s, out)
        return out
