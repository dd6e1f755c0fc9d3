"""The lamps and windows that the performer sits in front of."""

import numpy as np

from app.render.scene import Lights


def _lights(
    directions: list[list[float]], colors: list[list[float]], above: float, below: float
) -> Lights:
    tint_above, tint_below = np.array([0.95, 0.98, 1.05]), np.array([1.08, 0.98, 0.9])
    return Lights(
        np.array(directions), np.array(colors), above * tint_above, below * tint_below
    )  # fmt: skip


#: By name; the first is the default. Directions point from the face to the light, camera frame.
LIGHTS: dict[str, Lights] = {
    "window": _lights(
        [[-0.75, -0.45, -0.65], [0.7, -0.2, -0.7], [0.5, -0.6, 0.7]],
        [[1.05, 1.05, 1.08], [0.34, 0.32, 0.28], [0.25, 0.25, 0.27]], 0.42, 0.24,
    ),
    "ceiling": _lights(
        [[0.1, -0.9, -0.55], [-0.3, -0.3, -0.9], [-0.6, -0.5, 0.6]],
        [[1.0, 0.94, 0.84], [0.42, 0.43, 0.45], [0.3, 0.28, 0.26]], 0.45, 0.3,
    ),
    "lamp_left": _lights(
        [[0.97, -0.2, -0.25], [-0.5, -0.3, -0.8], [-0.6, -0.5, 0.6]],
        [[1.6, 1.35, 1.05], [0.16, 0.18, 0.22], [0.1, 0.1, 0.12]], 0.22, 0.14,
    ),
    "lamp_right": _lights(
        [[-0.97, -0.2, -0.25], [0.5, -0.3, -0.8], [0.6, -0.5, 0.6]],
        [[1.6, 1.35, 1.05], [0.16, 0.18, 0.22], [0.1, 0.1, 0.12]], 0.22, 0.14,
    ),
}  # fmt: skip
