"""Which expressions will be weak for this user, and why.

Three things make one weak: landmarks hardly tell it (geometry of this user's face), the setup
pictures hardly show it (fitted against asked coefficients), or no picture that asks for it could
be used. Each reason carries its numbers; words are made elsewhere.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.expression_sight import Sight
from core.records import FloatArray, freeze
from core.setup_plan import STANDARD_WEIGHTS, coefficients, shot_of

#: Strength below which an expression is called weak.
WEAK = 0.25
#: A shape that is told to less than this share even alone is hardly seen.
_HARDLY = 0.35
#: A shape whose sight falls below this part through others is taken for one of them.
_CONFUSED, _ALIKE = 0.6, 0.6
#: Coefficients asked for from which a prompt counts as one for a shape.
_ASKED = 0.3
#: Shown to less than this part of what was asked; believed only where landmarks tell.
_UNSHOWN, _TELLING = 0.5, 0.2
#: A picture that was not asked for it shows a shape clearly from this coefficient on.
_CLEAR = 0.4
#: What is left of the strength without a picture; where no prompt asks for it.
_MISSING, _NEVER = 0.6, 0.9
SIDES = ("Left", "Right")


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """What the setup pictures show.

    Attributes:
        names: N file stems of the pictures that were trained on.
        coefficients: (N, B) as fitted.
        unused: Names of pictures that were taken but not trained on.
    """

    names: tuple[str, ...]
    coefficients: FloatArray
    unused: tuple[str, ...]

    def __post_init__(self) -> None:
        freeze(self, coefficients=(np.float64, ("N", "B")))


@dataclass(frozen=True, slots=True)
class _Weak:
    """One expression of one side, judged.

    Attributes:
        name: Of the coefficient.
        strength: In [0, 1].
        shown: Whether pictures show it as far as it was asked for.
        reasons: Why it is weak.
    """

    name: str
    strength: float
    shown: bool
    reasons: list[dict[str, object]]


def weak_expressions(sight: Sight, shown: Shown) -> list[dict[str, object]]:
    """Return the weak expressions, the weakest first, JSON-ready.

    Args:
        sight: What landmarks tell of this user.
        shown: What the pictures show.

    Returns:
        For each its name without a side, the sides ("both", "left", "right" or ""), its strength
        in [0, 1], and the reasons, each with a kind and its numbers.
    """
    judged = [_judge(sight, shown, b) for b in range(len(EXPRESSION_NAMES))]
    return _with_sides([one for one in judged if one.strength < WEAK or not one.shown])


def _judge(sight: Sight, shown: Shown, b: int) -> _Weak:
    asking = [face for face in STANDARD_WEIGHTS if _weight(face, b) >= _ASKED]
    rows = [n for n, name in enumerate(shown.names) if _face(name) in asking]
    reasons = _seen_badly(sight, b)
    strength = float(sight.certain[b])
    enough = True
    if not asking:
        strength *= _NEVER
        reasons.append({"kind": "never asked"})
    elif not rows and shown.coefficients[:, b].max(initial=0.0) < _CLEAR:
        strength, enough = strength * _MISSING, False
        reasons.append(_missing(asking, shown))
    elif rows:
        reached = _reached(shown, rows, b)
        if reached < _UNSHOWN and sight.certain[b] > _TELLING:
            strength, enough = strength * reached, False
            reasons.append({"kind": "unshown", "share": reached, "faces": asking})
    return _Weak(EXPRESSION_NAMES[b], strength, enough, reasons)


def _seen_badly(sight: Sight, b: int) -> list[dict[str, object]]:
    reasons: list[dict[str, object]] = []
    if sight.alone[b] < _HARDLY:
        reasons.append({"kind": "small", "px": float(sight.largest_px[b])})
    other = int(sight.likeness[b].argmax())
    confused = sight.certain[b] < _CONFUSED * sight.alone[b] and not reasons
    if confused and sight.likeness[b, other] > _ALIKE:
        likeness = float(sight.likeness[b, other])
        reasons.append({"kind": "like", "other": EXPRESSION_NAMES[other], "likeness": likeness})
    return reasons


def _missing(asking: Sequence[str], shown: Shown) -> dict[str, object]:
    unused = [name for name in shown.unused if _face(name) in asking]
    kind = "unused" if unused else "missing"
    return {"kind": kind, "faces": list(asking), "pictures": unused}


def _reached(shown: Shown, rows: Sequence[int], b: int) -> float:
    """Return the median share of what was asked for that the pictures show."""
    asked = np.array([_weight(_face(shown.names[n]), b) for n in rows])
    return float(np.median(shown.coefficients[list(rows), b] / asked))


def _face(name: str) -> str:
    shot = shot_of(name)
    return "" if shot is None else shot.expression_name


def _weight(face: str, b: int) -> float:
    return float(_STANDARD[face][b]) if face in _STANDARD else 0.0


_STANDARD: Mapping[str, FloatArray] = {
    face: coefficients(weights) for face, weights in STANDARD_WEIGHTS.items()
}


def _with_sides(weak: Sequence[_Weak]) -> list[dict[str, object]]:
    """Return both sides of an expression as one, with the reasons of the weaker side."""
    by_name: dict[str, list[_Weak]] = {}
    for one in sorted(weak, key=lambda one: one.strength):
        by_name.setdefault(_without_side(one.name), []).append(one)
    return [
        {
            "name": name,
            "sides": _sides([one.name for one in both]),
            "strength": both[0].strength,
            "reasons": both[0].reasons,
        }
        for name, both in by_name.items()
    ]


def _without_side(name: str) -> str:
    side = next((side for side in SIDES if name.endswith(side)), "")
    paired = all(name.removesuffix(side) + other in EXPRESSION_NAMES for other in SIDES)
    return name.removesuffix(side) if side and paired and not _is_way(name) else name


def _is_way(name: str) -> bool:
    """Return whether left and right are two ways to go, not two sides of the face."""
    return name.startswith(("jaw", "mouthLeft", "mouthRight"))


def _sides(names: Sequence[str]) -> str:
    if len(names) > 1:
        return "both"
    side = next((side for side in SIDES if names[0].endswith(side)), "")
    return side.lower() if side and not _is_way(names[0]) else ""
