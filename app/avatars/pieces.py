"""Pieces that drawn characters wear: tapered clumps of hair and fur, ears, noses."""

from dataclasses import dataclass

import numpy as np

from core.records import F32, I32, FloatArray

#: Middle of the skull of the mean head, from which places on it are named.
SKULL_MM = np.array([0.0, -20.0, 80.0])


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A mesh.

    Attributes:
        points_mm: (n, 3).
        triangles: (T, 3) counter-clockwise seen from outside.
        uv: (T, 3, 2) of the corners.
    """

    points_mm: FloatArray
    triangles: I32
    uv: F32


@dataclass(frozen=True, slots=True)
class Clump:
    """A lock that lies along the head.

    Attributes:
        places: Root, middle and tip on the head as longitude and latitude in degrees, seen from
            the middle of the skull (0, 0 ahead; to the subject's left and up positive), and
            height above the skin in mm.
        width_mm: At its widest.
        thick: Thickness as a share of the width.
    """

    places: tuple[tuple[float, float, float], ...]
    width_mm: float
    thick: float = 0.45


def on_head(places: FloatArray, skin_mm: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return points (n, 3) over the head, and the directions outwards there.

    Args:
        places: (n, 3) longitude and latitude in degrees, height in mm; see `Clump`.
        skin_mm: (V, 3) vertices of the skin.
    """
    longitude, latitude = np.deg2rad(places[:, 0]), np.deg2rad(places[:, 1])
    flat = np.cos(latitude)
    out = np.stack([np.sin(longitude) * flat, -np.sin(latitude), -np.cos(longitude) * flat], axis=1)
    rays = skin_mm - SKULL_MM
    reach = np.linalg.norm(rays, axis=1)
    closeness = out @ (rays / reach[:, None]).T
    # The mean of what is near is smoother than the skin itself.
    weight = np.exp((closeness - 1) / 0.004)
    radius = (weight @ reach) / weight.sum(axis=1)
    return SKULL_MM + (radius + places[:, 2])[:, None] * out, out


def clump(shape: Clump, skin_mm: FloatArray, rings: int = 8, sectors: int = 6) -> Piece:
    """Return a clump over the skin (V, 3) of a head."""
    t = np.linspace(0, 1, rings)
    root, middle, tip = np.array(shape.places, float)
    places = (1 - t)[:, None] ** 2 * root + (2 * t * (1 - t))[:, None] * middle
    spine, out = on_head(places + (t**2)[:, None] * tip, skin_mm)
    along = np.gradient(spine, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(along, out)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(side, along)
    radius = 0.5 * shape.width_mm * (0.55 + 1.6 * t) ** 0.8 * np.sqrt(np.maximum(1 - t**1.6, 0))
    turn = np.arange(sectors) * 2 * np.pi / sectors
    ring = np.cos(turn)[None, :, None] * side[:, None]
    ring = ring + shape.thick * np.sin(turn)[None, :, None] * up[:, None]
    points = spine[:, None] + radius[:, None, None] * ring
    return _tube(points.reshape(-1, 3), rings, sectors)


def ear(base_mm: FloatArray, tip_mm: FloatArray, width_mm: float, cup_mm: float) -> Piece:
    """Return a pointed ear of two leaves: u below 0.5 its back, above its inside.

    Args:
        base_mm: (3,) middle of its foot.
        tip_mm: (3,).
        width_mm: Of its foot.
        cup_mm: How far its edges stand before its middle.
    """
    rows, columns = 9, 9
    t, s = np.meshgrid(np.linspace(0, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    up = tip_mm - base_mm
    # It opens ahead and a little to its own side.
    ahead = np.array([0.35 * np.sign(base_mm[0]), 0.0, -1.0])
    ahead -= up * (ahead @ up) / (up @ up)
    ahead /= np.linalg.norm(ahead)
    side = np.cross(up, ahead)
    side /= np.linalg.norm(side)
    width = 0.5 * width_mm * (1 - t) ** 0.85 * (0.72 + 1.5 * t)
    forward = cup_mm * (s**2 - 0.6) * (1 - t) - 7.0 * np.sin(np.pi * t) * (1 - s**2)
    leaf = base_mm + t[..., None] * up + (s * width)[..., None] * side
    leaf = leaf + forward[..., None] * ahead
    inner = leaf + (1.6 + 2.2 * (1 - s**2) * (1 - t))[..., None] * ahead * 0.8
    inner = base_mm + 0.02 * up + 0.94 * (inner - base_mm)
    uv = np.stack([0.25 + 0.24 * s, 1 - t], axis=-1)
    back = _grid(rows, columns)
    count = rows * columns
    triangles = np.concatenate([back, back[:, ::-1] + count])
    corner = np.concatenate([uv.reshape(-1, 2), uv.reshape(-1, 2) + [0.5, 0]])
    points = np.concatenate([leaf.reshape(-1, 3), inner.reshape(-1, 3)])
    return Piece(points, triangles.astype(np.int32), corner[triangles].astype(np.float32))


def ball(center_mm: FloatArray, radii_mm: FloatArray, taper: float = 0.0) -> Piece:
    """Return an ellipsoid, narrower below by a taper in [0, 1)."""
    rings, sectors = 9, 14
    latitude = np.linspace(-0.5 * np.pi, 0.5 * np.pi, rings)
    turn = np.arange(sectors) * 2 * np.pi / sectors
    flat = np.cos(latitude)[:, None]
    x, z = flat * np.sin(turn), -flat * np.cos(turn)
    y = np.repeat(np.sin(latitude)[:, None], sectors, axis=1)
    narrow = 1 - taper * (0.5 + 0.5 * y)
    points = np.stack([x * narrow, y, z * narrow], axis=-1).reshape(-1, 3) * radii_mm + center_mm
    return _tube(points, rings, sectors)


def joined(pieces: list[Piece]) -> Piece:
    """Return several pieces as one."""
    starts = np.cumsum([0] + [len(piece.points_mm) for piece in pieces[:-1]])
    return Piece(
        np.concatenate([piece.points_mm for piece in pieces]),
        np.concatenate([p.triangles + s for p, s in zip(pieces, starts, strict=True)]).astype(
            np.int32
        ),
        np.concatenate([piece.uv for piece in pieces]),
    )


def mirrored(piece: Piece) -> Piece:
    """Return the piece on the other side of the head."""
    return Piece(piece.points_mm * [-1, 1, 1], piece.triangles[:, ::-1].copy(),
                 piece.uv[:, ::-1].copy())  # fmt: skip


def _tube(points: FloatArray, rings: int, sectors: int) -> Piece:
    """Return rings of points, one after the other, as a closed surface."""
    now = np.arange(sectors)
    after = (now + 1) % sectors
    bands, uv = [], []
    for ring in range(rings - 1):
        a, b = ring * sectors + now, ring * sectors + after
        c, d = a + sectors, b + sectors
        bands += [np.stack([a, c, b], 1), np.stack([b, c, d], 1)]
        u, w = now / sectors, (now + 1) / sectors
        v, under = np.full(sectors, ring / (rings - 1)), np.full(sectors, (ring + 1) / (rings - 1))
        uv += [
            np.stack([np.stack(pair, 1) for pair in ((u, v), (u, under), (w, v))], axis=1),
            np.stack([np.stack(pair, 1) for pair in ((w, v), (u, under), (w, under))], axis=1),
        ]
    return Piece(
        points, np.concatenate(bands).astype(np.int32), np.concatenate(uv).astype(np.float32)
    )


def _grid(rows: int, columns: int) -> I32:
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (row * columns + column).reshape(-1)
    b, c, d = a + 1, a + columns + 1, a + columns
    return np.concatenate([np.stack([a, c, b], 1), np.stack([a, d, c], 1)]).astype(np.int32)
