"""Vertices of eyes and mouth in the face model, for the tests of its quality."""

from collections import defaultdict

import numpy as np

from core.face_model import FaceModel

#: Rims of the right eye's lids from the outer to the inner corner, and the lids' inner edge.
UPPER_RIM = [21, 18, 15, 12, 9, 6, 0, 1, 54, 57, 60, 102, 63, 66]
LOWER_RIM = [21, 24, 27, 1421, 30, 33, 36, 41, 44, 47, 50, 1423, 53, 72, 69, 66]
INNER_EDGE = [
    2115, 2120, 2119, 2118, 2117, 2116, 2139, 2138, 2137, 2141, 2128, 2136, 2135, 2134, 2132,
    2130, 2129, 2140, 2124, 2123, 2122, 2127, 2125, 2126, 2131, 2133, 2121, 2114,
]  # fmt: skip
#: The lips where they touch: (upper, lower) vertices of rings from the red to inside the mouth.
LIP_RINGS = (
    ([2548, 2534, 2535, 2567, 3736, 2571, 2576, 2579, 2582, 468, 465, 462, 459, 453, 1696, 449,
      417, 416, 430],
     [428, 429, 1295, 443, 438, 476, 482, 488, 494, 2601, 2595, 2589, 2556, 2561, 3352, 2547,
      2546]),
    ([2551, 2536, 2537, 2583, 3745, 2584, 2585, 2586, 2587, 474, 473, 472, 471, 470, 1705, 469,
      419, 418, 433],
     [431, 432, 1296, 444, 437, 475, 481, 487, 493, 2600, 2594, 2588, 2555, 2562, 3353, 2550,
      2549]),
    ([2554, 2538, 2539, 2621, 3743, 2620, 2619, 2626, 2625, 520, 521, 522, 514, 515, 1703, 516,
      421, 420, 436],
     [434, 435, 1297, 445, 446, 519, 518, 517, 523, 2622, 2623, 2624, 2564, 2563, 3354, 2553,
      2552]),
    ([2631, 2627, 2628, 2636, 3742, 2635, 2634, 2641, 2640, 537, 538, 539, 531, 532, 1702, 533,
      525, 524, 528],
     [526, 527, 1298, 529, 530, 536, 535, 534, 540, 2637, 2638, 2639, 2633, 2632, 3355, 2630,
      2629]),
)  # fmt: skip
CORNER_RIGHT, CORNER_LEFT = 1320, 3377
UPPER_LIP_MIDDLE, LOWER_LIP_MIDDLE, CHIN = 520, 523, 1505
UPPER_LIP_BORDER, LOWER_LIP_BORDER = 455, 492


def lid_skin(model: FaceModel, rings: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices of the lids' skin in front of the ball and its triangles."""
    near = defaultdict(set)
    for quad in model.quads[model.part[::2] == 0].tolist():
        for k in range(4):
            near[quad[k]] |= {quad[k - 1], quad[(k + 1) % 4]}
    skin, edge = {*UPPER_RIM, *LOWER_RIM}, set(INNER_EDGE)
    for _ in range(rings):
        skin |= {v for here in skin for v in near[here]} - edge
    triangles = model.triangles[np.isin(model.triangles, list(skin)).all(axis=1)]
    return np.array(sorted(skin)), triangles


def lid_gap_mm(points: np.ndarray, center: np.ndarray) -> np.ndarray:
    """Return how far the right eye's lower rim is below the upper one, along the opening."""
    rims = []
    for rim in (UPPER_RIM, LOWER_RIM):
        x, y, z = (points[rim] - center).T
        longitude, latitude = np.arctan2(x, -z), np.arctan2(y, np.hypot(x, z))
        order = np.argsort(longitude)
        rims.append((longitude[order], latitude[order]))
    (upper_at, upper), (lower_at, lower) = rims
    start = max(upper_at[0], lower_at[0]) + 0.05
    at = np.linspace(start, min(upper_at[-1], lower_at[-1]) - 0.05, 41)
    opening = np.interp(at, lower_at, lower) - np.interp(at, upper_at, upper)
    return opening * np.linalg.norm(points[UPPER_RIM] - center, axis=1).mean()


def ball_clearance_mm(
    points: np.ndarray, triangles: np.ndarray, center: np.ndarray, radius: float
) -> float:
    """Return the least distance of the lids' triangles from the eyeball, below 0 inside."""
    corners = points[triangles] - center
    middles = (corners + np.roll(corners, 1, axis=1)) / 2
    samples = np.concatenate([corners, middles, corners.mean(axis=1, keepdims=True)], axis=1)
    samples = samples.reshape(-1, 3)
    return float(np.linalg.norm(samples[samples[:, 2] < 0], axis=1).min() - radius)


def lip_gap_mm(points: np.ndarray) -> np.ndarray:
    """Return the height of the free opening between the lips at places along the mouth.

    The lowest part of the upper lip against the highest of the lower: below 0 nothing can be
    seen between them.
    """
    ends = points[[CORNER_RIGHT, CORNER_LEFT], 0]
    at = ends[0] + np.linspace(0.1, 0.9, 33) * (ends[1] - ends[0])
    heights = []
    for lip in (0, 1):
        rings = []
        for ring in LIP_RINGS:
            x, y = points[ring[lip], :2].T
            order = np.argsort(x)
            rings.append(np.interp(at, x[order], y[order]))
        heights.append(np.array(rings))
    return heights[1].min(axis=0) - heights[0].max(axis=0)
