"""How the points of a face moved from one frame to the next, by optical flow.

Pyramidal Lucas-Kanade flow there and back says where each point went and how sure that is. A
point that cannot be followed goes with the face and with its neighbours on the same feature.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from core.kernels.flow import agree, fit_camera
from core.landmarks import GROUPS, N_INTERNAL, NAMES
from core.records import F32, U8, BoolArray, FloatArray

#: Points that flow follows: the internal landmarks and both pupils.
N_FOLLOWED = N_INTERNAL + 2
#: Side of the window around a point and number of halvings of the picture.
_WINDOW_PX = 13
_HALVINGS = 2
_CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 7, 0.03)
#: The face is made about this wide before flow if it is wider in the picture.
_FACE_PX = 96.0
#: Room around the points in parts of the face's size.
_MARGIN = 0.35
_LEAST_SIDE_PX = 24
#: Way there and back, in parts of the face's size, at which a point is half trusted.
_RETURN_ERROR = 0.002
#: Distance from what the neighbours do, in parts of the face's size, at which it is half trusted.
_ODD_MOTION = 0.015
#: Neighbours count less at this distance, in parts of the face's size.
_REACH = 0.15
#: What the neighbours' own motion counts against standing still on the face.
_CALM = 0.3

#: Fast motion leaves half of the points a trust of 0.2 or more, and the face's shape within 0.15
#: of what it was the frame before; beyond these nothing was followed.
_LEAST_TRUST = 0.1
_MOST_STRETCH = 0.3
#: Change of brightness that is none, and the places at which it is measured.
_SAME_LIGHT = 0.05
_LIGHT_CELLS = (12, 12)


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Where the points went.

    Attributes:
        points_px: (P, 2) in the later frame.
        trust: (P,) in [0, 1], how far each is its own flow's word.
        camera: (2, 4) takes picture and depth before to the place to which the face as a whole
            carries it: the affine camera, exact for a turning head under weak perspective.
    """

    points_px: FloatArray
    trust: FloatArray
    camera: FloatArray


def follow_points(
    before: U8, after: U8, points_px: FloatArray, depth_px: FloatArray
) -> Motion | None:
    """Return where points of a face in one grey picture are in the next.

    Args:
        before: (H, W) grey picture.
        after: (H, W) the next one.
        points_px: (P, 2) in the earlier one, see N_FOLLOWED.
        depth_px: (P,) away from the camera.

    Returns:
        None where too little of the face is in the picture, or flow has lost it: in a cut, say.
    """
    window = _window(before.shape, points_px)
    if window is None:
        return None
    low, high, shrink = window
    size_px = face_size_px(points_px)
    start = ((points_px + 0.5 - low) / shrink - 0.5).astype(np.float32)
    small = _cut(before, low, high, shrink)
    end, way = _there_and_back(small, _like(_cut(after, low, high, shrink), small), start)
    trust = 1 / (1 + (way * shrink / (_RETURN_ERROR * size_px)) ** 2)
    moved = np.where(trust[:, None] > 0, (end + 0.5) * shrink + low - 0.5, points_px)
    moved = moved.astype(np.float64)
    camera = np.empty((2, 4))
    if np.median(trust) < _LEAST_TRUST:
        return None
    limits = np.array([size_px, _REACH, _ODD_MOTION, _CALM])
    agree(np.column_stack([points_px, depth_px]), _RELATED, limits, camera, moved, trust)
    if np.abs(camera[:, :2] - np.eye(2)).max() > _MOST_STRETCH:
        return None
    return Motion(moved, trust, camera)


def camera_between(
    before_px: FloatArray, depth_px: FloatArray, after_px: FloatArray, weights: FloatArray
) -> FloatArray:
    """Return the affine camera (2, 4) that takes points (P, 2) of some depth best to others."""
    camera = np.empty((2, 4))
    fit_camera(np.column_stack([before_px, depth_px]), after_px, weights, camera)
    return camera


def carried(camera: FloatArray, points_px: FloatArray, depth_px: FloatArray) -> FloatArray:
    """Return where an affine camera (2, 4) takes points (P, 2) of some depth."""
    flat = points_px @ camera[:, :2].T + depth_px[:, None] * camera[:, 2] + camera[:, 3]
    return np.asarray(flat)


def face_size_px(points_px: FloatArray) -> float:
    """Return the larger side of the box around the points, at least 1 px."""
    return max(float(np.ptp(points_px, axis=0).max()), 1.0)


def _window(
    shape: tuple[int, ...], points_px: FloatArray
) -> tuple[FloatArray, FloatArray, int] | None:
    """Return corners (x, y) of the part of the picture around the points, and what to halve by."""
    if not np.isfinite(points_px).all():
        return None
    low, high = points_px.min(axis=0), points_px.max(axis=0)
    size_px = max(float((high - low).max()), 1.0)
    # Whole numbers: cv2 is quick at them, and the corner stays a whole pixel of the small picture.
    shrink = max(round(size_px / _FACE_PX), 1)
    room = _MARGIN * size_px
    low = np.maximum(np.floor(low - room), 0)
    high = np.minimum(np.ceil(high + room), [shape[1], shape[0]])
    high = low + (high - low) // shrink * shrink
    if ((high - low) / shrink).min() < _LEAST_SIDE_PX:
        return None
    return low, high, shrink


def _cut(picture: U8, low: FloatArray, high: FloatArray, shrink: int) -> U8:
    (left, top), (right, bottom) = low.astype(int), high.astype(int)
    part = picture[top:bottom, left:right]
    if shrink == 1:
        return np.ascontiguousarray(part)
    size = ((right - left) // shrink, (bottom - top) // shrink)
    return np.asarray(cv2.resize(part, size, interpolation=cv2.INTER_AREA))


def _like(picture: U8, other: U8) -> U8:
    """Return a picture in the light of another: flow takes brightness for a mark on the skin.

    The median of many places leaves out what a hand covers.
    """
    dark, bright = (
        cv2.resize(one, _LIGHT_CELLS, interpolation=cv2.INTER_AREA).astype(np.float32) + 1.0
        for one in (picture, other)
    )
    gain = float(np.median(bright / dark))
    if abs(gain - 1) < _SAME_LIGHT:
        return picture
    return np.asarray(cv2.convertScaleAbs(picture, alpha=gain))


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
