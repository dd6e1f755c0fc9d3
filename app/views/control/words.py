"""Names of coefficients for people, and the parts of the face they belong to."""

import re

from core.arkit import EXPRESSION_NAMES
from core.records import FloatArray

#: Parts of the face by how the names of their coefficients begin.
PARTS: dict[str, tuple[str, ...]] = {
    "Whole face": ("",),
    "Eyes": ("eye",),
    "Brows": ("brow",),
    "Cheeks and nose": ("cheek", "nose"),
    "Jaw": ("jaw",),
    "Mouth": ("mouth",),
}


def plain_name(name: str) -> str:
    """Return a coefficient's name as words: "mouthSmileLeft" is "Mouth smile left"."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower()
    return words[:1].upper() + words[1:]


def short_name(name: str) -> str:
    """Return a coefficient's name for a narrow column: "mouthSmileLeft" is "Mouth smile L"."""
    return re.sub(r" (left|right)$", lambda side: " " + side[1][0].upper(), plain_name(name))


def told_weights(weights: tuple[float, ...] | FloatArray, most: int = 6) -> str:
    """Return the strongest coefficients of a face as a text."""
    shown = sorted(
        ((float(w), name) for w, name in zip(weights, EXPRESSION_NAMES, strict=True) if w >= 0.05),
        reverse=True,
    )
    told = [f"{plain_name(name).lower()} {100 * weight:.0f} %" for weight, name in shown[:most]]
    more = len(shown) - most
    if more > 0:
        told.append(f"{more} more")
    return ", ".join(told) or "nothing"
