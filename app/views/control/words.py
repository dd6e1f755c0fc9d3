"""Names of coefficients for people, and the parts of the face they belong to."""

import re
from collections.abc import Sequence

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
#: Weaker coefficients are not told.
_TOLD = 0.05


def plain_name(name: str) -> str:
    """Return a coefficient's name as words: "mouthSmileLeft" is "Mouth smile left"."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower()
    return words[:1].upper() + words[1:]


def short_name(name: str) -> str:
    """Return a coefficient's name for a narrow column: "mouthSmileLeft" is "Mouth smile L"."""
    return re.sub(r" (left|right)$", lambda side: " " + side[1][0].upper(), plain_name(name))


def told_weights(weights: Sequence[float] | FloatArray, most: int = 5) -> str:
    """Return the strongest coefficients of a face as a text; equal sides are told as one."""
    values = {name: round(float(w), 2) for name, w in zip(EXPRESSION_NAMES, weights, strict=True)}
    for name in EXPRESSION_NAMES:
        if name.endswith("Left"):
            stem = name.removesuffix("Left")
            if values[name] == values[stem + "Right"]:
                values[stem] = values.pop(name)
                del values[stem + "Right"]
    shown = sorted(
        ((value, name) for name, value in values.items() if value >= _TOLD),
        key=lambda one: (-one[0], one[1]),
    )
    # The sign stays with its number.
    told = [f"{plain_name(n).lower()} {100 * v:.0f}\N{NO-BREAK SPACE}%" for v, n in shown[:most]]
    more = len(shown) - most
    if more > 0:
        told.append(f"{more} more")
    return ", ".join(told) or "nothing"
