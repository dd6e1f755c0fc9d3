"""Eyelids that slide over the eyeball: blinking, squinting and opening wide on any head.

Every vertex near an eye is seen from the eye's centre as longitude, latitude (down positive) and
radius. A lid moves by turning its vertices in latitude, so it stays outside the ball; the rims
of both lids, as latitudes over longitude, say how far there is to go.
"""

from dataclasses import dataclass

import numpy as np

from assets.build.face_model.head import Head
from assets.build.face_model.seam import Edges, Seam
from assets.build.face_model.surface import Loops, Surface, smooth_step

OUTER_CORNER, INNER_CORNER = 21, 66
#: Edge loops around the opening: the rim in front and the inner edge towards the ball.
RIM_START, INNER_EDGE_START, LOOP_LENGTH = (0, 6), (2115, 2120), 28
#: Distance along the skin from the rim over which a lid's movement fades out.
UPPER_REACH_MM, LOWER_REACH_MM, INSIDE_REACH_MM = 16.0, 12.0, 9.5
#: Distance from the rim within which skin is kept out of the ball.
AROUND_MM = 24.0
#: Distance along the skin over which closing the last gap of a blink fades out.
CLOSE_REACH_MM = 8.0


@dataclass(frozen=True)
class Lids:
    """Which vertices follow the lids of the right eye, and how much.

    Attributes:
        vertices: (k,) vertices that move.
        upper: (k,) share of the upper lid's movement in [0, 1].
        lower: (k,) share of the lower lid's.
        skin: (k,) True where the vertex is skin in front of the ball.
        upper_rim: Rim vertices from the outer to the inner corner, over the upper lid.
        lower_rim: The same over the lower lid.
        inner_edge: The closed loop of the lids' edge towards the ball.
        around: All skin around the opening that must stay before the ball.
        rim_mm: Its distance from the rim.
        seam: Closes the rims at the end of a blink.
    """

    vertices: np.ndarray
    upper: np.ndarray
    lower: np.ndarray
    skin: np.ndarray
    upper_rim: np.ndarray
    lower_rim: np.ndarray
    inner_edge: np.ndarray
    around: np.ndarray
    rim_mm: np.ndarray
    seam: Seam


def right_lids(head: Head, surface: Surface, center: np.ndarray) -> Lids:
    """Return the lids of the right eye of the head whose surface is given."""
    loops = Loops(head)
    rim = loops.along(*RIM_START, LOOP_LENGTH)
    inner_edge = np.array(loops.along(*INNER_EDGE_START, LOOP_LENGTH))
    outer, inner = rim.index(OUTER_CORNER), rim.index(INNER_CORNER)
    lower_rim = np.array(rim[outer : inner + 1])
    upper_rim = np.array([*rim[inner:], *rim[: outer + 1]])[::-1]
    seam = lid_seam(upper_rim, lower_rim, surface, center)
    to_rim = surface.distance(rim)
    inside = surface.distance(inner_edge) < to_rim
    around = np.flatnonzero(~inside & (to_rim < AROUND_MM))
    reach = np.where(seam.is_upper, UPPER_REACH_MM, LOWER_REACH_MM)
    share = 1 - smooth_step(to_rim / np.where(inside, INSIDE_REACH_MM, reach))
    vertices = np.flatnonzero(share > 0)
    is_upper, share = seam.is_upper[vertices], share[vertices]
    lashes = [head.group["helper-r-eyelashes-1"], head.group["helper-r-eyelashes-2"]]
    ones, zeros = ([np.full(len(group), x) for group in lashes] for x in (1.0, 0.0))
    return Lids(
        vertices=np.concatenate([vertices, *lashes]),
        upper=np.concatenate([np.where(is_upper, share, 0), zeros[0], ones[1]]),
        lower=np.concatenate([np.where(is_upper, 0, share), ones[0], zeros[1]]),
        skin=np.concatenate([~inside[vertices], zeros[0] > 0, zeros[1] > 0]),
        upper_rim=upper_rim,
        lower_rim=lower_rim,
        inner_edge=inner_edge,
        around=around,
        rim_mm=to_rim[around],
        seam=seam,
    )


def lid_seam(
    upper_rim: np.ndarray, lower_rim: np.ndarray, surface: Surface, center: np.ndarray
) -> Seam:
    """Return what closes the last gap between the rims."""
    longitude = polar(surface.points, center)[0]
    outer, inner = longitude[[OUTER_CORNER, INNER_CORNER]]
    # The rims bend round at the corners, so they must be closed up to the very ends.
    place = 0.97 * (2 * (longitude - outer) / (inner - outer) - 1)
    corners = np.array([OUTER_CORNER, INNER_CORNER])
    edges = Edges(upper_rim[1:-1], lower_rim[1:-1], corners, place, 0.03)
    return Seam(edges, surface, CLOSE_REACH_MM)


def polar(points: np.ndarray, center: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return longitude, latitude (down positive) in rad and radius in mm around an eye."""
    x, y, z = np.moveaxis(points - center, -1, 0)
    flat = np.hypot(x, z)
    return np.arctan2(x, -z), np.arctan2(y, flat), np.hypot(flat, y)


def from_polar(
    center: np.ndarray, longitude: np.ndarray, latitude: np.ndarray, radius: np.ndarray
) -> np.ndarray:
    """Return the points (k, 3) of longitude, latitude and radius around an eye."""
    flat = np.cos(latitude)
    direction = [np.sin(longitude) * flat, np.sin(latitude), -np.cos(longitude) * flat]
    return center + radius[:, None] * np.stack(direction, axis=-1)


def along_rim(rim: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return a rim's latitude and radius (2, k) at longitudes, from its (3, m) polar form."""
    order = np.argsort(rim[0])
    return np.stack([np.interp(at, rim[0][order], rim[i][order]) for i in (1, 2)])


@dataclass(frozen=True)
class LidMove:
    """How far lids move: shares of the opening, and how much skin settles on the ball.

    Attributes:
        upper: Share of the opening that the upper lid goes down; negative goes up.
        lower: Share that the lower lid goes up.
        settle: Share of the way from its fold to the lid's thickness that moving skin goes.
        lift_mm: Extra radius of the moving skin.
        overlap_mm: How far the closed upper rim reaches below the lower one; None leaves the
            rims apart.
    """

    upper: float
    lower: float
    settle: float = 0.0
    lift_mm: float = 0.0
    overlap_mm: float | None = None


def move_lids(lids: Lids, points: np.ndarray, center: np.ndarray, move: LidMove) -> np.ndarray:
    """Return the displacement (V, 3) of moving the right eye's lids on a head (V, 3)."""
    longitude, latitude, radius = polar(points[lids.vertices], center)
    upper_rim = np.stack(polar(points[lids.upper_rim], center))
    lower_rim = np.stack(polar(points[lids.lower_rim], center))
    upper, thickness = along_rim(upper_rim, longitude)
    opening = np.maximum(along_rim(lower_rim, longitude)[0] - upper, 0)
    middle = opening / max(opening.max(), 1e-6)
    turn = lids.upper * move.upper * opening - lids.lower * move.lower * opening
    moved = np.abs(lids.upper * move.upper) * middle
    settled = radius + move.settle * moved * np.where(lids.skin, thickness - radius, 0.0)
    settled += move.lift_mm * moved * lids.skin
    out = points.copy()
    out[lids.vertices] = from_polar(center, longitude, latitude + turn, settled)
    if move.overlap_mm is not None:
        out = lids.seam.close(out, move.overlap_mm, ahead_mm=0.15, upper_share=0.0)
    return np.asarray(out - points)
