"""Grey levels of training samples, changed as other light and things in the way would."""

import numba
import numpy as np

from core.kernels.appearance import move_shapes, normalise_cells, project_points
from core.kernels.image_reading import sample_image
from core.records import F32, I32, U8

ZERO = np.float32(0)
ONE = np.float32(1)
WHITE = np.float32(255)


@numba.njit(cache=True, nogil=True)
def _light_factor(normals: F32, lamp: F32, u: float, v: float) -> float:
    """Return the brightness that a lamp gives the surface seen at a pixel."""
    if lamp[4] == ZERO:
        return 1.0
    rows, columns = normals.shape[0], normals.shape[1]
    y = min(max(int(v * np.float32(rows)), 0), rows - 1)
    x = min(max(int(u * np.float32(columns)), 0), columns - 1)
    cosine = normals[y, x, 0] * lamp[0] + normals[y, x, 1] * lamp[1] + normals[y, x, 2] * lamp[2]
    return lamp[3] + lamp[4] * max(cosine, ZERO)


@numba.njit(cache=True, nogil=True)
def _is_covered(occluder: F32, x: float, y: float) -> bool:
    """Return whether a point, in face radii from the face's centre, lies in the occluder."""
    dx, dy = x - occluder[0], y - occluder[1]
    a = (occluder[4] * dx + occluder[5] * dy) / occluder[2]
    b = (occluder[4] * dy - occluder[5] * dx) / occluder[3]
    # A fourth power: between an ellipse and a rectangle.
    return a * a * a * a + b * b * b * b < ONE


@numba.njit(cache=True, nogil=True)
def disturb(
    images: U8,  # (N, H, W)
    normals: F32,  # (h, w, 3) of the sample's image
    face: F32,  # (3,) centre and radius of the face in the sample's image, px
    exposure: F32,  # (4,) gain, gamma, gradient per face radius in x and y
    lamp: F32,  # (5,) direction, ambient light, strength; strength 0: no lamp
    occluder: F32,  # (10,) centre, half axes, cos, sin; image, shift x, y; brightness
    positions: F32,  # (2, P, 1) px
    intensities: F32,  # (P, 1) grey levels, changed in place
) -> None:
    """Change the sampled grey levels as another lamp, a covering thing, another exposure would."""
    height, width = images.shape[1], images.shape[2]
    for p in range(positions.shape[1]):
        u, v = positions[0, p, 0], positions[1, p, 0]
        x, y = (u - face[0]) / face[2], (v - face[1]) / face[2]
        value = intensities[p, 0]
        value *= _light_factor(normals, lamp, u / np.float32(width), v / np.float32(height))
        if occluder[2] > ZERO and _is_covered(occluder, x, y):
            column = min(max(int(u + occluder[7]), 0), width - 1)
            row = min(max(int(v + occluder[8]), 0), height - 1)
            value = np.float32(images[int(occluder[6]), row, column]) * occluder[9]
        value = WHITE * (max(value, ZERO) / WHITE) ** exposure[1] * exposure[0]
        value *= max(ONE + exposure[2] * x + exposure[3] * y, ZERO)
        intensities[p, 0] = min(value, WHITE)


@numba.njit(cache=True, nogil=True, parallel=True)
def sample_training(
    images: U8,  # (N, H, W)
    image: I32,  # (S,) the image of each sample
    shift: F32,  # (S, 3) mm, brings the sample's shapes to where its image shows them
    shapes: F32,  # (S, Q, 3) mm, current guesses
    corners: I32,  # (P, 3)
    weights: F32,  # (P, 3)
    offsets: F32,  # (P, 3)
    members: I32,  # (C, n)
    cell: I32,  # (P,)
    softening: float,  # grey levels; 0: no normalisation
    projection: F32,  # (3,)
    normals: F32,  # (N, h, w, 3)
    faces: F32,  # (N, 3)
    exposure: F32,  # (S, 4)
    lamp: F32,  # (S, 5)
    occluder: F32,  # (S, 10)
    out: F32,  # (S, P)
) -> None:
    """Sample the appearance of every training sample at its current guess."""
    n_points = corners.shape[0]
    straight = np.eye(3, dtype=np.float32)
    for s in numba.prange(shapes.shape[0]):
        i = image[s]
        shape = np.empty((shapes.shape[1], 3, 1), np.float32)
        positions = np.empty((2, n_points, 1), np.float32)
        intensities = np.empty((n_points, 1), np.float32)
        move_shapes(shapes[s : s + 1], straight, shift[s], shape)
        project_points(shape, corners, weights, offsets, straight, projection, positions)
        spoiled, pixels = positions.copy(), np.empty((n_points, 1), np.uint32)
        sample_image(images[i], spoiled, pixels, intensities)
        disturb(
            images,
            normals[i],
            faces[i],
            exposure[s],
            lamp[s],
            occluder[s],
            positions,
            intensities,
        )
        if softening > 0:
            mean = np.empty((members.shape[0], 1), np.float32)
            scale = np.empty((members.shape[0], 1), np.float32)
            normalise_cells(intensities, members, cell, softening, mean, scale, intensities)
        for p in range(n_points):
            out[s, p] = intensities[p, 0]
