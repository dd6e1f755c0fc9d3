"""Which vertices are the face contour in a picture.

The contour is no fixed set of vertices: it slides over the cheeks as the head turns. For each of
15 landmarks the model has a strip of vertices from the front of the face to the back, and the
contour vertex is chosen on it for the current pose [Cao13, 4.1; Yang et al. 2011].
"""

import numpy as np

from core.landmarks import N_INTERNAL
from core.records import I32, FloatArray

#: Where the fixed vertices are looked up: a frontal face at the usual distance.
USUAL_DISTANCE_MM = 600.0
_LIPS = slice(40, 60)
#: A strip seen exactly from the side counts as near, whatever the rounding.
_EDGE_ON = 1e-6


def outward_directions(neutral_mm: FloatArray, strips: I32) -> FloatArray:
    """Return the direction (15, 3) in the model frame that leads out of the face on each strip.

    Sideways above the mouth, and from the mouth outwards below it.

    Args:
        neutral_mm: (P, 3), the internal landmarks first.
        strips: (15, W) points, -1 padded.
    """
    present = (strips >= 0)[..., None]
    middle = np.sum(neutral_mm[strips] * present, axis=1) / present.sum(axis=1)
    mouth = neutral_mm[_LIPS].mean(axis=0)
    outward = middle - mouth
    outward[:, 1] = np.maximum(outward[:, 1], 0.0)
    outward[:, 2] = 0.0
    return np.asarray(outward / np.linalg.norm(outward, axis=1, keepdims=True))


def furthest_points(points_mm: FloatArray, directions: FloatArray, strips: I32) -> I32:
    """Return the point (N, 15) of each strip that lies furthest out in the picture.

    Args:
        points_mm: (N, P, 3) in the camera frame.
        directions: (N, 15, 2) outward in the picture.
        strips: (15, W) points, -1 padded.
    """
    image = points_mm[..., :2] / points_mm[..., 2:]
    along = np.einsum("nswc,nsc->nsw", image[:, strips], directions)
    along = np.where(strips >= 0, along, -np.inf)
    furthest = along.argmax(axis=2)[..., None]
    return np.asarray(np.take_along_axis(strips[None], furthest, axis=2)[..., 0])


def fixed_points(neutral_mm: FloatArray, strips: I32) -> I32:
    """Return the contour points (15,) of a face that looks straight into the camera."""
    frontal = neutral_mm + np.array([0.0, 0.0, USUAL_DISTANCE_MM])
    outward = outward_directions(neutral_mm, strips)[None, :, :2]
    return np.asarray(furthest_points(frontal[None], outward, strips)[0])


def contour_points(
    neutral_mm: FloatArray, posed_mm: FloatArray, rotations: FloatArray, strips: I32
) -> I32:
    """Return the contour point (N, 15) of each strip in each picture.

    On the far side of a turned face that is the point furthest out. The near side shows the jaw
    line well inside the silhouette of the head, and that is what is labelled: there the point is
    the one that is furthest out in the frontal view. Both agree where one turns into the other.

    Args:
        neutral_mm: (P, 3) in the model frame.
        posed_mm: (N, P, 3) in the camera frame.
        rotations: (N, 3, 3) model to camera.
        strips: (15, W) points, -1 padded.
    """
    outward = outward_directions(neutral_mm, strips)
    turned = np.einsum("nij,sj->nsi", rotations, outward)
    middle = posed_mm[:, :N_INTERNAL].mean(axis=1)
    sight = middle / np.linalg.norm(middle, axis=1, keepdims=True)
    near = np.einsum("nsi,ni->ns", turned, sight) < _EDGE_ON
    silhouette = furthest_points(posed_mm, turned[..., :2], strips)
    return np.where(near, fixed_points(neutral_mm, strips), silhouette).astype(np.int32)
