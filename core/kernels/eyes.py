"""Inner loops of reading the gaze from the picture: a patch around an eye, and what it says."""

import numba
import numpy as np

from core.records import F32, U8, FloatArray


@numba.njit(cache=True, nogil=True)
def read_eye(
    image: U8,  # (H, W)
    camera: FloatArray,  # (3,) focal length, principal point, px
    pose: FloatArray,  # (4, 3) head-to-camera rotation matrix, then the translation in mm
    middle: FloatArray,  # (3,) of the patch, head frame
    xs: FloatArray,  # (X,) mm from the middle
    ys: FloatArray,  # (Y,)
    apart: float,  # mm between the readings that are averaged, 2 by 2; 0 reads once
    out: F32,  # (Y * X,) grey levels, row by row
) -> None:
    """Read a patch that lies before an eye, parallel to the face; the border pixel goes on."""
    height, width = image.shape
    # The last row and column are reached only to 1/100 px, so that x + 1 stays inside.
    last_x, last_y = width - 1.01, height - 1.01
    readings = 2 if apart > 0 else 1
    for j in range(ys.size):
        for i in range(xs.size):
            total = 0.0
            for k in range(readings * readings):
                a = middle[0] + xs[i] + apart * (k % readings - 0.5 * (readings - 1))
                b = middle[1] + ys[j] + apart * (k // readings - 0.5 * (readings - 1))
                c = middle[2]
                depth = pose[2, 0] * a + pose[2, 1] * b + pose[2, 2] * c + pose[3, 2]
                x = pose[0, 0] * a + pose[0, 1] * b + pose[0, 2] * c + pose[3, 0]
                y = pose[1, 0] * a + pose[1, 1] * b + pose[1, 2] * c + pose[3, 1]
                x = min(max(camera[0] * x / depth + camera[1], 0.0), last_x)
                y = min(max(camera[0] * y / depth + camera[2], 0.0), last_y)
                column, row = int(x), int(y)
                right, down = x - column, y - row
                upper = (1 - right) * image[row, column] + right * image[row, column + 1]
                lower = (1 - right) * image[row + 1, column] + right * image[row + 1, column + 1]
                total += (1 - down) * upper + down * lower
            out[j * xs.size + i] = total / (readings * readings)


@numba.njit(cache=True, nogil=True)
def level_patch(
    patch: F32,  # (P,) changed
    least_spread: float,
) -> None:
    """Take mean and contrast off a patch."""
    mean, square = 0.0, 0.0
    for p in range(patch.size):
        mean += patch[p]
        square += patch[p] * patch[p]
    mean /= patch.size
    spread = np.sqrt(max(square / patch.size - mean * mean, 0.0)) + least_spread
    for p in range(patch.size):
        patch[p] = (patch[p] - mean) / spread


@numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def eye_direction(
    patch: F32,  # (P,) levelled
    examples: F32,  # (C, P) levelled patches
    narrowness: float,
    weights: F32,  # (C + P + 1, 2)
    out: FloatArray,  # (2,) yaw and pitch
) -> None:
    """Write the direction that a patch shows: a sum over like examples and a linear part."""
    n_examples, size = examples.shape
    yaw, pitch = weights[n_examples + size, 0], weights[n_examples + size, 1]
    for p in range(size):
        yaw += patch[p] * weights[n_examples + p, 0]
        pitch += patch[p] * weights[n_examples + p, 1]
    for c in range(n_examples):
        square = np.float32(0)
        for p in range(size):
            apart = patch[p] - examples[c, p]
            square += apart * apart
        near = np.exp(-narrowness * square)
        yaw += near * weights[c, 0]
        pitch += near * weights[c, 1]
    out[0], out[1] = yaw, pitch
