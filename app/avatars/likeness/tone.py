"""Parts the colour of skin from the colour and the strength of the light on it."""

import numpy as np

from app.avatars.looks import LOOKS, linear
from core.records import FloatArray

#: Usual error, as logarithms, of what pictures say about the light's strength and colour if it is
#: taken for white and usual; and if it is taken from the white of the eyes.
_LEVEL, _TINT = 0.45, 0.25
_EYES_LEVEL, _EYES_TINT = 0.35, 0.2
#: Albedo of the white of the eyes, shaded by the lids.
_WHITE = 0.6 * np.array([0.69, 0.64, 0.61])
#: Share of the error found that is taken off.
_OFF = 0.8


def light_of_skin(skin: FloatArray, white: FloatArray | None) -> FloatArray:
    """Return by what (3,) an albedo of skin is too bright or too coloured.

    Skin of all people has nearly one series of colours, from pale to dark; the white of the eyes
    is nearly alike in all. The likeliest tone is the one that asks for the least unusual light.

    Args:
        skin: (3,) albedo of the skin if the pictures' light were white and of the usual strength.
        white: (3,) the same of the white of the eyes, None where it was not seen.
    """
    off = np.log(np.maximum(skin, 1e-3)) - np.log(_series())
    cost = _cost(off, _LEVEL, _TINT)
    if white is not None:
        told = np.log(np.maximum(white, 1e-3) / _WHITE)
        cost = cost + _cost(off - told, _EYES_LEVEL, _EYES_TINT)
    return np.asarray(np.exp(_OFF * off[int(cost.argmin())]))


def _cost(off: FloatArray, level: float, tint: float) -> FloatArray:
    """Return how unusual logarithms of light (n, 3) are."""
    mean = off.mean(axis=1, keepdims=True)
    return np.asarray((mean[:, 0] / level) ** 2 + np.sum(((off - mean) / tint) ** 2, axis=1))


def _series() -> FloatArray:
    """Return the albedo (n, 3) of skins from pale to dark."""
    names = ("porcelain", "light", "olive", "brown", "deep")
    tones = np.array([np.log(linear(LOOKS[name].skin)) for name in names])
    at = np.linspace(0, len(names) - 1, 81)
    columns = [np.interp(at, range(len(names)), tones[:, c]) for c in range(3)]
    return np.asarray(np.exp(np.stack(columns, axis=1)))
