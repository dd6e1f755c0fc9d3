"""Grey levels at points that ride on a face shape: what the ferns look at.

The trainer and the live regressor both sample with the functions of this file, so their features
cannot drift apart. Several shapes are treated at once: the run index l is the last axis, where
the compiler turns the inner loops into vector instructions.
"""

import numba
import numpy as np

from core.records import F32, I32, U8

ZERO = np.float32(0)
ONE = np.float32(1)
WHITE = np.float32(255)


@numba.njit(cache=True, nogil=True)
def move_shapes(
    shapes: F32,  # (Q, 3, L) mm
    rotation: F32,  # (3, 3)
    translation: F32,  # (3,) mm
    out: F32,  # (Q, 3, L) mm
) -> None:
    """Apply one rigid motion to every point of every shape."""
    for q in range(shapes.shape[0]):
        for c in range(3):
            x, y, z = rotation[c, 0], rotation[c, 1], rotation[c, 2]
            for r in range(shapes.shape[2]):
                out[q, c, r] = (
                    x * shapes[q, 0, r] + y * shapes[q, 1, r] + z * shapes[q, 2, r] + translation[c]
                )


@numba.njit(cache=True, nogil=True, fastmath={"contract", "arcp", "nsz"})
def project_points(
    shapes: F32,  # (Q, 3, L) mm, camera frame
    corners: I32,  # (P, 3) shape points that carry the point
    weights: F32,  # (P, 3) barycentric coordinates
    offsets: F32,  # (P, 3) mm, camera frame
    projection: F32,  # (3,) focal length and principal point, px
    out: F32,  # (P, 2, L) px
) -> None:
    """Place the appearance points on every shape and project them."""
    focal, center_x, center_y = projection[0], projection[1], projection[2]
    for p in range(corners.shape[0]):
        a, b, c = shapes[corners[p, 0]], shapes[corners[p, 1]], shapes[corners[p, 2]]
        u, v, w = weights[p, 0], weights[p, 1], weights[p, 2]
        dx, dy, dz = offsets[p, 0], offsets[p, 1], offsets[p, 2]
        for r in range(shapes.shape[2]):
            x = u * a[0, r] + v * b[0, r] + w * c[0, r] + dx
            y = u * a[1, r] + v * b[1, r] + w * c[1, r] + dy
            z = u * a[2, r] + v * b[2, r] + w * c[2, r] + dz
            # A shape gone astray may reach the camera; 1 mm keeps the division finite.
            scale = focal / max(z, ONE)
            out[p, 0, r] = x * scale + center_x
            out[p, 1, r] = y * scale + center_y


@numba.njit(cache=True, nogil=True)
def sample_image(
    image: U8,  # (H, W)
    positions: F32,  # (P, 2, L) px
    out: F32,  # (P, L) grey levels
) -> None:
    """Read the image between its pixels; beyond the border the border pixel goes on."""
    # The last row and column are reached only to 1/100 px, so that x + 1 stays inside.
    last_x = np.float32(image.shape[1] - 1.01)
    last_y = np.float32(image.shape[0] - 1.01)
    for p in range(positions.shape[0]):
        for r in range(positions.shape[2]):
            u = min(max(positions[p, 0, r], ZERO), last_x)
            v = min(max(positions[p, 1, r], ZERO), last_y)
            x, y = np.int32(u), np.int32(v)
            right, down = u - np.float32(x), v - np.float32(y)
            a, b = np.float32(image[y, x]), np.float32(image[y, x + 1])
            c, d = np.float32(image[y + 1, x]), np.float32(image[y + 1, x + 1])
            upper = a + right * (b - a)
            lower = c + right * (d - c)
            out[p, r] = upper + down * (lower - upper)


@numba.njit(cache=True, nogil=True, fastmath={"contract", "arcp", "nsz"})
def normalise_cells(
    intensities: F32,  # (P, L) grey levels
    members: I32,  # (C, n) points that a cell is measured on
    cell: I32,  # (P,) the cell of each point
    softening: float,  # grey levels, keeps noise of flat skin small
    mean: F32,  # (C, L) scratch
    scale: F32,  # (C, L) scratch
    out: F32,  # (P, L)
) -> None:
    """Take the local mean from every intensity and divide by the local contrast."""
    n_runs = intensities.shape[1]
    share = ONE / np.float32(members.shape[1])
    floor = np.float32(softening * softening)
    for c in range(members.shape[0]):
        for r in range(n_runs):
            mean[c, r] = ZERO
            scale[c, r] = ZERO
        for k in range(members.shape[1]):
            row = intensities[members[c, k]]
            for r in range(n_runs):
                mean[c, r] += row[r]
                scale[c, r] += row[r] * row[r]
        for r in range(n_runs):
            mean[c, r] *= share
            variance = max(scale[c, r] * share - mean[c, r] * mean[c, r], ZERO)
            scale[c, r] = ONE / np.sqrt(variance + floor)
    for p in range(intensities.shape[0]):
        c = cell[p]
        for r in range(n_runs):
            out[p, r] = (intensities[p, r] - mean[c, r]) * scale[c, r]


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
    positions: F32,  # (P, 2, 1) px
    intensities: F32,  # (P, 1) grey levels, changed in place
) -> None:
    """Change the sampled grey levels as another lamp, a covering thing, another exposure would."""
    height, width = images.shape[1], images.shape[2]
    for p in range(positions.shape[0]):
        u, v = positions[p, 0, 0], positions[p, 1, 0]
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
    for s in numba.prange(shapes.shape[0]):
        shape = np.empty((shapes.shape[1], 3, 1), np.float32)
        for q in range(shapes.shape[1]):
            for c in range(3):
                shape[q, c, 0] = shapes[s, q, c] + shift[s, c]
        positions = np.empty((n_points, 2, 1), np.float32)
        intensities = np.empty((n_points, 1), np.float32)
        project_points(shape, corners, weights, offsets, projection, positions)
        i = image[s]
        sample_image(images[i], positions, intensities)
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
