"""The centre: where the head is and how the face rests when nothing is meant by it.

It is set by a key press, and follows by itself, if wanted, how the user slides in the chair and
how a face's rest changes with light and hours: slowly, and never from a face that means something.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.records import FloatArray, freeze

_N = len(EXPRESSION_NAMES)
#: Lids are left to their own levels: eyes that look down are no other rest.
_LIDS = [n for n, name in enumerate(EXPRESSION_NAMES) if name.startswith("eyeBlink")]
#: Largest rest of a coefficient that a key press takes over, and that is learned by itself.
MOST_AT_ONCE, MOST_LEARNED = 0.6, 0.2
#: A face means something if a coefficient is further than this from its rest...
EXPRESSIVE = 0.15
#: ... and a head if it is turned, rad, or away, mm, further than this, or moves faster.
TURNED_RAD, AWAY_MM, TURN_SPEED_RAD_S = 0.25, 90.0, 0.15
#: Time for which nothing must have been meant.
CALM_S = 2.0
#: A lid this far down is shut.
SHUT = 0.7


@dataclass(frozen=True, slots=True, eq=False)
class Centre:
    """Where the head is and how the face rests when nothing is meant by it.

    Attributes:
        rotation_wxyz: (4,) of the head against the line of sight from the camera.
        translation_mm: (3,) in the camera frame.
        expression: (B,) coefficients at rest.
    """

    rotation_wxyz: FloatArray
    translation_mm: FloatArray
    expression: FloatArray = field(default_factory=lambda: np.zeros(_N))

    def __post_init__(self) -> None:
        freeze(
            self,
            rotation_wxyz=(np.float64, (4,)),
            translation_mm=(np.float64, (3,)),
            expression=(np.float64, (_N,)),
        )


def centre_to_plain(centre: Centre) -> dict[str, list[float]]:
    """Return a centre as JSON values."""
    return {
        "rotation_wxyz": centre.rotation_wxyz.tolist(),
        "translation_mm": centre.translation_mm.tolist(),
        "expression": centre.expression.tolist(),
    }


def centre_from_plain(plain: object) -> Centre | None:
    """Return the centre of `centre_to_plain`, None if it is none."""
    if not isinstance(plain, Mapping):
        return None
    try:
        rotation = np.array(plain["rotation_wxyz"], float).reshape(4)
        place = np.array(plain["translation_mm"], float).reshape(3)
        expression = np.array(plain["expression"], float).reshape(_N)
    except (KeyError, TypeError, ValueError):
        return None
    numbers = np.concatenate([rotation, place, expression])
    length = float(np.linalg.norm(rotation))
    if not np.isfinite(numbers).all() or length < 1e-6 or place[2] <= 0:
        return None
    return Centre(rotation / length, place, np.clip(expression, 0, MOST_AT_ONCE))


def rest_of(expression: FloatArray) -> FloatArray:
    """Return what of an expression (B,) counts as rest after a key press; lids not at all."""
    rest = np.clip(expression, 0.0, MOST_AT_ONCE)
    rest[_LIDS] = 0.0
    return rest


def without_rest(expression: FloatArray, rest: FloatArray) -> FloatArray:
    """Return the expression (B,) counted from rest: 0 at rest, and what was 1 stays 1."""
    return np.maximum(expression - rest, 0.0) / (1.0 - rest)


class Calm:
    """Tells for how long nothing has been meant."""

    def __init__(self) -> None:
        self._seconds = 0.0
        self._angles = np.zeros(3)

    def reset(self) -> None:
        """Begin anew, as after a loss."""
        self._seconds = 0.0

    def add(
        self, away: FloatArray, expression: FloatArray, rest: FloatArray, step_s: float
    ) -> float:
        """Return for how long nothing has been meant, this face included.

        Args:
            away: (6,) the head's deviation from the centre.
            expression: (B,) as tracked.
            rest: (B,) of the centre.
            step_s: Time since the last call, above 0.
        """
        speed = float(np.abs(away[:3] - self._angles).max()) / step_s
        off = np.abs(expression - rest)
        off[_LIDS] = 0.0
        # A closed eye is no expression, but who sleeps does not show how they look at the screen.
        means = (
            float(off.max()) > EXPRESSIVE
            or float(expression[_LIDS].max()) > SHUT
            or float(np.abs(away[:3]).max()) > TURNED_RAD
            or float(np.abs(away[3:]).max()) > AWAY_MM
            or speed > TURN_SPEED_RAD_S
        )
        self._angles[:] = away[:3]
        self._seconds = 0.0 if means else self._seconds + step_s
        return self._seconds


def learned_rest(rest: FloatArray, expression: FloatArray, share: float) -> FloatArray:
    """Return the rest (B,) moved towards an expression, no higher than is learned by itself."""
    goal = np.minimum(expression, np.maximum(rest, MOST_LEARNED))
    moved = rest + share * (goal - rest)
    moved[_LIDS] = rest[_LIDS]
    return np.asarray(moved)
