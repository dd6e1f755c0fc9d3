"""Where the pupils are in space: on the eyeballs, in the line of sight."""

from collections.abc import Sequence

import numpy as np

from core.camera import unproject
from core.fit_problem import State, posed
from core.records import Camera, FloatArray, Landmarks2D

#: Below this confidence the eye is taken to look straight ahead.
SEEN = 0.5
#: The eye turns at most this far from straight ahead.
LIMIT_RAD = 0.8


def pupils_mm(
    camera: Camera,
    state: State,
    centers_mm: FloatArray,
    radius_mm: float,
    landmarks: Sequence[Landmarks2D],
) -> FloatArray:
    """Return both pupils (N, 2, 3) of every picture in the camera frame.

    The line of sight through the iris centre meets the eyeball; of the two points the front one
    is the pupil. An unseen pupil looks straight ahead.

    Args:
        camera: The camera.
        state: Head poses of the N pictures.
        centers_mm: (2, 3) eyeball centres in the model frame, the right one first.
        radius_mm: Radius of the eyeballs.
        landmarks: N pictures' landmarks, of which the pupils are read.
    """
    n_pictures = len(landmarks)
    centers = posed(np.broadcast_to(centers_mm, (n_pictures, 2, 3)), state)
    forward = -state.rotations[:, None, :, 2]
    pixels = np.stack([one.pupils_px for one in landmarks])
    rays = unproject(camera, pixels, np.ones((n_pictures, 2)))
    direction = limited(sphere_directions(rays, centers, radius_mm), forward)
    seen = np.stack([one.pupil_confidence for one in landmarks]) >= SEEN
    direction = np.where(seen[..., None], direction, forward)
    return np.asarray(centers + radius_mm * direction)


def sphere_directions(rays: FloatArray, centers_mm: FloatArray, radius_mm: float) -> FloatArray:
    """Return unit directions (..., 3) from sphere centres to where rays first meet the spheres.

    A ray that misses counts as touching the sphere where it passes nearest.

    Args:
        rays: (..., 3) directions from the origin, of any length.
        centers_mm: (..., 3).
        radius_mm: Radius of the spheres.
    """
    rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    along = np.sum(rays * centers_mm, axis=-1, keepdims=True)
    miss = rays * along - centers_mm
    depth = np.sqrt(np.maximum(radius_mm**2 - np.sum(miss**2, axis=-1, keepdims=True), 0.0))
    offset = miss - depth * rays
    return np.asarray(offset / np.linalg.norm(offset, axis=-1, keepdims=True))


def limited(direction: FloatArray, forward: FloatArray) -> FloatArray:
    """Return directions turned back to at most LIMIT_RAD from straight ahead, all (..., 3)."""
    cosine = np.sum(direction * forward, axis=-1, keepdims=True)
    side = direction - cosine * forward
    side = side / np.maximum(np.linalg.norm(side, axis=-1, keepdims=True), 1e-9)
    edge = np.cos(LIMIT_RAD) * forward + np.sin(LIMIT_RAD) * side
    return np.where(cosine < np.cos(LIMIT_RAD), edge, direction)
