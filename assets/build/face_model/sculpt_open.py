"""Jaw shapes and the mouth shapes that part the lips, sculpted on the reference head."""

import numpy as np

from assets.build.face_model.jaw import Jaw, JawMove, cavity_vertices
from assets.build.face_model.sculpt_face import CHEEK_LOW, NASOLABIAL, NOSE_WING
from assets.build.face_model.sculpt_mouth import (
    CHIN,
    CHIN_UPPER,
    STILL,
    SUBNASALE,
    flipped,
    left_goals,
)  # fmt: skip
from assets.build.face_model.sculptor import Sculptor, Vector

#: The jaw movement that the source's open mouth stands for, and ours, which opens further.
TARGET_OPEN = JawMove(open_rad=0.40, shift_mm=(0.0, 2.0, -3.5))
OPEN = JawMove(open_rad=0.48, shift_mm=(0.0, 2.4, -4.0))
FORWARD = JawMove(shift_mm=(0.0, 1.2, -8.0))
LEFT = JawMove(left_rad=0.115, shift_mm=(4.0, 0.8, 0.0))
#: Share of the source's own open mouth in the skin of ours: it brings folds of the cheeks.
TARGET_SHARE = 0.25
UPPER_LIP = 468
#: Share of the opening at which mouthClose brings the lips together, from the upper lip.
LOWER_SHARE = 0.42


def jaw_open(s: Sculptor, jaw: Jaw) -> np.ndarray:
    """Return jawOpen: the jaw turns about its hinge and glides forward."""
    ours, theirs = jaw.move(s.reference, OPEN), s.unit("mouth-open") * 1.2
    folds = TARGET_SHARE * s.skin_only(theirs - ours)
    folds[cavity_vertices(s)] = 0.0
    field = ours + folds
    # The upper lip yields a little and shows the edge of the teeth.
    return field + s.bump(UPPER_LIP, 8.0, (0.0, -1.6, 0.4)) * (1 - jaw.weight[:, None])


def jaw_forward(s: Sculptor, jaw: Jaw) -> np.ndarray:
    """Return jawForward: chin, lower teeth and lower lip glide out, the upper lip yields."""
    field = jaw.move(s.reference, FORWARD)
    goals = s.lips("seam", (0.0, 0.2, -2.6), (0.0, 0.0, -2.6), (0.0, 0.0, -2.6), upper=True)
    goals |= s.lips("seam", (0.0, 0.2, -6.0), (0.0, 0.0, -2.6), (0.0, 0.0, -2.6), upper=False)
    return lifted_to_seal(s, s.reach(field, goals, 16.0))


def lifted_to_seal(s: Sculptor, field: np.ndarray) -> np.ndarray:
    """Return a field whose lips may slide on each other but do not part in height."""
    joined = s.seal(field)
    out = field.copy()
    out[:, 1] = joined[:, 1]
    return out


def jaw_left(s: Sculptor, jaw: Jaw) -> np.ndarray:
    """Return jawLeft: the chin swings to the left and takes the lips along in part."""
    field = jaw.move(s.reference, LEFT)
    goals = s.lips("seam", (7.0, 0.0, 0.0), (6.6, 0.2, 1.4), (6.8, 0.0, -1.0), upper=True)
    goals |= s.lips("seam", (9.6, 0.0, 0.0), (6.6, 0.2, 1.4), (6.8, 0.0, -1.0), upper=False)
    return lifted_to_seal(s, s.reach(field, goals, 22.0))


def mouth_close(s: Sculptor, opened: np.ndarray) -> np.ndarray:
    """Return mouthClose: what closes the lips while jawOpen holds the jaw down.

    Args:
        s: The tools.
        opened: (V, 3) jawOpen.
    """
    seam, side = s.chart.ring("seam"), s.chart.side
    moved = opened[seam]
    upper, lower = (along_lip(side, moved, lip) for lip in (s.chart.upper, s.chart.lower))
    target = upper + LOWER_SHARE * (lower - upper)
    goals: dict[int, Vector] = {}
    # The lips keep their thickness: all their rings go with the seam, up to near the corners.
    inner = np.abs(side) < 0.93
    for ring in ("outer", "full", "middle", "inner", "edge", "seam", "behind", "deep"):
        vertices = s.chart.ring(ring)[inner]
        shift = target[inner] - opened[vertices]
        goals |= dict(zip(vertices.tolist(), map(tuple, shift), strict=True))
    closed = s.reach(np.zeros_like(opened), goals, 42.0)
    return s.seal(opened + closed) - opened


def along_lip(side: np.ndarray, moved: np.ndarray, lip: np.ndarray) -> np.ndarray:
    """Return a lip's displacement at the place along the mouth of all columns, (38, 3)."""
    order = np.argsort(side[lip])
    at, values = side[lip][order], moved[lip][order]
    return np.stack([np.interp(side, at, values[:, k]) for k in range(3)], axis=1)


def funnel(s: Sculptor) -> np.ndarray:
    """Return mouthFunnel: the lips open to an O, forward and turned out."""
    base = s.unit("mouth-protusion") * 0.45
    corner = (-7.0, 0.6, -5.5)
    goals = s.lips("seam", (0.0, -4.6, -7.5), corner, flipped(corner), upper=True, power=1.5)
    goals |= s.lips("seam", (0.0, 8.5, -6.5), corner, flipped(corner), upper=False, power=1.5)
    rim = (-5.5, 0.4, -4.0)
    goals |= s.lips("border", (0.0, -5.2, -6.6), rim, flipped(rim), upper=True, power=1.5)
    goals |= s.lips("border", (0.0, 8.6, -5.6), rim, flipped(rim), upper=False, power=1.5)
    sides = {NASOLABIAL: (-1.4, 1.0, 0.2), CHEEK_LOW: (-3.0, 1.2, 0.4)}
    goals |= sides | {int(s.head.mirror[v]): flipped(d) for v, d in sides.items()}
    return s.reach(base, goals, 30.0)


def lower_down(s: Sculptor) -> np.ndarray:
    """Return mouthLowerDown: the lower lip's left half goes down and shows the teeth."""
    corner = (1.6, 1.8, 1.2)
    goals = s.lips("seam", (1.0, 7.6, 0.2), corner, STILL, upper=False, power=2.4)
    goals |= s.lips("border", (1.0, 7.4, 0.4), corner, STILL, upper=False, power=2.4)
    goals |= s.lips("seam", (0.0, 0.0, 0.0), corner, STILL, upper=True, power=3.0)
    goals = left_goals(s, goals)
    goals |= {CHIN_UPPER: (0.4, 1.8, -0.4), CHIN: (0.0, 0.4, 0.0), CHEEK_LOW: (0.8, 1.0, 0.0)}
    return s.reach(np.zeros_like(s.reference), goals, 24.0)


def upper_up(s: Sculptor) -> np.ndarray:
    """Return mouthUpperUp: the upper lip's left half goes up and shows the teeth."""
    base = 0.3 * s.left(s.unit("mouth-elevation"))
    corner = (1.0, -1.8, 1.2)
    goals = s.lips("seam", (0.4, -7.4, -0.2), corner, STILL, upper=True, power=2.2)
    goals |= s.lips("border", (0.4, -6.8, -0.4), corner, STILL, upper=True, power=2.2)
    goals |= s.lips("seam", (0.0, 0.0, 0.0), corner, STILL, upper=False, power=3.0)
    goals = left_goals(s, goals)
    goals |= {
        NASOLABIAL: (0.6, -4.2, -2.0),
        NOSE_WING: (0.8, -2.4, 0.2),
        SUBNASALE: (0.0, -0.8, 0.0),
        CHEEK_LOW: (0.4, -1.6, -0.4),
    }
    return s.reach(base, goals, 26.0)
