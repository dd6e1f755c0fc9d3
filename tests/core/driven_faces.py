"""Solved faces for tests of the drive."""

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.records import FaceState

FPS = 30
N = len(EXPRESSION_NAMES)


def index(name):
    return EXPRESSION_NAMES.index(name)


def face(**named):
    """Return coefficients (46,) of names."""
    out = np.zeros(N)
    for name, value in named.items():
        out[index(name)] = value
    return out


def solved(
    time_s=0.0, expression=None, angles_deg=(0, 0, 0), place_mm=(0, 0, 600), gaze_rad=None,
    lost=False, confidence=0.9,
):  # fmt: skip
    """Return a solved state; angles are yaw, pitch, roll."""
    return FaceState(
        time_s, quaternion_from_matrix(matrix_from_head_angles(*np.deg2rad(angles_deg))),
        np.array(place_mm, float), np.zeros(N) if expression is None else expression,
        np.zeros((2, 2)) if gaze_rad is None else gaze_rad, np.zeros((75, 3)), np.zeros((75, 2)),
        confidence, "trained", lost,
    )  # fmt: skip


def stay(drive, seconds, start_s=0.0, **state):
    """Return what a drive makes of a face that stays for some time."""
    frames = range(round(seconds * FPS))
    return [drive.step(solved(time_s=start_s + k / FPS, **state)) for k in frames]
