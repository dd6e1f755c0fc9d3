"""Size against distance: what one camera hardly shows, but the user's setup knows.

A face that is one percent larger and one percent further away gives the same picture. The
regressor therefore leaves some of an error in depth, once the projections fit, and the shape it
returns is a little too large or too small. Multiplying all its points by one factor slides them
along their lines of sight: the projections stay, and the factor that gives the shape the size of
the user's head puts it at the right distance. [Cao13] leaves this out.
"""

import numpy as np

from core.geometry import register_rigid
from core.records import FloatArray


def size_gauge(shapes_mm: FloatArray, mean_mm: FloatArray, noise_mm: float = 1.0) -> FloatArray:
    """Return weights (Q, 3) whose product with any shape of the user is 1, at its true size.

    Of all weights that give 1 on the mean shape they are those whose product varies least over
    the user's shapes and over noise of the points, so an open mouth is not taken for a larger
    head.

    Args:
        shapes_mm: (N, Q, 3) shapes of the user.
        mean_mm: (Q, 3) their mean, around its centroid.
        noise_mm: Standard deviation of the noise of one coordinate.
    """
    centred = shapes_mm - shapes_mm.mean(axis=1, keepdims=True)
    turned = [shape @ register_rigid(shape, mean_mm)[0].T for shape in centred]
    varied = (np.array(turned) - mean_mm).reshape(len(turned), -1)
    covariance = varied.T @ varied / len(turned) + noise_mm**2 * np.eye(mean_mm.size)
    weights = np.linalg.solve(covariance, mean_mm.ravel())
    return np.asarray(weights.reshape(mean_mm.shape) / (weights @ mean_mm.ravel()))
