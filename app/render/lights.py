"""The lights to choose from. All keep colours plausible and every tone of skin apart."""

import numpy as np

from app.render.scene import Lights, studio_lights
from core.records import FloatArray


def _lights(
    directions: list[list[float]], colors: list[list[float]], ambient: list[list[float]]
) -> Lights:
    """Return lights from key, fill and rim, and from what comes from above and from below."""
    return Lights(np.array(directions), np.array(colors), *np.array(ambient))


#: By name, in the order of the list that is shown; directions and colours see `Lights`.
LIGHTS: dict[str, Lights] = {
    "studio": studio_lights(),
    # Daylight through a large window on the left of the picture, a pale wall on the right.
    "window": _lights(
        [[-0.95, -0.25, -0.75], [0.9, 0.0, -0.5], [0.6, -0.6, 0.8]],
        [[1.05, 1.08, 1.12], [0.30, 0.29, 0.27], [0.30, 0.31, 0.33]],
        [[0.50, 0.52, 0.56], [0.30, 0.28, 0.26]],
    ),
    # A ring round the lens: flat, bright, with hardly a shadow.
    "ring": _lights(
        [[0.0, -0.12, -1.0], [0.0, 0.45, -0.9], [0.0, -0.7, 0.7]],
        [[1.18, 1.15, 1.12], [0.30, 0.29, 0.29], [0.35, 0.36, 0.40]],
        [[0.36, 0.36, 0.37], [0.34, 0.33, 0.33]],
    ),
    # One lamp from the side; just enough comes back to see the other half of the face.
    "dramatic": _lights(
        [[-1.0, -0.35, -0.20], [0.7, -0.1, -0.8], [0.85, -0.35, 0.75]],
        [[1.95, 1.78, 1.58], [0.10, 0.11, 0.14], [0.75, 0.80, 0.95]],
        [[0.09, 0.10, 0.12], [0.06, 0.06, 0.06]],
    ),
    # Low sun from the side, blue sky above.
    "sunset": _lights(
        [[0.85, -0.22, -0.70], [-0.8, -0.3, -0.7], [-0.75, -0.2, 0.8]],
        [[1.55, 1.10, 0.72], [0.24, 0.29, 0.42], [1.05, 0.62, 0.34]],
        [[0.26, 0.31, 0.42], [0.22, 0.17, 0.14]],
    ),
    # Pink and blue signs at both sides; white enough in front to tell the skin's own colour.
    "neon": _lights(
        [[-0.9, -0.2, -0.55], [0.9, -0.1, -0.55], [0.5, -0.6, 0.85]],
        [[1.25, 0.55, 0.98], [0.38, 0.72, 1.25], [0.85, 0.45, 1.10]],
        [[0.34, 0.33, 0.40], [0.26, 0.24, 0.28]],
    ),
    # Moonlight and the glow of a screen in front.
    "night": _lights(
        [[-0.5, -0.75, -0.6], [0.15, 0.35, -1.0], [0.8, -0.5, 0.75]],
        [[0.46, 0.58, 0.80], [0.34, 0.40, 0.50], [0.55, 0.68, 0.95]],
        [[0.17, 0.20, 0.27], [0.11, 0.12, 0.14]],
    ),
}


def lit(name: str, brightness: float = 1.0, mirrored: bool = False) -> Lights:
    """Return lights of LIGHTS.

    Args:
        name: A key of LIGHTS.
        brightness: Factor on all of them.
        mirrored: For a view that is mirrored: they stay where they are in the picture.
    """
    base = LIGHTS[name]
    side = np.array([-1.0, 1, 1]) if mirrored else np.ones(3)
    return Lights(
        base.directions * side,
        base.colors * brightness,
        base.ambient_above * brightness,
        base.ambient_below * brightness,
    )


def wall_tint(lights: Lights) -> FloatArray:
    """Return the factor (3,) on the displayed colours of a wall in these lights.

    A wall is lit by what comes from all around; displayed values are roots of linear ones.
    """
    base = studio_lights()
    there = lights.ambient_above + lights.ambient_below
    return np.asarray(np.sqrt(there / (base.ambient_above + base.ambient_below)))
