"""Brows, cheeks, nose and the skin around the eyes, sculpted on the reference head.

Shapes with sides are sculpted on the left. Vectors are mm: left, down, into the head.
"""

import numpy as np

from assets.build.face_model.sculptor import Sculptor

# Left vertices by what they are.
BROW_INNER, BROW_LOWER_INNER, BROW_MIDDLE, BROW_ARCH, BROW_OUTER = 2341, 2301, 2339, 2340, 2388
GLABELLA, NOSE_TIP, UNDER_EYE = 169, 297, 3459
CHEEK_BONE, CHEEK_FRONT, CHEEK_SIDE, CHEEK_LOW = 3691, 2346, 3718, 3675
NOSE_WING, NOSE_SIDE, NASOLABIAL = 3450, 3641, 3707
FOREHEAD_INNER, FOREHEAD_OUTER = 2364, 3648
JOWL, CHEEK_HOLLOW, CHEEK_BACK, CHEEK_DEEP, BESIDE_MOUTH = 3618, 3676, 3686, 3677, 3539


def brow_down(s: Sculptor) -> np.ndarray:
    """Return browDown: the whole brow sinks, its inner end also moves to the nose."""
    goals = {
        BROW_INNER: (-3.2, 6.5, -0.6),
        BROW_LOWER_INNER: (-2.6, 5.2, -1.6),
        BROW_MIDDLE: (-1.8, 5.4, 0.0),
        BROW_ARCH: (-0.8, 3.2, 0.0),
        BROW_OUTER: (0.0, 1.2, 0.0),
        GLABELLA: (0.0, 2.2, -1.0),
        FOREHEAD_INNER: (-1.2, 2.5, 0.0),
    }
    return s.reach(s.unit("eyebrows-left-down"), goals, 32.0)


def brow_inner_up(s: Sculptor) -> np.ndarray:
    """Return browInnerUp: the inner end rises and the forehead folds above it."""
    goals = {
        BROW_INNER: (-1.2, -8.5, 0.8),
        BROW_LOWER_INNER: (-1.0, -7.0, 0.6),
        BROW_MIDDLE: (-0.6, -4.8, 0.4),
        BROW_ARCH: (0.0, -0.8, 0.0),
        FOREHEAD_INNER: (-0.5, -5.0, -0.7),
        GLABELLA: (0.0, -2.2, 0.0),
    }
    return s.reach(s.unit("eyebrows-left-inner-up"), goals, 38.0)


def brow_outer_up(s: Sculptor) -> np.ndarray:
    """Return browOuterUp: arch and tail rise."""
    goals = {
        BROW_INNER: (0.0, -0.6, 0.0),
        BROW_MIDDLE: (0.4, -5.0, 0.6),
        BROW_ARCH: (0.6, -8.5, 1.2),
        BROW_OUTER: (0.4, -7.0, 1.0),
        FOREHEAD_OUTER: (0.0, -4.5, -0.3),
    }
    return s.reach(s.unit("eyebrows-left-extern-up"), goals, 36.0)


def cheek_squint(s: Sculptor) -> np.ndarray:
    """Return cheekSquint: the cheek rises and bulges under the eye; lids follow elsewhere."""
    goals = {
        CHEEK_BONE: (1.0, -7.0, -4.2),
        CHEEK_FRONT: (1.0, -5.0, -3.0),
        CHEEK_SIDE: (1.4, -5.5, -3.4),
        UNDER_EYE: (0.2, -3.4, -2.4),
        NASOLABIAL: (0.5, -2.4, -0.8),
        NOSE_WING: (0.2, -0.6, 0.0),
        BROW_OUTER: (0.0, 0.0, 0.0),
    }
    return s.reach(np.zeros_like(s.reference), goals, 30.0)


def eye_squint(s: Sculptor) -> np.ndarray:
    """Return the skin's part of eyeSquint: it bunches up under and beside the lower lid."""
    goals = {
        CHEEK_FRONT: (-0.6, -2.2, -1.0),
        UNDER_EYE: (0.2, -1.4, -0.8),
        BROW_OUTER: (-0.6, 1.4, 0.0),
        BROW_ARCH: (0.0, 1.0, 0.0),
        CHEEK_BONE: (0.0, -1.5, -0.6),
    }
    return s.reach(np.zeros_like(s.reference), goals, 18.0)


def nose_sneer(s: Sculptor) -> np.ndarray:
    """Return noseSneer: the wing rises and folds the nose's side; the lip follows a little."""
    base = s.unit("nose-left-elevation") + 0.55 * s.left(s.unit("mouth-elevation"))
    base += s.bump(NOSE_SIDE, 5.0, (0.4, -2.6, -1.4))
    goals = {
        NOSE_WING: (1.6, -5.6, 0.6),
        NASOLABIAL: (0.2, -4.4, -1.8),
        NOSE_SIDE: (0.6, -3.2, -1.6),
        BROW_LOWER_INNER: (-0.8, 1.8, -0.6),
        NOSE_TIP: (0.0, -0.9, 0.2),
    }
    field = s.reach(base, goals, 26.0)
    return s.seal(field, 0.35)


def cheek_puff(s: Sculptor) -> np.ndarray:
    """Return cheekPuff: the cheek blows up between cheek bone, jaw and lips."""
    goals = s.lips("seam", (0.0, 0.0, -1.0), (0.2, 0.4, -3.0), (0.0, 0.0, 0.0))
    goals |= {
        CHEEK_LOW: (6.0, -0.6, -9.5),
        CHEEK_HOLLOW: (8.0, -0.6, -9.0),
        CHEEK_BACK: (8.0, 0.4, -5.0),
        CHEEK_DEEP: (8.5, 0.8, -9.0),
        JOWL: (6.5, 1.4, -6.0),
        BESIDE_MOUTH: (2.2, 0.2, -6.5),
        NASOLABIAL: (1.2, -0.8, -4.5),
        CHEEK_BONE: (0.6, -0.8, -1.4),
    }
    return s.seal(s.reach(np.zeros_like(s.reference), goals, 24.0))


def cheek_suck(s: Sculptor) -> np.ndarray:
    """Return cheekSuck: both cheeks hollow between the teeth, the lips narrow."""
    hollow = s.bump(CHEEK_HOLLOW, 14.0, (-5.0, 0.0, 5.5)) + s.bump(CHEEK_LOW, 9.0, (-1.0, 0, 1.5))
    goals = s.lips("seam", (0.0, 0.0, -1.6), (-2.4, 0.0, -1.4), (2.4, 0.0, -1.4))
    return s.seal(s.both(hollow) + s.reach(np.zeros_like(hollow), goals, 16.0))
