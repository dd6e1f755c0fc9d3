"""The rough pose of a known shape from its image points [Dementhon and Davis 1995].

Only a start for the fits, which refine the pose together with the expression.
"""

import numpy as np

from core.records import Camera, FloatArray

ITERATIONS = 12


def pose_from_points(
    camera: Camera, points_mm: FloatArray, points_px: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return rotation (3, 3) and translation (3,) that bring the points onto their images.

    POSIT: solve for a scaled orthographic camera, correct the image points by the perspective
    that this pose implies, and repeat. The reference point is the weighted centroid.

    Args:
        camera: The camera.
        points_mm: (P, 3) in the model frame, not all in a plane.
        points_px: (P, 2).
        weights: (P,) not negative; 0 leaves a point out.
    """
    weights = weights / weights.sum()
    centroid = weights @ points_mm
    centred = points_mm - centroid
    solver = np.linalg.pinv(np.sqrt(weights)[:, None] * centred) * np.sqrt(weights)
    image = (points_px - camera.center_px) / camera.focal_px
    stretch = np.ones(len(points_mm))
    for _ in range(ITERATIONS):
        flat = image * stretch[:, None]
        middle = weights @ flat
        across, down = (solver @ (flat - middle)).T
        scale = np.sqrt(np.linalg.norm(across) * np.linalg.norm(down))
        rotation = _nearest_rotation(across, down)
        stretch = np.maximum(1 + scale * (centred @ rotation[2]), 0.2)
    depth = 1 / scale
    position = np.array([middle[0] * depth, middle[1] * depth, depth])
    return rotation, position - rotation @ centroid


def _nearest_rotation(across: FloatArray, down: FloatArray) -> FloatArray:
    """Return the rotation whose first two rows are nearest to these directions."""
    rows = np.stack([across / np.linalg.norm(across), down / np.linalg.norm(down)])
    u, _, vt = np.linalg.svd(rows, full_matrices=False)
    first, second = u @ vt
    return np.stack([first, second, np.cross(first, second)])
