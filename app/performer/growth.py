"""Beards and fringes: hair that conditions add to a person."""

from dataclasses import replace

import cv2
import numpy as np

from app.avatars.build import Head
from app.avatars.hair import strands
from app.avatars.looks import Looks
from app.avatars.wardrobe import Wardrobe
from app.performer.shapes import Solid, grid_triangles
from app.render.avatar import Avatar, part_of
from app.render.scene import Material
from core.face_model import FaceModel
from core.kernels.morph import vertex_normals
from core.records import F32, I32, FloatArray

#: Layers of hair one over the other: height in parts of the beard's, coverage at the top.
_LAYERS = ((0.25, 1.0), (0.5, 0.86), (0.75, 0.74), (1.0, 0.64))
_BEARD_MM, _CHIN_MM = 5.0, 6.0
#: The axis that the fringe hangs around (z), its half angle, rows and columns.
_AXIS_Z_MM, _HALF_DEG, _ROWS, _COLUMNS = 78.0, 58.0, 14, 72
#: Its roots lie so far above the hairline, and its ends so far down from the eyes.
_ROOTED_MM, _END_MM = 14.0, -9.0


def bearded(avatar: Avatar, head: Head, looks: Looks, wardrobe: Wardrobe) -> Avatar:
    """Return the avatar with a full beard that moves with its skin.

    Args:
        avatar: Its first vertices are the face model's.
        head: Of the same person.
        looks: The beard has the colour of the brows.
        wardrobe: Has the map of where beards grow.
    """
    model, neutral = head.model, head.neutral_mm.astype(np.float32)
    where = model.part_triangles("skin")
    grows = _beard_map(wardrobe, model, where)
    triangles = model.triangles[where]
    triangles = triangles[grows[triangles].max(axis=1) > 0.08]
    rows, flat = np.unique(triangles, return_inverse=True)
    normals: F32 = np.empty_like(neutral)
    vertex_normals(neutral, np.ascontiguousarray(model.triangles[where]), normals)
    below = np.clip((neutral[rows, 1] - 70) / 25, 0, 1)
    height = (_BEARD_MM + _CHIN_MM * below) * np.sqrt(np.clip(grows[rows], 0, 1))
    turn = np.arctan2(neutral[rows, 0], 60.0 - neutral[rows, 2])
    uv = np.stack([turn * 2.4, neutral[rows, 1] / 240], axis=1)
    hair = strands(looks.changed(hair=looks.brows), np.random.default_rng(17))
    for share, coverage in _LAYERS:
        points = neutral[rows] + (share * height)[:, None] * normals[rows]
        points[:, 1] += 0.5 * share * height
        extra = wardrobe.extra[rows].copy()
        extra[:, 1] = np.minimum(extra[:, 1], 0.45 + 0.55 * share)
        extra[:, 2] = coverage * np.clip(grows[rows] * 2.2, 0, 1)
        avatar = _grown(
            avatar, points.astype(np.float32), extra, head.deltas_mm[:, rows],
            (hair, flat.reshape(-1, 3).astype(np.int32), (uv + 0.31 * share).astype(np.float32)),
        )  # fmt: skip
    return avatar


def _beard_map(wardrobe: Wardrobe, model: FaceModel, where: I32) -> FloatArray:
    """Return how densely a beard grows at each vertex (V,), from the painted skin."""
    picture = cv2.imread(str(wardrobe.skin_maps / "stubble.jpg"), cv2.IMREAD_GRAYSCALE)
    if picture is None:
        raise FileNotFoundError(f"{wardrobe.skin_maps}/stubble.jpg: install facepuppet again")
    soft = cv2.GaussianBlur(picture, (0, 0), len(picture) / 300).astype(np.float32) / 255
    size = len(soft) - 1
    x, y = np.moveaxis(np.clip(np.rint(model.uv[where] * size), 0, size).astype(int), -1, 0)
    out = np.zeros(len(model.mean_mm))
    np.maximum.at(out, model.triangles[where], soft[y, x])
    return out / max(float(out.max()), 1e-6)


def _grown(
    avatar: Avatar, points_mm: F32, extra: F32, deltas_mm: F32, surface: tuple[Material, I32, F32]
) -> Avatar:
    """Return an avatar with more vertices and one more part.

    Args:
        avatar: What there is.
        points_mm: (n, 3) new vertices.
        extra: (n, 4) of them, see `Mesh`.
        deltas_mm: (46, n, 3) how expressions move them.
        surface: Material, triangles (T, 3) and uv (n, 2) of the new vertices.
    """
    material, triangles, uv = surface
    first, n = len(avatar.neutral_mm), len(points_mm)
    starts, rows, deltas = avatar.delta_starts, [], []
    for b, moved in enumerate(deltas_mm):
        old = slice(starts[b], starts[b + 1])
        moving = np.flatnonzero(np.abs(moved).max(axis=1) > 0.005)
        rows.append(np.concatenate([avatar.delta_rows[old], first + moving]))
        deltas.append(np.concatenate([avatar.deltas_mm[old], moved[moving]]))
    every_extra = np.zeros((first + n, 4), np.float32)
    every_extra[first:] = extra
    part = part_of(material, triangles + np.int32(first), uv[triangles], every_extra)
    return replace(
        avatar,
        neutral_mm=np.concatenate([avatar.neutral_mm, points_mm]),
        delta_starts=np.concatenate([[0], np.cumsum([len(r) for r in rows])]),
        delta_rows=np.concatenate(rows),
        deltas_mm=np.concatenate(deltas),
        triangles=np.concatenate([avatar.triangles, part.rows[part.triangles]]),
        parts=(*avatar.parts, part),
    )


def fringe(head: Head, wardrobe: Wardrobe) -> tuple[Solid, FloatArray]:
    """Return hair that hangs over forehead and brows, and its coverage (n,).

    Args:
        head: Its skin is what the hair lies on.
        wardrobe: Knows where the scalp's hair begins.
    """
    turn = np.deg2rad(np.linspace(-_HALF_DEG, _HALF_DEG, _COLUMNS))
    down = np.linspace(0, 1, _ROWS)[:, None]
    locks = np.sin(17 * turn + 1) + 0.7 * np.sin(41 * turn + 2) + 0.5 * np.sin(67 * turn)
    # Shorter to the temples; every lock ends elsewhere.
    ends = _END_MM - 16 * (np.abs(turn) / turn[-1]) ** 2 + 3.2 * locks
    roots_mm = _roots_mm(head, wardrobe, turn)
    y = roots_mm + down * (ends - roots_mm)
    # The hair is swept a little to one side.
    around = turn + 0.16 * down**1.5
    radius = _radius_mm(head, around, y)
    stands_off = 7.5 + 4.0 * np.sin(np.pi * down) - 3.5 * down + 0.7 * locks * down
    reach = radius + stands_off
    x, z = reach * np.sin(around), _AXIS_Z_MM - reach * np.cos(around)
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    uv = np.stack(np.broadcast_arrays(turn * 2.2, down * 0.35), axis=-1).reshape(-1, 2)
    sides = np.clip((1 - np.abs(turn) / turn[-1]) / 0.12, 0, 1)
    coverage = np.clip((1.02 - down) / 0.3, 0, 1) ** 0.6 * (0.55 + 0.45 * sides)
    # At the roots it comes out of the other hair without an edge.
    coverage = coverage * np.clip(0.7 + down / 0.2, 0, 1) * (0.93 + 0.09 * np.sin(23 * turn))
    triangles = grid_triangles(_ROWS, _COLUMNS)[:, ::-1]
    return Solid(points, triangles, uv), coverage.reshape(-1)


def _roots_mm(head: Head, wardrobe: Wardrobe, turn: FloatArray) -> FloatArray:
    """Return the height y of the roots at each angle, just above the person's hairline."""
    scalp = np.asarray(wardrobe.scalp.mix @ head.neutral_mm)
    rooted = scalp[np.abs(wardrobe.scalp.above_mm - _ROOTED_MM) < 5]
    angle = np.arctan2(rooted[:, 0], _AXIS_Z_MM - rooted[:, 2])
    weight = np.exp(-(((angle[None] - turn[:, None]) / 0.12) ** 2))
    return np.asarray((weight @ rooted[:, 1]) / weight.sum(axis=1))


def _radius_mm(head: Head, turn: FloatArray, y_mm: FloatArray) -> FloatArray:
    """Return how far the head reaches from the fringe's axis at angles and heights (R, C)."""
    rows = np.unique(head.model.triangles[head.model.part_triangles("skin")])
    skin = head.neutral_mm[rows]
    front = skin[(skin[:, 2] < 90) & (skin[:, 1] < 10)]
    angle = np.arctan2(front[:, 0], _AXIS_Z_MM - front[:, 2])
    away = np.hypot(front[:, 0], _AXIS_Z_MM - front[:, 2])
    # Angles in mm on a head of usual size, so that both directions count alike.
    places = np.stack([75 * angle, front[:, 1]], axis=1)
    # Takes half a second to load, which only who films the performer shall wait for.
    from scipy.interpolate import LinearNDInterpolator

    return np.asarray(LinearNDInterpolator(places, away)(75 * turn, y_mm))
