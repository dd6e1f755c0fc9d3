"""Bends heads into other proportions: smooth maps of space that carry faces and expressions.

A map moves every point of space, so whatever touches before touches afterwards: closed lips, lids
and the eyeballs behind them. An expression is carried by mapping the face that makes it. Around
each eye the map keeps spheres: it is a change of size, and a stretch in latitude.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.sparse import coo_matrix

from core.arkit import EXPRESSION_NAMES
from core.records import F32, I32, FloatArray

_JAW_OPEN, _MOUTH_CLOSE = EXPRESSION_NAMES.index("jawOpen"), EXPRESSION_NAMES.index("mouthClose")
Triple = tuple[float, float, float]


class Step(Protocol):
    """A smooth map of the model frame."""

    def __call__(self, points_mm: FloatArray) -> FloatArray:
        """Return where points (n, 3) go."""
        ...


@dataclass(frozen=True, slots=True)
class Push:
    """Moves what is near a place, and its mirror image alike.

    Attributes:
        center: Place on the head; off the middle, the other side is pushed, too.
        radii: Reach along x, y and z.
        shift: How far the place itself goes.
    """

    center: Triple
    radii: Triple
    shift: Triple

    def __call__(self, points_mm: FloatArray) -> FloatArray:
        """Return where points (n, 3) go."""
        out = points_mm + self.on_left(points_mm)
        return np.asarray(out + self.on_right(points_mm) if self.center[0] else out)

    def on_left(self, points_mm: FloatArray) -> FloatArray:
        """Return the movement (n, 3) that the place itself causes."""
        return np.asarray(_near(points_mm, self.center, self.radii) * np.array(self.shift))

    def on_right(self, points_mm: FloatArray) -> FloatArray:
        """Return the movement (n, 3) that its mirror image causes."""
        center, shift = _mirrored(self.center), np.array(_mirrored(self.shift))
        return np.asarray(_near(points_mm, center, self.radii) * shift)


@dataclass(frozen=True, slots=True)
class Swell:
    """Stretches what is near a place, or shrinks it.

    Attributes:
        center: Place on the head, which stays; off the middle, the other side swells, too.
        radii: Reach along x, y and z.
        factors: Size along x, y and z at the place itself.
    """

    center: Triple
    radii: Triple
    factors: Triple

    def __call__(self, points_mm: FloatArray) -> FloatArray:
        """Return where points (n, 3) go."""
        grow = np.array(self.factors) - 1
        out = points_mm + _near(points_mm, self.center, self.radii) * grow * (
            points_mm - self.center
        )
        if self.center[0]:
            center = _mirrored(self.center)
            out += _near(points_mm, center, self.radii) * grow * (points_mm - center)
        return np.asarray(out)


@dataclass(frozen=True, slots=True)
class Lay:
    """Lays to the head what stands away from it sidewards, as ears do.

    Attributes:
        beyond_mm: Distance |x| from the middle where it begins.
        share: What is left of the distance beyond.
        center: Middle (y, z) of the region.
        radii: Its reach along y and z.
    """

    beyond_mm: float
    share: float
    center: tuple[float, float]
    radii: tuple[float, float]

    def __call__(self, points_mm: FloatArray) -> FloatArray:
        """Return where points (n, 3) go."""
        offset = (points_mm[:, 1:] - self.center) / self.radii
        weight = np.exp(-(np.sum(offset**2, axis=1) ** 2))
        x = points_mm[:, 0]
        over = np.maximum(np.abs(x) - self.beyond_mm, 0)
        out = points_mm.copy()
        out[:, 0] = x - np.sign(x) * weight * (1 - self.share) * over
        return out


@dataclass(frozen=True, slots=True)
class EyeStyle:
    """What becomes of the eyes.

    Attributes:
        size: Of ball and lids.
        shift: Of the left eye's centre; the right one goes the mirrored way.
        tall: Stretch of the opening in latitude, below 0.45.
        slant_rad: Turn of the opening, the outer corner up.
        inner: Up to so many radii from the centre the map keeps spheres.
        outer: From so many on the eye is not felt.
    """

    size: float = 1.0
    shift: Triple = (0.0, 0.0, 0.0)
    tall: float = 0.0
    slant_rad: float = 0.0
    inner: float = 1.35
    outer: float = 2.7


@dataclass(frozen=True, slots=True, eq=False)
class Warp:
    """A whole change of proportions.

    Attributes:
        steps: One after the other, for all but the eyes.
        eyes: For the surroundings of the eyes.
        centers_mm: (2, 3) eyeball centres of the head that is bent, right then left.
        radius_mm: Of its eyeballs.
    """

    steps: Sequence[Step]
    eyes: EyeStyle
    centers_mm: FloatArray
    radius_mm: float

    def __call__(self, points_mm: FloatArray) -> FloatArray:
        """Return where points (n, 3) go."""
        bent = np.asarray(points_mm, float)
        for step in self.steps:
            bent = step(bent)
        out = bent.copy()
        shares = [self._share(points_mm - center) for center in self.centers_mm]
        for eye, (center, side) in enumerate(zip(self.centers_mm, (-1.0, 1.0), strict=True)):
            moved = self._eye(points_mm - center, side) + center
            out += _won(shares[eye], shares[1 - eye])[:, None] * (moved - bent)
        return out

    def head(self, neutral_mm: FloatArray, deltas_mm: F32) -> tuple[FloatArray, F32]:
        """Return the neutral face (V, 3) and the blendshapes (B, V, 3) of the bent head."""
        neutral = self(neutral_mm)
        out = np.zeros_like(deltas_mm)
        for shape, delta in enumerate(deltas_mm):
            # Closing the mouth is a change of a face whose jaw is open.
            before = deltas_mm[_JAW_OPEN] if shape == _MOUTH_CLOSE else np.zeros_like(delta)
            moving = np.abs(delta).max(axis=1) > 0.005
            first = neutral_mm[moving] + before[moving]
            start = neutral[moving] if shape != _MOUTH_CLOSE else self(first)
            out[shape, moving] = self(first + delta[moving]) - start
        return neutral, out

    def _share(self, offset_mm: FloatArray) -> FloatArray:
        """Return how much points (n, 3), from an eye's centre, belong to it."""
        radii = np.linalg.norm(offset_mm, axis=1) / self.radius_mm
        share = np.clip((self.eyes.outer - radii) / (self.eyes.outer - self.eyes.inner), 0, 1)
        return np.asarray(share * share * (3 - 2 * share))

    def _eye(self, offset_mm: FloatArray, side: float) -> FloatArray:
        """Return where points (n, 3) of one eye go, all from its old centre."""
        x, y, z = offset_mm.T
        flat = np.hypot(x, z)
        radius, latitude = np.hypot(flat, y), np.arctan2(y, flat)
        latitude = latitude + self.eyes.tall * np.sin(2 * latitude)
        shrink = radius * np.cos(latitude) / np.maximum(flat, 1e-9)
        out = np.stack([x * shrink, radius * np.sin(latitude), z * shrink], axis=1)
        cosine, sine = np.cos(self.eyes.slant_rad), side * np.sin(self.eyes.slant_rad)
        out[:, 0], out[:, 1] = (
            cosine * out[:, 0] + sine * out[:, 1],
            (cosine * out[:, 1] - sine * out[:, 0]),
        )
        return self.eyes.size * out + np.array([side, 1.0, 1.0]) * self.eyes.shift


def _won(share: FloatArray, other: FloatArray) -> FloatArray:
    """Return what an eye gets of points (n,) that both claim: all where its own share is 1."""
    left = np.maximum((1 - share) + (1 - other), 1e-9)
    return np.asarray(share * (1 - other) + share * other * (1 - other) / left)


def _near(points_mm: FloatArray, center: Triple, radii: Triple) -> FloatArray:
    """Return (n, 1) 1 at the centre, falling with the distance over the radii."""
    offset = (points_mm - center) / np.array(radii)
    return np.asarray(np.exp(-np.sum(offset**2, axis=1)))[:, None]


def _mirrored(triple: Triple) -> Triple:
    return -triple[0], triple[1], triple[2]


def evened(points_mm: FloatArray, triangles: I32, free: FloatArray, rounds: int) -> FloatArray:
    """Return a surface (V, 3) whose vertices went towards the mean of their neighbours.

    Args:
        points_mm: (V, 3).
        triangles: (T, 3) of the surface.
        free: (V,) how much a vertex may move, in [0, 1].
        rounds: How often.
    """
    pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    pairs = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
    n = len(points_mm)
    links = coo_matrix((np.ones(len(pairs)), pairs.T), (n, n)).tocsr()
    degree = np.maximum(np.bincount(pairs[:, 0], minlength=n), 1)[:, None]
    joined = np.bincount(pairs[:, 0], minlength=n)[:, None] > 0
    out = np.asarray(points_mm, float)
    for _ in range(rounds):
        step = np.where(joined, links @ out / degree - out, 0.0)
        out = out + 0.5 * free[:, None] * step
    return out
