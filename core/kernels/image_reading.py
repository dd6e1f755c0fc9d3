"""Grey levels of an image between its pixels, at many places at once."""

import numba
import numpy as np

from core.records import F32, U8, U32

ZERO = np.float32(0)
BYTE = np.uint32(255)


@numba.njit(cache=True, nogil=True)
def _split_positions(
    x: F32,  # (P * R,) px; the part beyond the pixel's centre stays
    y: F32,  # (P * R,)
    height: int,
    width: int,
    pixels: U32,  # (P * R,) out: number of the pixel, row by row
) -> None:
    """Split positions into a pixel and what lies between it and the next ones."""
    # The last row and column are reached only to 1/100 px, so that x + 1 stays inside.
    last_x, last_y = np.float32(width - 1.01), np.float32(height - 1.01)
    for n in range(pixels.size):
        u, v = min(max(x[n], ZERO), last_x), min(max(y[n], ZERO), last_y)
        column, row = np.int32(u), np.int32(v)
        x[n], y[n] = u - np.float32(column), v - np.float32(row)
        pixels[n] = np.uint32(row * np.int32(width) + column)


@numba.njit(cache=True, nogil=True)
def _fetch_pixels(
    image: U8,  # (H * W,)
    width: int,
    pixels: U32,  # (N,) numbers of pixels; in their place the four grey levels from there on
) -> None:
    """Fetch each pixel, its right, its lower and its lower right neighbour, 8 bits each."""
    next_row, one = np.uint64(width), np.uint64(1)
    for n in range(pixels.size):
        # Unsigned: a signed index would be tested for counting from the end.
        k = np.uint64(pixels[n])
        upper = np.uint32(image[k]) | np.uint32(image[k + one]) << np.uint32(8)
        k += next_row
        lower = np.uint32(image[k]) | np.uint32(image[k + one]) << np.uint32(8)
        pixels[n] = upper | lower << np.uint32(16)


@numba.njit(cache=True, nogil=True)
def _blend_pixels(
    pixels: U32,  # (N,) four grey levels each
    right: F32,  # (N,) in [0, 1)
    down: F32,  # (N,)
    out: F32,  # (N,)
) -> None:
    """Interpolate between four grey levels."""
    for n in range(pixels.size):
        four = pixels[n]
        a = np.float32(np.int32(four & BYTE))
        b = np.float32(np.int32(four >> np.uint32(8) & BYTE))
        c = np.float32(np.int32(four >> np.uint32(16) & BYTE))
        d = np.float32(np.int32(four >> np.uint32(24)))
        upper = a + right[n] * (b - a)
        lower = c + right[n] * (d - c)
        out[n] = upper + down[n] * (lower - upper)


@numba.njit(cache=True, nogil=True)
def sample_image(
    image: U8,  # (H, W)
    positions: F32,  # (2, P, R) px, spoiled
    pixels: U32,  # (P, R) scratch
    out: F32,  # (P, R) grey levels
) -> None:
    """Read the image between its pixels; beyond the border the border pixel goes on.

    Three loops, of which only the one that fetches pixels cannot become vector instructions.
    """
    height, width = image.shape
    flat = pixels.reshape(pixels.size)
    x, y = positions[0].reshape(flat.size), positions[1].reshape(flat.size)
    _split_positions(x, y, height, width, flat)
    _fetch_pixels(image.reshape(image.size), width, flat)
    _blend_pixels(flat, x, y, out.reshape(flat.size))
