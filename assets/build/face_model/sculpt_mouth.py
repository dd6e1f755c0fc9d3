"""Mouth shapes that keep the lips together, sculpted on the reference head.

Shapes with sides are sculpted on the left. Vectors are mm: left, down, into the head.
"""

import numpy as np

from assets.build.face_model.sculpt_face import (
    CHEEK_BONE,
    CHEEK_LOW,
    CHEEK_SIDE,
    JOWL,
    NASOLABIAL,
    NOSE_WING,
)  # fmt: skip
from assets.build.face_model.sculptor import Sculptor, Vector

STILL: Vector = (0.0, 0.0, 0.0)
CHIN, CHIN_UPPER, SUBNASALE, DIMPLE = 1505, 733, 312, 3539


def flipped(vector: Vector) -> Vector:
    """Return a vector's mirror image."""
    return (-vector[0], vector[1], vector[2])


def smile(s: Sculptor) -> np.ndarray:
    """Return mouthSmile: the corner goes up, out and back, the cheek rises over it."""
    base = s.left(s.unit("mouth-corner-puller"))
    goals = s.lips("seam", (1.4, -1.2, 1.8), (9.0, -9.0, 7.5), STILL, power=1.2)
    goals |= s.lips("border", (1.2, -1.4, 2.6), (9.6, -10.0, 8.0), STILL, upper=False, power=1.2)
    goals |= s.lips("border", (1.2, 0.2, 2.6), (9.6, -10.0, 8.0), STILL, upper=True, power=1.2)
    goals |= {
        CHEEK_BONE: (1.0, -3.6, -2.4),
        CHEEK_SIDE: (3.2, -5.0, -1.6),
        NASOLABIAL: (3.2, -3.4, -1.0),
        NOSE_WING: (1.4, -1.2, 0.4),
        CHEEK_LOW: (5.0, -6.0, 1.6),
    }
    return s.seal(s.reach(base, goals, 30.0))


def frown(s: Sculptor) -> np.ndarray:
    """Return mouthFrown: the corner goes down, the chin bunches."""
    base = s.left(s.unit("mouth-depression"))
    goals = s.lips("seam", (0.4, -1.6, -0.4), (2.2, 9.0, 2.0), STILL, power=1.5)
    goals |= {
        CHIN_UPPER: (0.2, -1.8, -1.2),
        NASOLABIAL: (0.2, 1.4, 0.0),
        CHEEK_LOW: (0.6, 4.2, 0.6),
        JOWL: (0.8, 3.0, 0.0),
    }
    return s.seal(s.reach(base, goals, 30.0))


def dimple(s: Sculptor) -> np.ndarray:
    """Return mouthDimple: the corner is pulled back into the cheek, which dents beside it."""
    base = 1.2 * s.left(s.unit("mouth-retraction"))
    corner, rim = (7.5, -2.6, 9.0), (8.0, -2.6, 10.0)
    goals = s.lips("seam", (0.8, -0.2, 1.4), corner, STILL, power=1.4)
    goals |= s.lips("border", (0.8, 1.4, 2.2), rim, STILL, upper=True, power=1.4)
    goals |= s.lips("border", (0.8, -1.4, 2.2), rim, STILL, upper=False, power=1.4)
    goals |= {
        CHEEK_LOW: (4.6, -1.4, -1.6),
        NASOLABIAL: (2.0, -1.2, -2.0),
        JOWL: (2.4, -0.6, -1.2),
        DIMPLE: (5.4, -2.0, 6.0),
    }
    return s.seal(s.reach(base, goals, 26.0))


def stretch(s: Sculptor) -> np.ndarray:
    """Return mouthStretch: the corner is drawn out and down, lips thin, neck tense."""
    base = 0.5 * s.left(s.unit("neck-platysma"))
    goals = s.lips("seam", (1.0, 0.8, 1.6), (10.0, 5.0, 6.5), STILL, power=1.3)
    goals |= s.lips("border", (1.0, 1.4, 2.4), (10.4, 5.0, 7.0), STILL, upper=True, power=1.3)
    goals |= s.lips("border", (1.0, 0.6, 2.2), (10.4, 5.0, 7.0), STILL, upper=False, power=1.3)
    goals |= {
        NASOLABIAL: (2.0, 1.6, 0.4),
        CHEEK_LOW: (6.0, 3.0, 1.0),
        JOWL: (3.4, 3.0, 0.4),
        CHIN: (0.6, 0.4, 0.0),
    }
    return s.seal(s.reach(base, goals, 32.0))


def press(s: Sculptor) -> np.ndarray:
    """Return mouthPress: the lips are pressed together, their red thins, the rims bulge."""
    base = 0.4 * s.left(s.unit("mouth-compression"))
    corner = (2.6, -1.4, 3.2)
    goals = s.lips("seam", (0.0, 0.0, 4.4), corner, STILL, power=2.5)
    for ring, up, down, back in (
        ("inner", 1.0, -1.0, 5.2), ("full", 3.6, -4.2, 4.8), ("outer", 4.2, -5.2, 2.8),
        ("border", 3.8, -4.8, 0.4), ("skin", 2.4, -2.8, -1.2),
    ):  # fmt: skip
        goals |= s.lips(ring, (0.0, up, back), corner, STILL, upper=True, power=2.5)
        goals |= s.lips(ring, (0.0, down, back), corner, STILL, upper=False, power=2.5)
    goals = left_goals(s, goals)
    goals |= {CHIN_UPPER: (0.0, -2.4, -1.8), CHEEK_LOW: (2.0, -0.4, -2.2)}
    return s.seal(s.reach(base, goals, 24.0))


def left_goals(s: Sculptor, goals: dict[int, Vector]) -> dict[int, Vector]:
    """Return goals weakened towards the right side."""
    return {v: tuple(np.array(d) * float(s.left_share[v])) for v, d in goals.items()}


def pucker(s: Sculptor) -> np.ndarray:
    """Return mouthPucker: the mouth becomes small and the closed lips come forward."""
    base = s.unit("mouth-pursing")
    corner = (-10.5, -0.2, -8.5)
    goals = s.lips("seam", (0.0, 0.2, -9.5), corner, flipped(corner), power=1.5)
    goals |= s.lips("border", (0.0, -1.6, -7.0), (-9.0, -0.3, -6.5), flipped((-9.0, -0.3, -6.5)),
                    upper=True)  # fmt: skip
    goals |= s.lips("border", (0.0, 2.0, -6.0), (-9.0, -0.3, -6.5), flipped((-9.0, -0.3, -6.5)),
                    upper=False)  # fmt: skip
    sides = {NASOLABIAL: (-1.6, 0.6, 0.4), CHEEK_LOW: (-4.0, 0.0, 0.5)}
    goals |= sides | {int(s.head.mirror[v]): flipped(d) for v, d in sides.items()}
    return s.seal(s.reach(base, goals, 30.0))


def mouth_left(s: Sculptor) -> np.ndarray:
    """Return mouthLeft: the whole closed mouth goes to the left, with the skin around."""
    goals = s.lips("seam", (9.5, -0.4, 0.6), (8.5, -1.2, 4.0), (9.0, 0.6, -1.6), power=2.0)
    goals |= s.lips("border", (9.0, -0.4, 0.6), (8.2, -1.2, 4.0), (8.8, 0.6, -1.6), power=2.0)
    right = s.head.mirror
    goals |= {
        CHIN_UPPER: (5.5, 0.0, 0.0),
        CHIN: (2.6, 0.0, 0.0),
        SUBNASALE: (2.2, 0.0, 0.0),
        297: (0.8, 0.0, 0.0),
        NASOLABIAL: (2.6, -1.4, -1.2),
        CHEEK_LOW: (4.6, -1.0, 0.4),
        int(right[NASOLABIAL]): (3.0, 0.6, 0.8),
        int(right[CHEEK_LOW]): (4.2, 0.4, -0.6),
    }
    return s.seal(s.reach(np.zeros_like(s.reference), goals, 34.0))


def roll_lower(s: Sculptor) -> np.ndarray:
    """Return mouthRollLower: the lower lip turns in over the teeth until its red is gone."""
    goals: dict[int, Vector] = {}
    corner = (0.0, -0.4, 1.6)
    for ring, middle in (
        ("skin", (0.0, -2.4, 1.2)), ("border", (0.0, -5.6, 3.4)), ("outer", (0.0, -5.4, 5.4)),
        ("full", (0.0, -3.4, 6.6)), ("inner", (0.0, 0.6, 6.0)), ("seam", (0.0, 1.0, 4.4)),
        ("behind", (0.0, 1.6, 3.4)),
    ):  # fmt: skip
        goals |= s.lips(ring, middle, corner, corner, upper=False, power=2.2)
    goals |= {CHIN_UPPER: (0.0, -2.0, -1.0), CHIN: (0.0, -0.8, -0.4)}
    goals |= s.lips("seam", (0.0, 1.0, 1.0), corner, corner, upper=True, power=2.2)
    return s.seal(s.reach(np.zeros_like(s.reference), goals, 24.0), 0.75)


def roll_upper(s: Sculptor) -> np.ndarray:
    """Return mouthRollUpper: the upper lip turns in over the teeth until its red is gone."""
    goals: dict[int, Vector] = {}
    corner = (0.0, 0.2, 1.6)
    for ring, middle in (
        ("skin", (0.0, 2.6, 1.4)), ("border", (0.0, 5.2, 4.6)), ("outer", (0.0, 4.8, 6.6)),
        ("full", (0.0, 3.2, 7.4)), ("inner", (0.0, 0.0, 6.4)), ("seam", (0.0, -0.6, 4.2)),
        ("behind", (0.0, -1.2, 3.4)),
    ):  # fmt: skip
        goals |= s.lips(ring, middle, corner, corner, upper=True, power=2.2)
    goals |= {SUBNASALE: (0.0, 0.8, 0.3)}
    goals |= s.lips("seam", (0.0, -0.6, 1.4), corner, corner, upper=False, power=2.2)
    return s.seal(s.reach(np.zeros_like(s.reference), goals, 22.0), 0.25)


def shrug_lower(s: Sculptor) -> np.ndarray:
    """Return mouthShrugLower: the chin rises and pushes the lower lip up and out."""
    corner = (0.0, 0.8, 0.4)
    goals = s.lips("seam", (0.0, -4.6, -2.0), corner, corner, power=2.4)
    goals |= s.lips("border", (0.0, -5.6, -4.6), corner, corner, upper=False, power=2.0)
    goals |= s.lips("full", (0.0, -4.8, -4.4), corner, corner, upper=False, power=2.0)
    goals |= s.lips("border", (0.0, -2.2, -1.4), corner, corner, upper=True, power=2.4)
    goals |= {CHIN_UPPER: (0.0, -6.0, -2.6), CHIN: (0.0, -5.2, -1.6), 1554: (0.0, -2.6, -0.8)}
    return s.seal(s.reach(np.zeros_like(s.reference), goals, 26.0))


def shrug_upper(s: Sculptor) -> np.ndarray:
    """Return mouthShrugUpper: the upper lip is pushed up and out, the lower lip follows."""
    corner = (0.0, 1.4, 0.4)
    goals = s.lips("seam", (0.0, -3.6, -2.6), corner, corner, power=2.2)
    goals |= s.lips("border", (0.0, -4.6, -4.2), corner, corner, upper=True, power=2.0)
    goals |= s.lips("full", (0.0, -4.2, -4.6), corner, corner, upper=True, power=2.0)
    goals |= s.lips("border", (0.0, -1.0, -0.2), corner, corner, upper=False, power=2.4)
    goals |= {SUBNASALE: (0.0, -1.6, -0.4), NASOLABIAL: (0.4, -0.8, -0.6)}
    goals |= {int(s.head.mirror[NASOLABIAL]): (-0.4, -0.8, -0.6)}
    return s.seal(s.reach(np.zeros_like(s.reference), goals, 22.0), 0.7)
