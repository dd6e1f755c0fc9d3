"""What lies before a face, told from the colour of its skin while it is followed.

The landmark network sees through a hand: it guesses what is covered, and its presence stays at 1.
But the skin there no longer looks as the same head looked in the seconds before. A linear model of
the colour at every point of the network's mesh, as it depends on pose and on the opening of lids
and mouth, is learned on the way by recursive least squares; what deviates from it by much more
than usual is covered. Looks are learned from half a second later, if nothing odd has followed: a
hand that comes slowly must not become what is usual. `core.face_cover` judges whole videos.

Other light is no cover: what a change of all light explains, brightness that depends on the
skin's normal to first order [Ramamoorthi and Hanrahan 2001], is taken off first.
"""

from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from core.kernels.skin import change_of_light, read_skin
from core.landmarks import GROUPS, MESH478, N_INTERNAL, N_LANDMARKS
from core.mean_face import N_SURFACE, MeanFace, smooth_normals
from core.records import U8, FloatArray

#: Ends of both eyes' openings and widths, of the mouth's opening, in the network.
_EYES = ((159, 145, 33, 133), (386, 374, 362, 263))
_MOUTH = (13, 14, 33, 263)
#: Numbers on which colour may depend: 1, three of the rotation, a square, two openings.
_N_CAUSES = 7
#: Points that a turned head shows less of than this are not judged.
_FACING = 0.2
#: Mean cover of the internal landmarks from which on a face is hidden.
_HIDDEN = 0.7
#: Landmarks that move much, and how far from them skin is skin.
_MOBILE = (
    (GROUPS["lips_outer"] + GROUPS["lips_inner"], 7.0),
    (GROUPS["eye_right"] + GROUPS["eye_left"], 4.0),
)
#: Rounds in which light is told from cover.
_ROUNDS = 4


@dataclass(frozen=True, slots=True)
class CoverSettings:
    """When skin counts as covered.

    Attributes:
        square: Half the side of the squares that are read, in parts of the face's width.
        spread: Usual deviation of brightness before anything is known; half of it of colour.
        spread_looks: Looks that this counts as.
        slopes: Usual influence of a cause of size 1.
        memory: Looks over which deviations are averaged.
        light: Usual part of a change of light that depends on the skin's normal.
        reach_mm: Points so far from a landmark have a say on it.
        covered: Deviations, in usual ones, at which a landmark may be and is covered.
        odd: Deviation of a landmark from which on nothing is learned.
        fast: Movement, in face widths per second, that doubles deviations, and what it may do
            at most: what is before a face moves the network's points, too.
        probation_s: Time after which a look is learned from.
        patience_s: Time after which what covers is part of the face: glasses, a beard.
        least: Looks before anything is judged.
        least_s: Time before that.
        known: Looks after which a face can be told to be hidden or another's.
    """

    square: float = 1 / 90
    spread: float = 0.06
    spread_looks: float = 16.0
    slopes: float = 0.12
    memory: float = 300.0
    light: float = 0.3
    reach_mm: float = 12.0
    covered: tuple[float, float] = (1.75, 2.5)
    odd: float = 1.7
    fast: tuple[float, float] = (3.0, 1.4)
    probation_s: float = 0.5
    patience_s: float = 12.0
    least: int = 8
    least_s: float = 1.1
    known: int = 24


class Judged(NamedTuple):
    """A look at a face.

    Attributes:
        time_s: Of the picture.
        cover: (75,) how far each landmark is covered, in [0, 1].
        odd: (75,) deviation about each landmark, in usual ones; 0 as long as nothing is known.
        causes: (7,) on which the colours depend.
        colors: (468, 3) as they were in the light that is known.
        seen: (468,) 1 where a point faces the camera in the picture, else 0.
        points_px: (468, 2).
        known: Whether the face is known well.
    """

    time_s: float
    cover: FloatArray
    odd: FloatArray
    causes: FloatArray
    colors: FloatArray
    seen: FloatArray
    points_px: FloatArray
    known: bool

    @property
    def hidden(self) -> bool:
        """Whether hardly anything of the face that is known is to be seen: it may be another's."""
        return self.known and bool(self.cover[:N_INTERNAL].mean() > _HIDDEN)


class CoverWatch:
    """Gets to know a face, and tells which landmarks something else is before."""

    def __init__(self, mean: MeanFace, settings: CoverSettings | None = None) -> None:
        self._settings = settings or CoverSettings()
        self._normals = smooth_normals(mean)
        places, marks = mean.vertices_mm, mean.vertices_mm[MESH478]
        squared = np.sum((places[None] - marks[:, None]) ** 2, axis=2)
        self._near = np.exp(-squared / (2 * self._settings.reach_mm**2))
        # Teeth, tongue and lids look as they like: what is around them tells of a cover.
        for mobile, clear_mm in _MOBILE:
            self._near[:, squared[list(mobile)].min(axis=0) < clear_mm**2] = 0.0
        self._basis = np.column_stack([np.ones(N_SURFACE), self._normals])
        least = 20 * self._settings.spread**2
        self._ridge = least * np.array([1e-3, *[self._settings.light**-2] * 3])
        self._colors, self._inside = np.empty((N_SURFACE, 3)), np.empty(N_SURFACE)
        self.reset()

    def reset(self) -> None:
        """Know no face."""
        settings = self._settings
        self._looks, self._odd_s, self._first_s = 0, np.nan, np.inf
        self._model = np.zeros((_N_CAUSES, N_SURFACE, 3))
        self._spread = np.tile(np.array([1.0, 0.5, 0.5]) * settings.spread, (N_SURFACE, 1)) ** 2
        self._counts = np.full(N_SURFACE, settings.spread_looks)
        unknown = (settings.slopes / settings.spread) ** 2
        self._doubt = np.diag([100.0, *[unknown] * (_N_CAUSES - 1)])
        self._waiting: deque[Judged] = deque()
        self._last: tuple[float, FloatArray] | None = None

    def judge(self, rgb: U8, mesh_px: FloatArray, rotation: FloatArray, time_s: float) -> Judged:
        """Return how far a face is covered; nothing is learned.

        Args:
            rgb: (H, W, 3).
            mesh_px: (478, 2) what the network sees.
            rotation: (3, 3) model to camera.
            time_s: Of the picture.
        """
        points = np.ascontiguousarray(mesh_px[:N_SURFACE])
        size_px = max(float(np.ptp(points[:, 0])), float(np.ptp(points[:, 1])), 1.0)
        half = max(round(self._settings.square * size_px), 1)
        read_skin(rgb, points, half, self._colors, self._inside)
        facing = -(self._normals @ rotation[2]) > _FACING
        seen, causes, odd = facing * self._inside, _causes(mesh_px, rotation), np.zeros(N_LANDMARKS)
        colors = self._in_known_light(causes, seen)
        if self.knows:
            odd = self._at_landmarks(self._deviations(causes, colors), seen)
            fast, most = self._settings.fast
            odd /= min(1 + self._speed(points, size_px, time_s) / fast, most)
        low, high = self._settings.covered
        share = np.clip((odd - low) / (high - low), 0.0, 1.0)
        cover, known = share * share * (3 - 2 * share), self._looks >= self._settings.known
        return Judged(time_s, cover, odd, causes, colors, seen, points, known)

    @property
    def knows(self) -> bool:
        """Whether enough was seen to judge."""
        settings = self._settings
        known_s = -np.inf if self._last is None else self._last[0] - self._first_s
        return self._looks >= settings.least and known_s >= settings.least_s

    def accept(self, seen: Judged) -> None:
        """Take what was judged for the face; learn from what was seen a moment ago.

        As long as something is odd nothing is learned; if that does not end, it is what is usual.
        """
        self._last = seen.time_s, seen.points_px
        if seen.odd.max() > self._settings.odd:
            self._waiting.clear()
            self._odd_s = seen.time_s if np.isnan(self._odd_s) else self._odd_s
            if not 0 <= seen.time_s - self._odd_s < self._settings.patience_s:
                self.reset()
            return
        self._odd_s = np.nan
        self._waiting.append(seen)
        ready_s = seen.time_s - (self._settings.probation_s if self.knows else 0.0)
        while self._waiting and self._waiting[0].time_s <= ready_s:
            self._learn(self._waiting.popleft())

    def _deviations(self, causes: FloatArray, colors: FloatArray) -> FloatArray:
        """Return how far each point (468,) is from what is foretold, in usual deviations."""
        unsure = 1.0 + causes @ self._doubt @ causes
        away = colors - self._foretold(causes)
        return np.asarray(np.sqrt(np.mean(away**2 / (self._spread * unsure), axis=1)))

    def _foretold(self, causes: FloatArray) -> FloatArray:
        """Return the colours (468, 3) that go with causes."""
        return np.asarray(causes @ self._model.reshape(_N_CAUSES, -1)).reshape(-1, 3)

    def _in_known_light(self, causes: FloatArray, seen: FloatArray) -> FloatArray:
        """Return the colours (468, 3) as they were in the light that is known."""
        if self._looks == 0:
            return self._colors.copy()
        away = self._colors - self._foretold(causes)
        return self._colors - self._change_of_light(away, seen)

    def _change_of_light(self, away: FloatArray, seen: FloatArray) -> FloatArray:
        """Return the part (468, 3) of deviations that other light on the whole face explains."""
        visible = away[seen > 0]
        light = np.empty_like(away)
        light[:] = np.median(visible, axis=0) if len(visible) else 0.0
        change_of_light(away, seen, self._spread, self._basis, self._ridge, _ROUNDS, light)
        return light

    def _at_landmarks(self, away: FloatArray, seen: FloatArray) -> FloatArray:
        """Return the mean deviation about each landmark (75,)."""
        weights = self._near * seen
        total = weights.sum(axis=1)
        return np.asarray(weights @ np.minimum(away, 5.0) / np.maximum(total, 1.0))

    def _speed(self, points: FloatArray, size_px: float, time_s: float) -> float:
        """Return how fast the face moves in the picture, in its own widths per second."""
        if self._last is None or not 0 < time_s - self._last[0] < 0.5:
            return 0.0
        way = float(np.abs(points - self._last[1]).mean())
        return way / size_px / (time_s - self._last[0])

    def _learn(self, seen: Judged) -> None:
        """Take a look for what is usual: one step of recursive least squares."""
        x, settings = seen.causes, self._settings
        if self._looks == 0:
            self._model[0], self._first_s = seen.colors, seen.time_s
        unsure = 1.0 + float(x @ self._doubt @ x)
        away = seen.colors - self._foretold(x)
        gain = self._doubt @ x / unsure
        kept = away * seen.seen[:, None]
        self._model += gain[:, None, None] * kept
        self._doubt -= np.outer(gain, x @ self._doubt)
        self._doubt += 1e-5 * np.eye(_N_CAUSES)
        self._counts = np.minimum(self._counts + seen.seen, settings.memory)
        share = (seen.seen / self._counts)[:, None]
        self._spread += share * (away**2 / unsure - self._spread)
        self._looks += 1


def _causes(mesh_px: FloatArray, rotation: FloatArray) -> FloatArray:
    """Return the numbers (7,) on which the colour of skin may depend."""
    lids = float(np.mean([_opening(mesh_px, *ends) for ends in _EYES]))
    yaw, pitch, roll = rotation[0, 2], rotation[1, 2], rotation[0, 1]
    return np.array([1.0, yaw, pitch, roll, yaw * yaw, lids, _opening(mesh_px, *_MOUTH)])


def _opening(mesh_px: FloatArray, up: int, low: int, one: int, other: int) -> float:
    """Return the distance of two points in parts of the distance of two others."""
    gaps = mesh_px[[up, one]] - mesh_px[[low, other]]
    height, width = np.linalg.norm(gaps, axis=1)
    return float(min(height / (width + 1e-9), 1.0))
