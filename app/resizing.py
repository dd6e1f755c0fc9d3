"""Pictures at another size or tone; setup pictures with their landmarks."""

from dataclasses import replace

import cv2
import numpy as np

from core.landmark_confidence import inside
from core.records import U8, FloatArray, Landmarks2D


def at_size(rgb: U8, landmarks: Landmarks2D, size_px: tuple[int, int]) -> tuple[U8, Landmarks2D]:
    """Return a picture as the same camera would have taken it at another size.

    The longer side counts, as in core.camera.seen_by: what is missing at the other one is filled
    with the colours of the border, what is too much is cut off.

    Args:
        rgb: (H, W, 3).
        landmarks: In this picture; those that are cut off lose their confidence.
        size_px: Wanted width and height.
    """
    height, width = rgb.shape[:2]
    if (width, height) == size_px:
        return rgb, landmarks
    factor = max(size_px) / max(width, height)
    scaled_px = max(round(width * factor), 1), max(round(height * factor), 1)
    how = cv2.INTER_AREA if factor < 1 else cv2.INTER_LINEAR
    picture = _centred(np.asarray(cv2.resize(rgb, scaled_px, interpolation=how)), size_px)
    before, after = np.array([width, height]), np.array(scaled_px)
    shift = (np.array(size_px) - after) // 2

    def moved(points_px: FloatArray) -> FloatArray:
        return np.asarray((points_px + 0.5) * after / before - 0.5 + shift)

    points, pupils = moved(landmarks.points_px), moved(landmarks.pupils_px)
    return picture, replace(
        landmarks,
        points_px=points,
        confidence=landmarks.confidence * inside(points, size_px),
        pupils_px=pupils,
        pupil_confidence=landmarks.pupil_confidence * inside(pupils, size_px),
    )


def thumbnail(rgb: U8, width: int) -> U8:
    """Return a small copy of a picture."""
    height = round(width * rgb.shape[0] / rgb.shape[1])
    return np.asarray(cv2.resize(rgb, (width, height), interpolation=cv2.INTER_AREA), np.uint8)


def toned(rgb: U8, brightness: int, contrast: int) -> U8:
    """Return a picture as shown at a brightness and contrast of -100 to 100."""
    gain = 2.0 ** (contrast / 50)
    return np.asarray(cv2.convertScaleAbs(rgb, None, gain, 128 * (1 - gain) + brightness), np.uint8)


def _centred(rgb: U8, size_px: tuple[int, int]) -> U8:
    """Return a picture cut or filled at both ends of each side."""
    wanted = np.array(size_px)[::-1]
    missing = wanted - rgb.shape[:2]
    before = missing // 2
    after = missing - before
    top, left, bottom, right = np.maximum([*before, *after], 0).tolist()
    filled = cv2.copyMakeBorder(rgb, top, bottom, left, right, cv2.BORDER_REPLICATE)
    y, x = np.maximum(-before, 0).tolist()
    return np.ascontiguousarray(filled[y : y + wanted[0], x : x + wanted[1]], dtype=np.uint8)
