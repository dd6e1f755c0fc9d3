"""Other light than in the setup pictures: told when it stays, so that some shots can be added.

A regressor has seen its person in the light of the setup. What it was not made for are skin that
is lit from another side, and much darker or brighter pictures; the same light under another
exposure is none of its business. Both show in the colour of the skin at the fifteen points of a
shape that lie between the features. Only heads that face the camera are compared: turned ones
have other shades in any light.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from core.camera import project
from core.geometry import matrix_from_quaternion
from core.kernels.skin import read_skin
from core.landmarks import N_INTERNAL, N_LANDMARKS
from core.records import U8, Camera, FaceState, FloatArray, Frame, SetupShapes, freeze

_SKIN = slice(N_INTERNAL, N_LANDMARKS)
#: Half the side of the squares of skin that are read, in parts of the shape's height.
_SQUARE = 1 / 50
#: Setup pictures that a comparison needs at least.
_FEWEST = 3

#: Across and down the face at the skin points, model frame in mm by rule of thumb, orthonormal.
_PLACES = np.array([
    [-22, -45], [22, -45], [-52, -12], [52, -12], [-14, 22], [14, 22], [-42, 22], [42, 22],
    [-45, 48], [45, 48], [-40, 75], [40, 75], [-20, 92], [20, 92], [0, 96],
], float)  # fmt: skip
_EVEN = np.linalg.qr(_PLACES - _PLACES.mean(axis=0))[0]

Kind = Literal["dark", "bright", "side", "look"]
REASONS: dict[Kind, str] = {
    "dark": "It is much darker than in the setup pictures.",
    "bright": "It is much brighter than in the setup pictures.",
    "side": "The light comes from another side than in the setup pictures.",
    "look": "The face looks unlike the setup pictures: glasses, a beard, spots of light.",
}


@dataclass(frozen=True, slots=True, eq=False)
class LightReference:
    """What the light of a setup did to a face that looks ahead.

    Attributes:
        shades: (N, 15) logarithms of the brightness of skin points in N setup pictures.
    """

    shades: FloatArray

    def __post_init__(self) -> None:
        freeze(self, shades=(np.float64, ("N", N_LANDMARKS - N_INTERNAL)))


@dataclass(frozen=True, slots=True)
class LightChange:
    """The light is another one, and stays so.

    Attributes:
        kind: What about it.
        reason: The same for people.
        amount: Of the change: a logarithm of brightness.
    """

    kind: Kind
    reason: str
    amount: float


@dataclass(frozen=True, slots=True)
class LightSettings:
    """What counts as other light.

    Attributes:
        facing_rad: Heads turned further are left out.
        dark: Change of the mean brightness, as a logarithm, that is much darker.
        bright: That is much brighter.
        side: Change of the shades from one side of the face to the other, or from above to below
            (RMS), from the nearest setup picture's.
        look: Change of what else makes the shades.
        every_s: Time between two comparisons.
        persist_s: Time for which that must be so.
        share: Part of the frames in that time in which it must be so.
        least: Frames in that time that must be fit to compare.
    """

    facing_rad: float = 0.35
    dark: float = 0.55
    bright: float = 0.45
    side: float = 0.055
    look: float = 0.075
    every_s: float = 0.2
    persist_s: float = 4.0
    share: float = 0.8
    least: int = 12


@dataclass(slots=True)
class _Frames:
    """What the last seconds said: times and changes (mean, side, look)."""

    times_s: deque[float] = field(default_factory=deque)
    changes: deque[tuple[float, float, float]] = field(default_factory=deque)


def light_reference(
    pictures: Sequence[U8 | None], shapes: SetupShapes, camera: Camera,
    settings: LightSettings | None = None,
) -> LightReference | None:  # fmt: skip
    """Return the light of a setup, None if too few pictures show a face that looks ahead.

    Args:
        pictures: N setup pictures (H, W, 3), None for those that are gone.
        shapes: Their shapes.
        camera: Of the pictures.
        settings: Which heads look ahead.
    """
    settings = settings or LightSettings()
    shades = []
    for n, rgb in enumerate(pictures):
        measured = bool(np.isfinite(shapes.rms_px[n]))
        ahead = _turned_rad(shapes.rotations_wxyz[n]) < settings.facing_rad
        if rgb is not None and measured and ahead:
            seen = project(camera, shapes.points_mm[n, :N_LANDMARKS])
            read = _shades(rgb, seen)
            shades += [] if read is None else [read]
    return LightReference(np.array(shades)) if len(shades) >= _FEWEST else None


class LightWatch:
    """Compares every frame with the light of the setup; speaks only when a change stays."""

    def __init__(self, reference: LightReference, settings: LightSettings | None = None) -> None:
        self._settings = settings or LightSettings()
        self._last: LightChange | None = None
        self._mean = reference.shades.mean(axis=1)
        self._sides = reference.shades - self._mean[:, None]
        self.reset()

    def reset(self) -> None:
        """Forget the last seconds."""
        self._frames, self._looked_s, self._last = _Frames(), -np.inf, None

    def step(self, frame: Frame, state: FaceState) -> LightChange | None:
        """Return what has changed and stays so for some seconds, None if nothing has."""
        settings = self._settings
        since_s = frame.time_s - self._looked_s
        if 0 <= since_s < settings.every_s:
            return self._last
        if not 0 <= since_s < settings.persist_s:
            self.reset()
        frames, self._looked_s = self._frames, frame.time_s
        change = self._change(frame, state)
        if change is not None:
            frames.times_s.append(frame.time_s)
            frames.changes.append(change)
        while frames.times_s and frame.time_s - frames.times_s[0] > settings.persist_s:
            frames.times_s.popleft()
            frames.changes.popleft()
        self._last = self._verdict()
        return self._last

    def _change(self, frame: Frame, state: FaceState) -> tuple[float, float, float] | None:
        """Return how mean, side and look differ from the setup's; None: no telling."""
        if state.lost or state.regions.min() < 0.6:
            return None
        if _turned_rad(state.rotation_wxyz) > self._settings.facing_rad:
            return None
        shades = _shades(frame.rgb, state.landmarks_px)
        if shades is None:
            return None
        mean = float(shades.mean())
        away = self._sides - (shades - mean)
        nearest = away[np.argmin(np.sum(away**2, axis=1))]
        # Light from a side makes shades that rise evenly over the face.
        even = _EVEN @ (nearest @ _EVEN)
        beyond = mean - float(np.clip(mean, self._mean.min(), self._mean.max()))
        return beyond, _rms(even), _rms(nearest - even)

    def _verdict(self) -> LightChange | None:
        """Return what most of the last seconds agree on."""
        settings, frames = self._settings, self._frames
        long_s = frames.times_s[-1] - frames.times_s[0] if frames.times_s else 0.0
        if len(frames.times_s) < settings.least or long_s < 0.75 * settings.persist_s:
            return None
        mean, side, look = np.array(frames.changes).T
        signs: dict[Kind, tuple[FloatArray, float]] = {
            "side": (side, settings.side),
            "dark": (-mean, settings.dark),
            "bright": (mean, settings.bright),
            "look": (look, settings.look),
        }
        for kind, (values, limit) in signs.items():
            if np.mean(values > limit) >= settings.share:
                return LightChange(kind, REASONS[kind], float(np.median(values)))
        return None


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _shades(rgb: U8, landmarks_px: FloatArray) -> FloatArray | None:
    """Return the logarithms of the skin's brightness (15,), None with a point outside."""
    points = np.ascontiguousarray(landmarks_px[_SKIN])
    half = max(round(_SQUARE * float(np.ptp(landmarks_px[:N_INTERNAL, 1]))), 1)
    colors, inside = np.empty((len(points), 3)), np.empty(len(points))
    read_skin(rgb, points, half, colors, inside)
    return colors[:, 0] if inside.all() else None


def _turned_rad(rotation_wxyz: FloatArray) -> float:
    """Return the angle between the head's direction and straight ahead."""
    forward = matrix_from_quaternion(rotation_wxyz)[:, 2]
    return float(np.arccos(np.clip(forward[2], -1.0, 1.0)))
