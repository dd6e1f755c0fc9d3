"""The parts of a face, each by itself: which points say what, how sure each is."""

import numpy as np

from core.landmark_confidence import OUTLINE
from core.landmarks import N_INTERNAL, N_LANDMARKS, REGION_LANDMARKS, REGION_NAMES
from core.records import F32, I32, FloatArray

N_REGIONS = len(REGION_NAMES)
_OUTLINE = REGION_NAMES.index("outline")


def _region_of_shape_point() -> I32:
    """Return (77,) the region of each point of a shape; skin between the features is outline."""
    regions = np.full(N_LANDMARKS + 2, _OUTLINE, np.int32)
    for region, members in enumerate(REGION_LANDMARKS):
        if region != _OUTLINE:
            regions[list(members)] = region
    regions[N_LANDMARKS:] = REGION_NAMES.index("eye_right"), REGION_NAMES.index("eye_left")
    regions.setflags(write=False)
    return regions


SHAPE_REGIONS: I32 = _region_of_shape_point()
#: (60,) the region of each internal landmark.
INTERNAL_REGIONS: I32 = SHAPE_REGIONS[:N_INTERNAL]
_AVERAGE = np.stack(
    [np.isin(np.arange(N_LANDMARKS), members) / len(members) for members in REGION_LANDMARKS]
)


def region_means(values: FloatArray) -> FloatArray:
    """Return the mean over each region (6,) of numbers that belong to the landmarks (75,)."""
    return np.asarray(_AVERAGE @ values)


def region_confidence(confidence: FloatArray) -> FloatArray:
    """Return the confidence in each region (6,) of an aligner's landmarks (75,).

    The outline is never more sure than OUTLINE, which stands for 1.
    """
    regions = region_means(confidence)
    regions[_OUTLINE] = min(regions[_OUTLINE] / OUTLINE, 1.0)
    return regions


def region_shares(corners: I32, weights: F32) -> F32:
    """Return the share (6, P) that each point has in each region's mean, rows of sum 1 or 0.

    Args:
        corners: (P, 3) shape points that carry each point.
        weights: (P, 3) barycentric coordinates: a point belongs to its nearest corner.
    """
    nearest = corners[np.arange(len(corners)), weights.argmax(axis=1)]
    shares = SHAPE_REGIONS[nearest] == np.arange(N_REGIONS)[:, None]
    parts = shares / np.maximum(shares.sum(axis=1, keepdims=True), 1)
    return np.asarray(parts, np.float32)
