"""The hands-free shutter: shoots by itself when all is right and the face is still."""

from dataclasses import dataclass

import numpy as np

from core.records import FloatArray

#: Longest time between two frames of a slow camera.
_FRAME_S = 0.1


@dataclass(frozen=True, slots=True)
class ShutterSettings:
    """When it shoots.

    Attributes:
        hold_s: So long the face must be right and still.
        burst_s: And so long it is looked at for the best picture, from then on.
        still: Movement per second, in parts of the face's size, that counts as still.
        still_over_s: Time over which movement is measured: landmarks tremble from frame to frame.
        grace_s: A shorter lapse while holding is forgiven.
        pause_s: After a picture nothing is shot for so long.
    """

    hold_s: float = 0.6
    burst_s: float = 0.25
    still: float = 0.15
    still_over_s: float = 0.2
    grace_s: float = 0.12
    pause_s: float = 0.5


@dataclass(frozen=True, slots=True)
class ShutterState:
    """What the shutter is doing.

    Attributes:
        phase: "waiting", "holding", "shooting" or "done".
        held: How much of the hold has passed, in [0, 1].
        best: True while this frame is the best one of the burst: keep it.
    """

    phase: str
    held: float
    best: bool


class Shutter:
    """Watches frames; remembers since when all is right."""

    def __init__(self, settings: ShutterSettings | None = None) -> None:
        self._settings = settings or ShutterSettings()
        self._past: list[tuple[float, FloatArray]] = []
        self._idle_until_s = -np.inf
        self._start_over()

    def reset(self, time_s: float) -> None:
        """Begin with another prompt; nothing is shot at once."""
        self._idle_until_s = time_s + self._settings.pause_s
        self._start_over()

    def _start_over(self) -> None:
        self._since_s, self._good_s = np.nan, -np.inf
        self._best = -np.inf

    def step(
        self, good: bool, points_px: FloatArray | None, sharpness: float, time_s: float
    ) -> ShutterState:
        """Look at a frame.

        Args:
            good: Whether pose, expression and picture are right.
            points_px: (P, 2) points of the face, or of the picture where the face is not seen;
                None counts as moving.
            sharpness: Of the frame; the sharpest of the burst is the best.
            time_s: Its time.
        """
        settings = self._settings
        right = good and self._is_still(points_px, time_s) and time_s >= self._idle_until_s
        if right:
            self._good_s = time_s
            self._since_s = time_s if np.isnan(self._since_s) else self._since_s
        elif time_s - self._good_s > settings.grace_s:
            self._start_over()
        if np.isnan(self._since_s):
            return ShutterState("waiting", 0.0, False)
        held_s = time_s - self._since_s
        if held_s < settings.hold_s:
            return ShutterState("holding", held_s / settings.hold_s, False)
        best = right and sharpness > self._best
        self._best = max(self._best, sharpness) if right else self._best
        if held_s < settings.hold_s + settings.burst_s or not np.isfinite(self._best):
            return ShutterState("shooting", 1.0, best)
        self._start_over()
        self._idle_until_s = time_s + settings.pause_s
        return ShutterState("done", 1.0, best)

    def _is_still(self, points_px: FloatArray | None, time_s: float) -> bool:
        """Return whether the points are about where they were a moment ago."""
        same = points_px is not None and all(one.shape == points_px.shape for _, one in self._past)
        if points_px is None or not same:
            self._past = [] if points_px is None else [(time_s, points_px)]
            return False
        since_s = time_s - self._settings.still_over_s
        self._past = [one for one in self._past if one[0] >= since_s - _FRAME_S]
        self._past.append((time_s, points_px))
        then_s, before = self._past[0]
        if then_s > since_s + _FRAME_S:
            return False
        size = max(float(np.ptp(points_px, axis=0).max()), 1.0)
        moved = float(np.sqrt(np.mean(np.sum((points_px - before) ** 2, axis=1))))
        return moved / size / (time_s - then_s) < self._settings.still
