"""Smooths the edges of a drawn picture where the driver has no multisampling to spare."""

import numba

from core.records import U8

#: Difference in grey levels from which two neighbours count as an edge.
EDGE = 20


@numba.njit(cache=True, nogil=True)
def _gray(picture: U8, y: int, x: int) -> int:
    # Alpha counts too: the outline of a transparent picture is an edge.
    red, green, blue = int(picture[y, x, 0]), int(picture[y, x, 1]), int(picture[y, x, 2])
    return (2 * red + 4 * green + blue + int(picture[y, x, 3])) >> 3


@numba.njit(cache=True, nogil=True)
def _reach(picture: U8, y: int, x: int, along_x: bool, step: int) -> int:
    """Return how many pixels, at most 8, the step between two rows or columns goes on."""
    dy, dx = (0, step) if along_x else (step, 0)
    oy, ox = (1, 0) if along_x else (0, 1)
    first = _gray(picture, y, x) - _gray(picture, y + oy, x + ox)
    for k in range(1, 9):
        py, px = y + k * dy, x + k * dx
        if py < 0 or px < 0 or py + oy >= picture.shape[0] or px + ox >= picture.shape[1]:
            return k
        contrast = _gray(picture, py, px) - _gray(picture, py + oy, px + ox)
        if 2 * abs(contrast - first) > abs(first):
            return k
    return 9


@numba.njit(cache=True, nogil=True)
def smooth_edges(
    picture: U8,  # (H, W, 4)
    out: U8,  # (H, W, 4)
) -> None:
    """Write the picture with its stair steps blended, after FXAA (Lottes 2009).

    A step between two rows is followed to both of its ends. Near an end, the pixel beside the
    step takes a share of its neighbour across, as much as the true, slanted edge would cover.
    """
    height, width = picture.shape[0], picture.shape[1]
    out[:, :, :] = picture
    for y in range(1, height - 1):
        for x in range(1, width - 1):
            here = _gray(picture, y, x)
            for across in range(2):
                along_x = across == 0
                oy, ox = (1, 0) if along_x else (0, 1)
                other = _gray(picture, y + oy, x + ox)
                if abs(here - other) < EDGE:
                    continue
                before = _reach(picture, y, x, along_x, -1)
                after = _reach(picture, y, x, along_x, 1)
                if before + after >= 18 or before == after:
                    continue
                near = min(before, after)
                # Which side turns at the nearer end tells which side of the step is cut off.
                step = -near if before < after else near
                py, px = (y, x + step) if along_x else (y + step, x)
                if py < 0 or px < 0 or py + oy >= height or px + ox >= width:
                    continue
                end_here = abs(_gray(picture, py, px) - here)
                end_other = abs(_gray(picture, py + oy, px + ox) - other)
                share = 0.5 - (near - 0.5) / (before + after - 1)
                for c in range(4):
                    a, b = float(picture[y, x, c]), float(picture[y + oy, x + ox, c])
                    if end_here > end_other:
                        out[y, x, c] = numba.uint8(out[y, x, c] + share * (b - a))
                    else:
                        out[y + oy, x + ox, c] = numba.uint8(
                            out[y + oy, x + ox, c] + share * (a - b)
                        )
