"""Which setup pictures show the user's skin best."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_quaternion,
    rotation_facing_camera,
)
from core.records import U8, FloatArray, Landmarks2D, SetupShapes

#: Head angles, yaw and pitch in degrees, near which one picture is wanted; the first counts most.
WANTED_DEG = (
    (0, 0), (-28, 0), (28, 0), (-10, 4), (10, -4), (-50, 0), (50, 0), (0, 14), (0, -14),
)  # fmt: skip
#: A picture this far from what is wanted is of no use there, in degrees.
_REACH_DEG = 22.0
#: Shut eyes show the skin of the lids.
_SHUT = 0.75
_BLINK = [EXPRESSION_NAMES.index(f"eyeBlink{side}") for side in ("Left", "Right")]


@dataclass(frozen=True, slots=True)
class Choice:
    """Pictures to use.

    Attributes:
        skin: Rows of pictures of a resting face, most important first.
        lids: Rows of pictures with shut eyes.
    """

    skin: tuple[int, ...]
    lids: tuple[int, ...]


def choose(
    sharpnesses: Sequence[float], landmarks: Sequence[Landmarks2D], shapes: SetupShapes
) -> Choice:
    """Return the pictures to use: sharp, at rest, from different sides.

    Args:
        sharpnesses: `sharpness` of each picture.
        landmarks: Theirs.
        shapes: The 3D shape of each.
    """
    sure = np.array([mark.confidence.mean() for mark in landmarks])
    usable = np.isfinite(shapes.rms_px) & (sure > 0.35)
    if not usable.any():
        return Choice((), ())
    angles = head_angles_deg(shapes)
    moved = shapes.coefficients.copy()
    shut = moved[:, _BLINK].min(axis=1)
    moved[:, _BLINK] = 0
    motion = moved.sum(axis=1)
    sharp = np.array(sharpnesses)
    sharp = sharp / max(float(np.median(sharp[usable])), 1e-6)
    cost = 9.0 * motion + 14.0 * np.maximum(1 - sharp, 0) + 25.0 * shut
    cost += 0.4 * np.abs(angles[:, 2])
    cost += 4.0 * shapes.rms_px / max(float(np.median(shapes.rms_px[usable])), 1e-6)
    skin: list[int] = []
    for yaw, pitch in WANTED_DEG:
        away = np.hypot(angles[:, 0] - yaw, angles[:, 1] - pitch)
        total = np.where(usable & (away < _REACH_DEG), cost + away, np.inf)
        total[skin] = np.inf
        best = int(total.argmin())
        if np.isfinite(total[best]):
            skin.append(best)
    closed = np.where(usable & (shut > _SHUT), motion + np.abs(angles[:, 0]) / 15, np.inf)
    lids = [int(n) for n in closed.argsort()[:1] if np.isfinite(closed[n])]
    return Choice(tuple(skin), tuple(lids))


def head_angles_deg(shapes: SetupShapes) -> FloatArray:
    """Return yaw, pitch and roll (N, 3) of the heads against facing the camera."""
    rotations = matrix_from_quaternion(shapes.rotations_wxyz)
    facing = [rotation_facing_camera(place) for place in shapes.translations_mm]
    return np.rad2deg(
        [
            head_angles_from_matrix(straight.T @ turned)
            for straight, turned in zip(facing, rotations, strict=True)
        ]
    )


def sharpness(rgb: U8) -> float:
    """Return how strong the finest detail of a picture is."""
    gray = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    return float(cv2.Laplacian(gray, cv2.CV_32F).std())
