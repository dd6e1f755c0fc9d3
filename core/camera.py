"""Pinhole projection and its Jacobian [Cao13, eq. 1 and 9]."""

import numpy as np

from core.records import Camera, FloatArray


def camera_for(size_px: tuple[int, int], focal_px: float) -> Camera:
    """Return the camera with its principal point at the centre of the image."""
    width, height = size_px
    return Camera(float(focal_px), np.array([(width - 1) / 2, (height - 1) / 2]), (width, height))


def project(camera: Camera, points_mm: FloatArray) -> FloatArray:
    """Return image positions (..., 2) in px of points (..., 3) in the camera frame."""
    points = np.asarray(points_mm, float)
    return np.asarray(camera.focal_px * points[..., :2] / points[..., 2:] + camera.center_px)


def project_jacobian(camera: Camera, points_mm: FloatArray) -> FloatArray:
    """Return d(u, v)/d(x, y, z), shape (..., 2, 3) in px per mm, at camera-frame points."""
    points = np.asarray(points_mm, float)
    x, y, z = np.moveaxis(points, -1, 0)
    scale = camera.focal_px / z
    jacobian = np.zeros((*points.shape[:-1], 2, 3))
    jacobian[..., 0, 0] = scale
    jacobian[..., 1, 1] = scale
    jacobian[..., 0, 2] = -scale * x / z
    jacobian[..., 1, 2] = -scale * y / z
    return jacobian


def unproject(camera: Camera, points_px: FloatArray, depth_mm: FloatArray) -> FloatArray:
    """Return camera-frame points (..., 3) of image positions (..., 2) at depths (...)."""
    depth = np.asarray(depth_mm, float)[..., None]
    plane = (np.asarray(points_px, float) - camera.center_px) * depth / camera.focal_px
    return np.concatenate([plane, np.broadcast_to(depth, (*plane.shape[:-1], 1))], axis=-1)


def scaled(camera: Camera, size_px: tuple[int, int]) -> Camera:
    """Return the camera of the same pictures resized to another size of the same aspect."""
    factor = size_px[0] / camera.size_px[0]
    center = (camera.center_px + 0.5) * factor - 0.5
    return Camera(camera.focal_px * factor, center, size_px)


def seen_by(camera: Camera, size_px: tuple[int, int]) -> Camera:
    """Return the camera of the same view in pictures of another size.

    The longer side counts: pictures are cut at the shorter one, or turned upright.
    """
    if size_px == camera.size_px:
        return camera
    return camera_for(size_px, camera.focal_px * max(size_px) / max(camera.size_px))
