"""Finishes a drawn picture: smooth edges where the driver has no multisampling, a backdrop."""

import numba

from core.records import U8

#: Difference in grey levels from which two neighbours count as an edge.
EDGE = 36


@numba.njit(cache=True, nogil=True)
def gray_of(
    picture: U8,  # (H, W, 4)
    out: U8,  # (H, W)
) -> None:
    """Write the grey level; alpha counts too, since the outline of a figure is an edge."""
    for y in range(picture.shape[0]):
        for x in range(picture.shape[1]):
            red, green, blue = picture[y, x, 0], picture[y, x, 1], picture[y, x, 2]
            total = numba.uint32(2) * red + numba.uint32(4) * green + blue + picture[y, x, 3]
            out[y, x] = numba.uint8(total >> numba.uint32(3))


@numba.njit(cache=True, nogil=True)
def _reach(gray: U8, y: int, x: int, along_x: bool, step: int) -> int:
    """Return how many pixels, at most 9, the step between two rows or columns goes on.

    `int` of an unsigned number stays unsigned in numba, and differences wrap: hence int64.
    """
    dy, dx = (0, step) if along_x else (step, 0)
    oy, ox = (1, 0) if along_x else (0, 1)
    first = numba.int64(gray[y, x]) - numba.int64(gray[y + oy, x + ox])
    for k in range(1, 9):
        py, px = y + k * dy, x + k * dx
        if py < 0 or px < 0 or py + oy >= gray.shape[0] or px + ox >= gray.shape[1]:
            return k
        contrast = numba.int64(gray[py, px]) - numba.int64(gray[py + oy, px + ox])
        if 2 * abs(contrast - first) > abs(first):
            return k
    return 9


@numba.njit(cache=True, nogil=True)
def _smooth_step(picture: U8, gray: U8, y: int, x: int, along_x: bool, out: U8) -> None:
    """Blend the pixels on both sides of one step."""
    oy, ox = (1, 0) if along_x else (0, 1)
    before = _reach(gray, y, x, along_x, -1)
    after = _reach(gray, y, x, along_x, 1)
    if before + after >= 18 or before == after:
        return
    near = min(before, after)
    step = -near if before < after else near
    py, px = (y, x + step) if along_x else (y + step, x)
    if py < 0 or px < 0 or py + oy >= gray.shape[0] or px + ox >= gray.shape[1]:
        return
    # Which side changes at the nearer end tells which side of the step the true edge cuts off.
    end_here = abs(numba.int64(gray[py, px]) - numba.int64(gray[y, x]))
    end_other = abs(numba.int64(gray[py + oy, px + ox]) - numba.int64(gray[y + oy, x + ox]))
    share = 0.5 - (near - 0.5) / (before + after - 1)
    for c in range(4):
        a, b = float(picture[y, x, c]), float(picture[y + oy, x + ox, c])
        if end_here > end_other:
            mixed = out[y, x, c] + share * (b - a)
            out[y, x, c] = numba.uint8(min(max(mixed, 0.0), 255.0))
        else:
            mixed = out[y + oy, x + ox, c] + share * (a - b)
            out[y + oy, x + ox, c] = numba.uint8(min(max(mixed, 0.0), 255.0))


@numba.njit(cache=True, nogil=True)
def mark_edges(
    gray: U8,  # (H, W)
    out: U8,  # (H, W) 1 where a pixel differs from the one below, 2 from the one right of it
) -> None:
    """Mark the steps of a picture; kept plain, so that it becomes vector instructions."""
    height, width = gray.shape
    for y in range(height - 1):
        for x in range(width - 1):
            here, below, right = gray[y, x], gray[y + 1, x], gray[y, x + 1]
            down = max(here, below) - min(here, below) >= EDGE
            across = max(here, right) - min(here, right) >= EDGE
            out[y, x] = numba.uint8(down) | (numba.uint8(across) << 1)
        out[y, width - 1] = 0
    out[height - 1, :] = 0


@numba.njit(cache=True, nogil=True)
def smooth_edges(
    picture: U8,  # (H, W, 4)
    gray: U8,  # (H, W) of the picture
    marks: U8,  # (H, W) of `mark_edges`
    out: U8,  # (H, W, 4) a copy of the picture, changed at edges
) -> None:
    """Blend the stair steps of a picture, after FXAA (Lottes 2009).

    A step between two rows is followed to both of its ends. Near an end, the pixel beside the
    step takes a share of its neighbour across, as much as the true, slanted edge would cover.
    """
    for y in range(gray.shape[0] - 1):
        for x in range(gray.shape[1] - 1):
            if marks[y, x] == 0:
                continue
            if marks[y, x] & 1:
                _smooth_step(picture, gray, y, x, True, out)
            if marks[y, x] & 2:
                _smooth_step(picture, gray, y, x, False, out)


@numba.njit(cache=True, nogil=True)
def lay_over(
    backdrop: U8,  # (H, W, 3)
    picture: U8,  # (H, W, 4) premultiplied; changed
) -> None:
    """Put a backdrop behind a picture, which becomes opaque."""
    for y in range(picture.shape[0]):
        for x in range(picture.shape[1]):
            alpha = picture[y, x, 3]
            if alpha == 255:
                continue
            if alpha == 0:
                for c in range(3):
                    picture[y, x, c] = backdrop[y, x, c]
            else:
                rest = numba.uint32(255) - alpha
                for c in range(3):
                    behind = (rest * backdrop[y, x, c] + numba.uint32(127)) // numba.uint32(255)
                    total = picture[y, x, c] + behind
                    picture[y, x, c] = numba.uint8(min(total, numba.uint32(255)))
            picture[y, x, 3] = 255


@numba.njit(cache=True, nogil=True)
def cut_out(
    red: int,
    green: int,
    blue: int,
    picture: U8,  # (H, W, 4) premultiplied; changed
) -> None:
    """Put one colour behind a picture without ever mixing it with the figure.

    A pixel is the figure's own colour where the figure covers half of it, and the colour
    elsewhere: what keys the colour out later finds no mixture that would stay as a fringe.
    """
    key = (numba.uint8(red), numba.uint8(green), numba.uint8(blue))
    for y in range(picture.shape[0]):
        for x in range(picture.shape[1]):
            alpha = numba.uint32(picture[y, x, 3])
            if alpha == 255:
                continue
            if alpha < 128:
                for c in range(3):
                    picture[y, x, c] = key[c]
            else:
                for c in range(3):
                    own = (numba.uint32(picture[y, x, c]) * 255 + alpha // 2) // alpha
                    picture[y, x, c] = numba.uint8(min(own, numba.uint32(255)))
            picture[y, x, 3] = 255
