"""Paints teeth, gums and tongue into their common square."""

import numpy as np
from scipy.spatial import cKDTree

from assets.build.textures_canvas import fill_triangle, lattice_noise
from core.face_model import FaceModel

#: Widths in mm from the middle of an arch outwards: incisors, canine, premolars, molars.
UPPER_MM = (8.6, 6.8, 7.6, 7.0, 6.8, 9.5, 9.0)
LOWER_MM = (5.6, 6.0, 6.9, 7.0, 7.0, 10.0, 10.0)
CROWN_MM = (9.2, 8.2, 9.4, 8.2, 7.6, 6.8, 6.4)
#: How much y changes with z along the line where the arches meet.
BITE_SLOPE = -0.125
TOOTH = np.float32([0.66, 0.61, 0.50])
GUM = np.float32([0.44, 0.17, 0.155])
TONGUE = np.float32([0.46, 0.19, 0.18])


def mouth_texture(model: FaceModel, size_px: int, rng: np.random.Generator) -> np.ndarray:
    """Return the texture (S, S, 3) in [0, 1] of teeth and tongue, gamma 2."""
    linear = np.zeros((size_px, size_px, 3), np.float32)
    linear[:] = GUM
    points, inside = rastered(model, "tongue", size_px)
    rough = lattice_noise(points, 1.3, rng) * 0.10 + lattice_noise(points, 5.0, rng) * 0.08
    furrow = np.exp(-((points[..., 0] / 1.6) ** 2)) * 0.22
    linear[inside] = (TONGUE * (1 + rough - furrow)[..., None])[inside]
    points, inside = rastered(model, "teeth", size_px)
    linear[inside] = teeth(points, model, rng)[inside]
    return np.sqrt(np.clip(linear, 0, 1))


def rastered(model: FaceModel, part: str, size_px: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean head's place of every pixel of a part, and where the part is."""
    points = np.zeros((size_px, size_px, 3), np.float32)
    inside = np.zeros((size_px, size_px), bool)
    for number in model.part_triangles(part):
        corner = model.uv[number].astype(float) * size_px - 0.5
        # A little larger, so that nothing else bleeds in at the border.
        corner = corner.mean(axis=0) + 1.03 * (corner - corner.mean(axis=0))
        fill_triangle(points, inside, corner, model.mean_mm[model.triangles[number]])
    return points, inside


def teeth(points: np.ndarray, model: FaceModel, rng: np.random.Generator) -> np.ndarray:
    """Return linear colours (S, S, 3) at places on the arches."""
    vertices = np.unique(model.triangles[model.part_triangles("teeth")])
    places = model.mean_mm[vertices].astype(float)
    bite = biting_height(places)
    arc, outline = arch(places, bite)
    along = arc[cKDTree(outline).query(points[..., [0, 2]])[1]]
    upper, front = rastered_upper(points), places[:, 2].min()
    out = np.zeros((*points.shape[:2], 3), np.float32)
    for above, widths in ((True, UPPER_MM), (False, LOWER_MM)):
        mine = upper == above
        # The arches meet higher up at the molars.
        depth = np.abs(points[..., 1] - bite - BITE_SLOPE * (points[..., 2] - front))
        out[mine] = arch_colors(np.abs(along), depth, widths)[mine]
    shade = 1 + 0.03 * lattice_noise(points, 2.5, rng)
    return out * shade[..., None]


def biting_height(places: np.ndarray) -> float:
    """Return the y at which the arches meet at the front."""
    front = places[places[:, 2] < places[:, 2].min() + 2.5]
    return float(np.median(front[:, 1]))


def rastered_upper(points: np.ndarray) -> np.ndarray:
    """Return where a pixel belongs to the upper arch: its half of the square.

    In the teeth's square the lower arch lies above the upper one.
    """
    rows = np.arange(points.shape[0])[:, None] / points.shape[0]
    return np.broadcast_to(rows > 0.736, points.shape[:2])


def arch(places: np.ndarray, bite: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the length along the arch from its middle, and its outline (n, 2) in x and z."""
    edge = places[np.abs(places[:, 1] - bite) < 6.5]
    edge = edge[np.argsort(edge[:, 0])]
    angle = np.arctan2(edge[:, 0], 25 - edge[:, 2])
    bins = np.linspace(-1.65, 1.65, 41)
    radius = np.hypot(edge[:, 0], 25 - edge[:, 2])
    far = [radius[np.abs(angle - b) < 0.16].max(initial=0) for b in bins]
    good = np.array(far) > 5
    bins, far = bins[good], np.array(far)[good]
    fine = np.linspace(bins[0], bins[-1], 800)
    reach = np.interp(fine, bins, far)
    outline = np.column_stack([reach * np.sin(fine), 25 - reach * np.cos(fine)])
    steps = np.linalg.norm(np.diff(outline, axis=0), axis=1)
    length = np.concatenate([[0], steps.cumsum()])
    return length - np.interp(0, fine, length), outline


def arch_colors(along: np.ndarray, depth: np.ndarray, widths: tuple[float, ...]) -> np.ndarray:
    """Return linear colours by the way along an arch and the way from the biting edge, in mm."""
    ends = np.concatenate([[0], np.cumsum(widths), [200.0]])
    tooth = np.clip(np.searchsorted(ends, along, side="right") - 1, 0, len(widths))
    width = np.append(widths, 60.0)[tooth]
    part = (along - ends[tooth]) / width  # 0..1 across the tooth
    beside = np.minimum(part, 1 - part) * width  # mm from the gap
    crown = np.append(CROWN_MM, 3.0)[tooth] - 1.9 * (2 * np.abs(part - 0.5)) ** 3
    gum = np.clip((depth - crown) / 0.7 + 0.5, 0, 1)
    # Corners of the biting edge are round: dark gaps widen there.
    gap = np.exp(-((beside / (0.28 + 0.5 * np.exp(-depth / 0.9))) ** 2))
    yellow = np.clip(depth / 10, 0, 1)[..., None] * np.float32([0.02, 0.05, 0.10])
    edge = np.exp(-depth / 1.0)[..., None] * np.float32([0.10, 0.07, 0.02])
    canine = 0.06 * (tooth == 2)[..., None] * np.float32([0.5, 0.8, 1.3])
    color = (TOOTH - yellow - edge) * (1 - canine)
    round_sides = 1 - 0.30 * (2 * np.abs(part - 0.5)) ** 4
    color = color * round_sides[..., None] * (1 - 0.86 * gap)[..., None]
    papilla = np.exp(-((beside / 1.6) ** 2))
    gums = GUM * (1.05 - 0.15 * papilla)[..., None]
    return np.asarray(color + gum[..., None] * (gums - color), np.float32)
