"""How far each landmark of the generic aligner can be trusted.

The network answers for every point, seen or not. What it cannot see it guesses from the rest of
the face; a fit must not take such guesses for measurements.
"""

from dataclasses import dataclass

import numpy as np

from core.landmarks import GROUPS, MESH478, N_INTERNAL, PUPILS478
from core.mean_face import MeanFace, barycentric, smooth_normals
from core.outline import Lines
from core.records import I32, BoolArray, FloatArray, freeze

#: Cosine between the skin's normal and the view below which a point is hidden, and above which
#: it is well seen. The network finds points just behind the edge nearly as well as others.
_FACING = (-0.1, 0.3)
#: Opening of the lids in parts of the eye's width: no iris to be seen, and enough of it. Open
#: eyes have 0.25 to 0.4, closed ones 0.02 to 0.1.
_OPENING = (0.1, 0.2)
#: The outline is no mark on the skin: where along it a landmark lies is a convention.
OUTLINE = 0.6
#: On a head turned by the sine s, what is left of that is 1 - 0.75 s on the near side, where the
#: jaw line fades in the cheek, and falls to nothing between these sines on the far side.
_NEAR_LOSS = 0.75
_FAR_LOSS = (0.7, 0.95)
#: How far the nose must be in front of a point, in parts of the face's height, to hide it hardly
#: and wholly. Its own wings are always a little behind it.
_NOSE_AHEAD = (0.03, 0.08)
_NOSE_REACH_MM = (20.0, 32.0)
_PLACES = np.concatenate([MESH478[:N_INTERNAL], PUPILS478])


@dataclass(frozen=True, slots=True, eq=False)
class Visibility:
    """What is needed to tell which points can be seen.

    Attributes:
        normals: (62, 3) of the internal landmarks and the pupils, in the model frame.
        nose: (T, 3) triangles of the network's surface that hide other points.
        own: (62, T) where a point is a corner of a triangle.
        outward: (15, 3) the way out of the face at the outline landmarks.
    """

    normals: FloatArray
    nose: I32
    own: BoolArray
    outward: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            normals=(np.float64, ("P", 3)),
            nose=(np.int32, ("T", 3)),
            own=(np.bool_, ("P", "T")),
            outward=(np.float64, ("C", 3)),
        )


def visibility(mean: MeanFace, lines: Lines) -> Visibility:
    """Return what the mean face says about its points."""
    normals = smooth_normals(mean)[MESH478[:N_INTERNAL]]
    eyes = [normals[list(GROUPS[name])].mean(axis=0) for name in ("eye_right", "eye_left")]
    across, along = _NOSE_REACH_MM
    offset = np.abs(mean.vertices_mm - mean.vertices_mm[MESH478[GROUPS["nose"][3]]])
    is_nose = (offset[:, 0] < across) & (offset[:, 1] < along)
    nose = mean.triangles[is_nose[mean.triangles].all(axis=1)]
    own = np.any(_PLACES[:, None, None] == nose[None], axis=2)
    return Visibility(np.concatenate([normals, eyes]), nose, own, lines.outward)


def confidences(
    known: Visibility, mesh_px: FloatArray, depth_px: FloatArray, rotation: FloatArray
) -> FloatArray:
    """Return the confidence (77,) in [0, 1] of the landmarks, then the pupils.

    Args:
        known: Of the mean face.
        mesh_px: (478, 2).
        depth_px: (478,) away from the camera.
        rotation: (3, 3) model to camera.
    """
    seen = smooth_step(-(known.normals @ rotation[2]), *_FACING)
    ahead = _nose_ahead(known, np.column_stack([mesh_px, depth_px]))
    seen = seen * (1 - smooth_step(ahead, *_NOSE_AHEAD))
    turned = known.outward @ rotation[2]
    far = 1 - smooth_step(turned, *_FAR_LOSS)
    edge = OUTLINE * np.where(turned > 0, far, 1 + _NEAR_LOSS * np.minimum(turned, 0))
    pupils = seen[N_INTERNAL:] * smooth_step(eye_openings(mesh_px, depth_px), *_OPENING)
    return np.concatenate([seen[:N_INTERNAL], edge, pupils])


def eye_openings(mesh_px: FloatArray, depth_px: FloatArray) -> FloatArray:
    """Return the distance of the lids in parts of the eye's width (2,), right and left."""
    points = np.column_stack([mesh_px, depth_px])
    openings = []
    for name in ("eye_right", "eye_left"):
        outer, _, up, _, inner, _, low, _ = points[MESH478[list(GROUPS[name])]]
        openings.append(np.linalg.norm(up - low) / (np.linalg.norm(outer - inner) + 1e-9))
    return np.array(openings)


def inside(points_px: FloatArray, size_px: tuple[int, int]) -> FloatArray:
    """Return 1.0 for points (..., 2) inside a picture (width, height), 0.0 for others."""
    within = (points_px > -0.5) & (points_px < np.array(size_px) - 0.5)
    return np.where(within.all(axis=-1), 1.0, 0.0)


def smooth_step(values: FloatArray, low: float, high: float) -> FloatArray:
    """Return 0 below low, 1 above high, and a smooth rise between."""
    part = np.clip((values - low) / (high - low), 0.0, 1.0)
    return np.asarray(part * part * (3 - 2 * part))


def _nose_ahead(known: Visibility, points: FloatArray) -> FloatArray:
    """Return how far the nose is in front of the points (62,), in parts of the face's height.

    Zero where it does not cover them; a point is not covered by its own triangles.
    """
    corners, places = points[known.nose], points[_PLACES]
    flat = corners[..., :2]
    near = np.all((places[:, :2] > flat.min((0, 1))) & (places[:, :2] < flat.max((0, 1))), axis=1)
    weights = barycentric(flat[None], places[near, None, :2])
    depth = np.sum(weights * corners[None, :, :, 2], axis=2)
    covers = (weights.min(axis=2) > 0) & ~known.own[near]
    ahead = np.zeros(len(places))
    ahead[near] = np.where(covers, places[near, None, 2] - depth, 0.0).max(axis=1)
    return np.asarray(np.maximum(ahead, 0.0) / np.ptp(points[:, 1]))
