"""A face of 75 points with 46 hand-made blendshapes: enough anatomy to test tracking on.

Built for the subject's left side and mirrored. Rows as in the shapes that the regressor gives,
without the pupils: 12 brow points, 16 lid points, 12 nose points, 20 lip points, 15 on cheeks,
chin and forehead. Head frame: x to the subject's left, y down, z into the head, mm.
"""

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.tracker import TrackerModel

EYE_CENTERS = np.array([[-32.0, 0.0, 0.0], [32.0, 0.0, 0.0]])
EYE_RADII = np.array([12.0, 12.0])

BROW = [
    (52, -18, -8),
    (46, -23, -13),
    (37, -25, -17),
    (27, -23, -20),
    (17, -19, -22),
    (17, -15, -22),
]
LIDS = [(46, 1, -7), (41, -4, -11), (33, -6, -14), (25, -4, -13), (19, 2, -10),
        (25, 4, -12), (33, 6, -13), (41, 4, -11)]  # fmt: skip
NOSE_MID = [(0, -3, -22), (0, 8, -28), (0, 19, -35), (0, 28, -41), (0, 36, -44), (0, 46, -34)]
NOSE_SIDE = [(6, 46, -31), (11, 44, -29), (16, 40, -26)]
LIPS_MID = [(0, 61, -37), (0, 79, -35), (0, 68, -35), (0, 69, -35)]
LIPS_SIDE = [(25, 68, -24), (15, 63, -32), (6, 60, -37), (15, 77, -31), (7, 79, -35),
             (22, 68, -25), (10, 67, -33), (10, 70, -33)]  # fmt: skip
CHEEKS = [
    (40, 18, -16),
    (48, 30, -8),
    (38, 40, -15),
    (50, 55, 0),
    (34, 70, -14),
    (28, 92, -18),
    (22, 20, -18),
]
CHIN = (0, 100, -30)


def mirror(points):
    return np.asarray(points, float) * (-1.0, 1.0, 1.0)


def pairs(left):
    left = np.array(left, float)
    return np.stack([mirror(left), left], axis=1).reshape(-1, 3)


def neutral_points():
    """Return the 75 points of the face at rest."""
    return np.concatenate(
        [pairs(BROW), pairs(LIDS), NOSE_MID, pairs(NOSE_SIDE), LIPS_MID, pairs(LIPS_SIDE),
         pairs(CHEEKS), [CHIN]]
    )  # fmt: skip


def falloff(points, center, radius):
    distance = np.linalg.norm((points - center)[:, :2], axis=1)
    return np.exp(-0.5 * (distance / radius) ** 2)[:, None]


def bump(center, radius, move):
    """Return a displacement field: a smooth bump about `center`, (x, y) mm."""

    def field(points):
        return falloff(points, (*center, 0.0), radius) * np.array(move, float)

    return field


def lower(points):
    """Return 1 on the lower lip, chin and lower cheeks, 0 above, smooth on the cheeks."""
    side = np.abs(points[:, 0]) > 20
    sharp = (points[:, 1] > 68.5).astype(float)
    smooth = np.clip((points[:, 1] - 40) / 55, 0, 1)
    return np.where(side, smooth, sharp)[:, None]


def lids(upper_mm, lower_mm):
    """Return lid motion of the left eye, full at the lids' middle."""

    def field(points):
        lid = (np.abs(points[:, 0] - 33) < 12) & (np.abs(points[:, 1]) < 7)
        is_upper = (points[:, 1] < 0)[:, None]
        arc = 1 - (points[:, :1] - 33) ** 2 / 170
        move = np.where(is_upper, upper_mm, lower_mm)
        return lid[:, None] * arc * np.concatenate([0 * move, move, 0 * move], axis=1)

    return field


def lip(rows, move, radius=9.0):
    """Return motion of the lip middle: upper rows above 68.5, lower below, or both."""

    def field(points):
        y = points[:, 1:2]
        chosen = {
            "upper": (y < 68.7) & (y > 55),
            "lower": (y > 68.7) & (y < 85),
            "both": (y > 55) & (y < 85),
        }
        near = np.exp(-0.5 * (points[:, :1] / (2 * radius)) ** 2)
        return chosen[rows] * near * np.array(move, float)

    return field


def radial(strength, forward):
    """Return lips drawn together (or apart) and pushed forward."""

    def field(points):
        near = falloff(points, (0, 69, 0), 20)
        out = near * (points - (0, 69, 0)) * (strength, 0.35 * strength, 0)
        out[:, 2:] -= near * forward
        return out

    return field


def half(field):
    """Restrict a field to the left half of the face, softly at the middle."""
    return lambda points: field(points) / (1 + np.exp(-points[:, :1] / 3))


def hinge(degrees):
    """Return the opening of the jaw about an axis before the ears."""

    def field(points):
        angle = np.deg2rad(degrees)
        y, z = points[:, 1] - 30, points[:, 2] - 70
        moved = np.stack([0 * y, z * -np.sin(angle) + y * (np.cos(angle) - 1),
                          y * np.sin(angle) + z * (np.cos(angle) - 1)], axis=1)  # fmt: skip
        return lower(points) * moved

    return field


def total(*fields):
    return lambda points: sum(field(points) for field in fields)


#: Fields of the left or only side; Right ones are mirrored.
FIELDS = {
    "eyeBlinkLeft": lids(10.0, -1.5), "eyeSquintLeft": total(lids(1.5, -3.0), bump((33, 16), 10, (0, -2, 0))),
    "eyeWideLeft": lids(-2.5, 0.7), "browDownLeft": bump((30, -20), 18, (-2, 6, 0)),
    "browInnerUpLeft": bump((16, -18), 11, (0, -9, 0)), "browOuterUpLeft": bump((44, -22), 13, (0, -8, 0)),
    "cheekPuffLeft": bump((38, 62), 16, (4, 0, -8)), "cheekSquintLeft": bump((38, 22), 15, (0, -5, -2)),
    "cheekSuck": total(bump((38, 62), 14, (-3, 0, 4)), bump((-38, 62), 14, (3, 0, 4))),
    "noseSneerLeft": total(bump((12, 38), 9, (0, -5, 0)), half(lip("upper", (0, -2, 0)))),
    "jawForward": lambda p: lower(p) * (0, 0, -6.0), "jawLeft": lambda p: lower(p) * (9.0, 0, 0),
    "jawOpen": hinge(20.0), "mouthFunnel": total(radial(-0.25, 6), lip("lower", (0, 3, -2)), lip("upper", (0, -3, -2))),
    "mouthPucker": radial(-0.42, 7), "mouthLeft": bump((0, 69), 20, (10, 0, 0)),
    "mouthSmileLeft": total(bump((25, 68), 12, (9, -9, 4)), bump((38, 50), 14, (1, -3, -2))),
    "mouthFrownLeft": bump((25, 68), 11, (1, 8, 2)), "mouthDimpleLeft": bump((25, 68), 9, (5, -1, 5)),
    "mouthStretchLeft": bump((25, 70), 13, (9, 4, 2)), "mouthRollLower": lip("lower", (0, -5, 4)),
    "mouthRollUpper": lip("upper", (0, 4, 4)), "mouthShrugLower": total(lip("both", (0, -4, -2)), bump((0, 100), 12, (0, -4, 0))),
    "mouthShrugUpper": lip("upper", (0, -3, -3)), "mouthPressLeft": half(total(lip("upper", (0, 1.5, 1)), lip("lower", (0, -2, 1)))),
    "mouthLowerDownLeft": half(lip("lower", (0, 7, 0))), "mouthUpperUpLeft": half(lip("upper", (0, -7, 0))),
}  # fmt: skip


def delta_points():
    """Return the 46 deltas (46, 75, 3)."""
    points = neutral_points()
    fields = dict(FIELDS)
    # The sealed lips of an open jaw meet in the middle; the chin stays down.
    lips = ((points[:, 1] > 55) & (points[:, 1] < 85))[:, None]
    out = {name: field(points) for name, field in fields.items()}
    fall = np.array([0.0, 7.0, 0.0])
    out["mouthClose"] = lips * (fall - out["jawOpen"] * (points[:, 1:2] > 68.7))
    for name, field in fields.items():
        if name.endswith("Left"):
            out[name.removesuffix("Left") + "Right"] = mirror(field(mirror(points)))
    return np.array([out[name] for name in EXPRESSION_NAMES])


def point_face():
    """Return the face as a tracker model."""
    return TrackerModel(neutral_points(), delta_points(), EYE_CENTERS, EYE_RADII)


def shape_of(model, expression, pose, gaze_rad=(0.0, 0.0)):
    """Return the 77 points of an expression under a pose (4, 3), both eyes looking one way."""
    yaw, pitch = gaze_rad
    look = np.array([np.sin(yaw) * np.cos(pitch), -np.sin(pitch), -np.cos(yaw) * np.cos(pitch)])
    pupils = model.eye_centers_mm + model.pupil_radii_mm[:, None] * look
    face = model.neutral_mm + np.tensordot(expression, model.deltas_mm, 1)
    return np.concatenate([face, pupils]) @ pose[:3].T + pose[3]
