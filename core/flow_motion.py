"""How the points of a face moved from one frame to the next, by optical flow.

Pyramidal Lucas-Kanade flow there and back says where each point went and how sure that is. A
point that cannot be followed goes with the face and with its neighbours on the same feature.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from core.landmarks import GROUPS, N_INTERNAL, NAMES
from core.records import F32, U8, BoolArray, FloatArray

#: Points that flow follows: the internal landmarks and both pupils.
N_FOLLOWED = N_INTERNAL + 2
#: Side of the window around a point and number of halvings of the picture.
_WINDOW_PX = 15
_HALVINGS = 2
_CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 10, 0.02)
#: The face is made this wide before flow if it is wider in the picture.
_FACE_PX = 96.0
#: Room around the points in parts of the face's size.
_MARGIN = 0.35
_LEAST_SIDE_PX = 24
#: Way there and back, in parts of the face's size, at which a point is half trusted.
_RETURN_ERROR = 0.008
#: Distance from what the neighbours do, in parts of the face's size, at which it is half trusted.
_ODD_MOTION = 0.04
#: Neighbours count less at this distance, in parts of the face's size.
_REACH = 0.12
#: What the neighbours' own motion counts against standing still on the face.
_CALM = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Where the points went.

    Attributes:
        points_px: (P, 2) in the later frame.
        trust: (P,) in [0, 1], how far each is its own flow's word.
        error: Way there and back of the worse points, 1 where half of the trust is gone.
        affine: (2, 3) map from the earlier frame that moves the face as a whole.
    """

    points_px: FloatArray
    trust: FloatArray
    error: float
    affine: FloatArray


def follow_points(before: U8, after: U8, points_px: FloatArray) -> Motion | None:
    """Return where points of a face in one grey picture are in the next.

    Args:
        before: (H, W) grey picture.
        after: (H, W) the next one.
        points_px: (P, 2) in the earlier one, see N_FOLLOWED.

    Returns:
        None where too little of the face is in the picture.
    """
    window = _window(before.shape, points_px)
    if window is None:
        return None
    low, high, scale = window
    small = [_cut(picture, low, high, scale) for picture in (before, after)]
    start = ((points_px + 0.5 - low) * scale - 0.5).astype(np.float32)
    end, way_px = _there_and_back(small[0], small[1], start)
    size_px = face_size_px(points_px) * scale
    way = np.where(np.isfinite(way_px), way_px, np.inf) / size_px
    trust = 1 / (1 + (way / _RETURN_ERROR) ** 2)
    moved = np.where(trust[:, None] > 0, (end + 0.5) / scale + low - 0.5, points_px)
    return _agreed(points_px, np.asarray(moved, np.float64), trust)


def face_size_px(points_px: FloatArray) -> float:
    """Return the larger side of the box around the points, at least 1 px."""
    return max(float(np.ptp(points_px, axis=0).max()), 1.0)


def affine_between(before_px: FloatArray, after_px: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the affine map (2, 3) that takes points best to others, all (P, 2).

    Where the points do not tell (all in a line, hardly any weight) it is nearly a shift.
    """
    total = float(weights.sum())
    if total < 1e-6:
        return np.hstack([np.eye(2), np.zeros((2, 1))])
    share = (weights / total)[:, None]
    center, target = (share * before_px).sum(axis=0), (share * after_px).sum(axis=0)
    away, there = before_px - center, after_px - target
    square = away.T @ (share * away)
    square += 1e-3 * (np.trace(square) + 1e-6) * np.eye(2)
    linear = np.eye(2) + np.linalg.solve(square, away.T @ (share * (there - away))).T
    return np.column_stack([linear, target - linear @ center])


def _window(
    shape: tuple[int, ...], points_px: FloatArray
) -> tuple[FloatArray, FloatArray, float] | None:
    """Return corners (x, y) of the part of the picture around the points, and its scale."""
    if not np.isfinite(points_px).all():
        return None
    size_px = face_size_px(points_px)
    room = _MARGIN * size_px
    low = np.maximum(np.floor(points_px.min(axis=0) - room), 0)
    high = np.minimum(np.ceil(points_px.max(axis=0) + room), [shape[1], shape[0]])
    scale = min(_FACE_PX / size_px, 1.0)
    if ((high - low) * scale).min() < _LEAST_SIDE_PX:
        return None
    return low, high, scale


def _cut(picture: U8, low: FloatArray, high: FloatArray, scale: float) -> U8:
    (left, top), (right, bottom) = low.astype(int), high.astype(int)
    part = picture[top:bottom, left:right]
    if scale == 1.0:
        return np.ascontiguousarray(part)
    return np.asarray(cv2.resize(part, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA))


def _there_and_back(before: U8, after: U8, start: F32) -> tuple[F32, FloatArray]:
    """Return the points (P, 2) after, and how far from the start the way back ends."""
    end, seen = _flow(before, after, start)
    back, returned = _flow(after, before, end)
    way = np.linalg.norm((back - start).astype(np.float64), axis=1)
    return end, np.where(seen & returned, way, np.inf)


def _flow(before: U8, after: U8, start: F32) -> tuple[F32, BoolArray]:
    """Return the points (P, 2) after, and which of them were found (P,)."""
    end, found, _ = cv2.calcOpticalFlowPyrLK(
        before,
        after,
        start,
        np.zeros_like(start),
        winSize=(_WINDOW_PX, _WINDOW_PX),
        maxLevel=_HALVINGS,
        criteria=_CRITERIA,
    )
    return np.asarray(end, np.float32), np.asarray(found.ravel() == 1)


def _agreed(before_px: FloatArray, moved_px: FloatArray, trust: FloatArray) -> Motion:
    """Return the motion with what does not fit to the neighbours replaced by what they do."""
    size_px = face_size_px(before_px)
    error = float(np.percentile(1 / np.maximum(trust, 1e-3) - 1, 80))
    affine = affine_between(before_px, moved_px, trust)
    for _ in range(2):
        rest = moved_px - _mapped(affine, before_px)
        calm = trust / (1 + np.sum(rest**2, axis=1) / (0.02 * size_px) ** 2)
        affine = affine_between(before_px, moved_px, calm)
    carried = _mapped(affine, before_px)
    rest = moved_px - carried
    common = _common(before_px / size_px, rest, trust)
    odd = np.linalg.norm(rest - common, axis=1) / (_ODD_MOTION * size_px)
    trust = trust / (1 + odd**2)
    share = trust[:, None]
    points = carried + share * rest + (1 - share) * common
    return Motion(points, trust, error, affine)


def _common(places: FloatArray, rest_px: FloatArray, trust: FloatArray) -> FloatArray:
    """Return what the other points of the same feature do beyond the face's motion (P, 2)."""
    squares = np.sum((places[:, None] - places[None]) ** 2, axis=2)
    weights = np.exp(-0.5 * squares / _REACH**2) * _RELATED * trust
    return np.asarray(weights @ rest_px / (_CALM + weights.sum(axis=1, keepdims=True)))


def _mapped(affine: FloatArray, points_px: FloatArray) -> FloatArray:
    return np.asarray(points_px @ affine[:, :2].T + affine[:, 2])


def _related() -> BoolArray:
    """Return (P, P) which points move like each other: one feature, not lips or lids apart."""
    related = np.zeros((N_FOLLOWED, N_FOLLOWED), bool)
    for name, members in GROUPS.items():
        if name == "contour":
            continue
        for half in ("_up", "_lo", ""):
            same = [i for i in members if half in NAMES[i] or _is_corner(NAMES[i])]
            if half or not name.startswith(("eye", "lips")):
                related[np.ix_(same, same)] = True
    lips = [*GROUPS["lips_outer"], *GROUPS["lips_inner"]]
    for half in ("_up", "_lo"):
        same = [i for i in lips if half in NAMES[i]]
        related[np.ix_(same, same)] = True
    np.fill_diagonal(related, False)
    return related


def _is_corner(name: str) -> bool:
    return name.endswith(("corner", "eye_outer", "eye_inner"))


_RELATED = _related()
