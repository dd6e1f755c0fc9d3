"""Grey levels at points that ride on a face shape: what the ferns look at.

The trainer and the live regressor both sample with the functions of this file, so their features
cannot drift apart. Several shapes are treated at once: the run index r is the last axis, where
the compiler turns the inner loops into vector instructions.
"""

from typing import NamedTuple

import numba
import numpy as np

from core.kernels.image_reading import sample_image
from core.records import F32, I32, U8, U32

ZERO = np.float32(0)
ONE = np.float32(1)


class Room(NamedTuple):
    """Work space for the appearance of R shapes at P points."""

    in_camera: F32  # (Q, 3, R) mm
    positions: F32  # (2, P, R) px
    pixels: U32  # (P, R)
    mean: F32  # (C, R)
    scale: F32  # (C, R)


@numba.njit(cache=True, nogil=True)
def move_shapes(
    shapes: F32,  # (R, Q, 3) mm
    rotation: F32,  # (3, 3)
    translation: F32,  # (3,) mm
    out: F32,  # (Q, 3, R) mm
) -> None:
    """Apply one rigid motion to every point of every shape."""
    for q in range(shapes.shape[1]):
        for r in range(shapes.shape[0]):
            x, y, z = shapes[r, q, 0], shapes[r, q, 1], shapes[r, q, 2]
            for c in range(3):
                out[q, c, r] = (
                    rotation[c, 0] * x + rotation[c, 1] * y + rotation[c, 2] * z + translation[c]
                )


@numba.njit(cache=True, nogil=True, fastmath={"contract", "arcp", "nsz"})
def project_points(
    shapes: F32,  # (Q, 3, R) mm, camera frame
    corners: I32,  # (P, 3) shape points that carry the point
    weights: F32,  # (P, 3) barycentric coordinates
    offsets: F32,  # (P, 3) mm, frame of the shape space
    rotation: F32,  # (3, 3) shape space to camera
    projection: F32,  # (3,) focal length and principal point, px
    out: F32,  # (2, P, R) px
) -> None:
    """Place the appearance points on every shape and project them."""
    focal, center_x, center_y = projection[0], projection[1], projection[2]
    for p in range(corners.shape[0]):
        a, b, c = shapes[corners[p, 0]], shapes[corners[p, 1]], shapes[corners[p, 2]]
        u, v, w = weights[p, 0], weights[p, 1], weights[p, 2]
        i, j, k = offsets[p, 0], offsets[p, 1], offsets[p, 2]
        dx = rotation[0, 0] * i + rotation[0, 1] * j + rotation[0, 2] * k
        dy = rotation[1, 0] * i + rotation[1, 1] * j + rotation[1, 2] * k
        dz = rotation[2, 0] * i + rotation[2, 1] * j + rotation[2, 2] * k
        out_x, out_y = out[0, p], out[1, p]
        for r in range(shapes.shape[2]):
            x = u * a[0, r] + v * b[0, r] + w * c[0, r] + dx
            y = u * a[1, r] + v * b[1, r] + w * c[1, r] + dy
            z = u * a[2, r] + v * b[2, r] + w * c[2, r] + dz
            # A shape gone astray may reach the camera; 1 mm keeps the division finite.
            scale = focal / max(z, ONE)
            out_x[r] = x * scale + center_x
            out_y[r] = y * scale + center_y


@numba.njit(cache=True, nogil=True, fastmath={"contract", "arcp", "nsz"})
def normalise_cells(
    intensities: F32,  # (P, R) grey levels
    members: I32,  # (C, n) points that a cell is measured on
    cell: I32,  # (P,) the cell of each point
    softening: float,  # grey levels, keeps noise of flat skin small
    mean: F32,  # (C, R) scratch
    scale: F32,  # (C, R) scratch
    out: F32,  # (P, R)
) -> None:
    """Take the local mean from every intensity and divide by the local contrast."""
    n_runs, n_members = intensities.shape[1], members.shape[1]
    share, floor = ONE / np.float32(n_members), np.float32(softening * softening)
    for c in range(members.shape[0]):
        total, squares = mean[c], scale[c]
        total[:] = ZERO
        squares[:] = ZERO
        # Four at a time: the sums are fetched and put back less often.
        fours = n_members - n_members % 4
        for k in range(0, fours, 4):
            i, j = intensities[members[c, k]], intensities[members[c, k + 1]]
            m, n = intensities[members[c, k + 2]], intensities[members[c, k + 3]]
            for r in range(n_runs):
                total[r] += (i[r] + j[r]) + (m[r] + n[r])
                squares[r] += (i[r] * i[r] + j[r] * j[r]) + (m[r] * m[r] + n[r] * n[r])
        for k in range(fours, n_members):
            i = intensities[members[c, k]]
            for r in range(n_runs):
                total[r] += i[r]
                squares[r] += i[r] * i[r]
        for r in range(n_runs):
            total[r] *= share
            variance = max(squares[r] * share - total[r] * total[r], ZERO)
            squares[r] = ONE / np.sqrt(variance + floor)
    for p in range(intensities.shape[0]):
        row, middle, factor, result = intensities[p], mean[cell[p]], scale[cell[p]], out[p]
        for r in range(n_runs):
            result[r] = (row[r] - middle[r]) * factor[r]


@numba.njit(cache=True, nogil=True)
def read_appearance(
    image: U8,  # (H, W)
    shapes: F32,  # (R, Q, 3) mm, shape space
    rotation: F32,  # (3, 3) shape space to camera
    translation: F32,  # (3,) mm
    projection: F32,  # (3,)
    corners: I32,  # (P, 3)
    weights: F32,  # (P, 3)
    offsets: F32,  # (P, 3) mm, shape space
    members: I32,  # (C, n)
    cell: I32,  # (P,)
    softening: float,  # grey levels; 0: no normalisation
    room: Room,
    out: F32,  # (P, R)
) -> None:
    """Read the appearance of every shape."""
    move_shapes(shapes, rotation, translation, room.in_camera)
    project_points(room.in_camera, corners, weights, offsets, rotation, projection, room.positions)
    sample_image(image, room.positions, room.pixels, out)
    if softening > 0:
        normalise_cells(out, members, cell, softening, room.mean, room.scale, out)
