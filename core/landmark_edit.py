"""What a hand can do to the landmarks of a picture: every change is a new record.

Points are the 75 landmarks, then the pupils (right, left): 77 in all. A point that the user placed
is `edited` with confidence 1; one that the user calls hidden is `edited` with confidence 0.
"""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from core.landmarks import CURVES, MIRROR, N_LANDMARKS
from core.records import BoolArray, FloatArray, Landmarks2D

N_POINTS = N_LANDMARKS + 2
PUPIL_NAMES = ("R_pupil", "L_pupil")
#: How far along a curve its points follow a dragged one, as a share of the curve's length: on an
#: open curve, on a closed one.
REACH_OPEN, REACH_CLOSED = 0.4, 0.25


def points_of(landmarks: Landmarks2D) -> FloatArray:
    """Return landmarks and pupils, (77, 2) px."""
    return np.concatenate([landmarks.points_px, landmarks.pupils_px])


def hidden(landmarks: Landmarks2D) -> BoolArray:
    """Return which landmarks (75,) the user has called hidden."""
    return np.asarray(landmarks.edited & (landmarks.confidence == 0))


def shifted(landmarks: Landmarks2D, shifts_px: FloatArray) -> Landmarks2D:
    """Return the landmarks with points moved by hand; those that do not move stay as they are.

    Args:
        landmarks: To change.
        shifts_px: (77, 2).
    """
    moved = np.any(shifts_px != 0, axis=1)
    n = N_LANDMARKS
    return Landmarks2D(
        landmarks.points_px + shifts_px[:n],
        landmarks.edited | moved[:n],
        np.where(moved[:n], 1.0, landmarks.confidence),
        landmarks.pupils_px + shifts_px[n:],
        np.where(moved[n:], 1.0, landmarks.pupil_confidence),
    )


def drag_weights(points_px: FloatArray, grabbed: Collection[int], soft: bool) -> FloatArray:
    """Return how much of a drag each point (77,) follows: 1 for those grabbed.

    A soft drag takes the neighbours along brow, lid, lip or jaw with it, less the further along
    the curve they are.

    Args:
        points_px: (77, 2).
        grabbed: Points in the hand.
        soft: Whether neighbours follow.
    """
    weights = np.zeros(N_POINTS)
    if soft:
        for index in grabbed:
            weights = np.maximum(weights, _followers(points_px, index))
    weights[list(grabbed)] = 1.0
    return weights


def _followers(points_px: FloatArray, index: int) -> FloatArray:
    weights = np.zeros(N_POINTS)
    for curve in CURVES:
        if index not in curve:
            continue
        along = np.linalg.norm(np.diff(points_px[list(curve)], axis=0), axis=1)
        places = np.concatenate([[0.0], np.cumsum(along)])
        length = max(float(places[-1]), 1e-9)
        distance = np.abs(places - places[curve.index(index)])
        reach = REACH_OPEN
        if curve[0] == curve[-1]:
            reach, distance = REACH_CLOSED, np.minimum(distance, length - distance)
        near = np.clip(distance / (reach * length), 0.0, 1.0)
        np.maximum.at(weights, list(curve), 0.5 * (1 + np.cos(np.pi * near)))
    return weights


def as_hidden(landmarks: Landmarks2D, chosen: Collection[int]) -> Landmarks2D:
    """Return the landmarks with some called hidden, or seen again if all of them were hidden.

    Args:
        landmarks: To change.
        chosen: Points; pupils are hidden by their confidence alone.
    """
    chosen = sorted(chosen)
    marks = [index for index in chosen if index < N_LANDMARKS]
    pupils = [index - N_LANDMARKS for index in chosen if index >= N_LANDMARKS]
    seen_again = bool(
        np.all(hidden(landmarks)[marks]) and np.all(landmarks.pupil_confidence[pupils] == 0)
    )
    edited, confidence = landmarks.edited.copy(), landmarks.confidence.copy()
    pupil_confidence = landmarks.pupil_confidence.copy()
    edited[marks] = True
    confidence[marks] = pupil_confidence[pupils] = float(seen_again)
    return replace(
        landmarks, edited=edited, confidence=confidence, pupil_confidence=pupil_confidence
    )


def taken_from(
    landmarks: Landmarks2D, other: Landmarks2D, chosen: Collection[int] | None = None
) -> Landmarks2D:
    """Return the landmarks with some points, or all, as they are in another record.

    Args:
        landmarks: To change.
        other: Of the same picture, or of one that looks like it.
        chosen: Points to take; None takes all.
    """
    chosen = range(N_POINTS) if chosen is None else chosen
    take = np.zeros(N_POINTS, bool)
    take[list(chosen)] = True
    marks, pupils = take[:N_LANDMARKS], take[N_LANDMARKS:]
    return Landmarks2D(
        np.where(marks[:, None], other.points_px, landmarks.points_px),
        np.where(marks, other.edited, landmarks.edited),
        np.where(marks, other.confidence, landmarks.confidence),
        np.where(pupils[:, None], other.pupils_px, landmarks.pupils_px),
        np.where(pupils, other.pupil_confidence, landmarks.pupil_confidence),
    )


def placed_like(landmarks: Landmarks2D, other: Landmarks2D, size_px: float) -> Landmarks2D:
    """Return another picture's landmarks laid over this one's face.

    Middle and size of this picture's face are kept, so that only the shape is copied. What is
    copied counts as placed by the user.

    Args:
        landmarks: Of this picture.
        other: Of the picture to copy from.
        size_px: Width of the picture; a face of which nothing is known is copied where it is.
    """
    source, target = points_of(other), points_of(landmarks)
    known = np.all(np.isfinite(target), axis=1)[:N_LANDMARKS] & (landmarks.confidence > 0)
    placed = source
    if known.sum() >= 3 and np.ptp(target[:N_LANDMARKS][known], axis=0).max() < size_px:
        before, after = source[:N_LANDMARKS][known], target[:N_LANDMARKS][known]
        spread = np.sqrt(
            np.mean(np.var(after, axis=0)) / max(np.mean(np.var(before, axis=0)), 1e-9)
        )
        placed = after.mean(axis=0) + spread * (source - before.mean(axis=0))
    n = N_LANDMARKS
    return Landmarks2D(
        placed[:n], np.ones(n, bool), np.where(other.confidence > 0, 1.0, 0.0),
        placed[n:], other.pupil_confidence,
    )  # fmt: skip


def mirrored(landmarks: Landmarks2D, width_px: int) -> Landmarks2D:
    """Return the landmarks as a mirror shows them: those of the head turned the other way.

    Args:
        landmarks: Of a picture.
        width_px: Its width.
    """

    def flip(points: FloatArray) -> FloatArray:
        return np.column_stack([width_px - 1 - points[:, 0], points[:, 1]])

    return Landmarks2D(
        flip(landmarks.points_px)[MIRROR],
        landmarks.edited[MIRROR],
        landmarks.confidence[MIRROR],
        flip(landmarks.pupils_px)[::-1],
        landmarks.pupil_confidence[::-1],
    )
