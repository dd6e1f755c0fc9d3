"""The 46 expression names, the 52 ARKit names, and the map from ours plus gaze to ARKit's.

Left and right are the subject's. ARKit's browInnerUp and cheekPuff are split into sides here,
the eight eyeLook shapes come from gaze, tongueOut is not tracked, and cheekSuck (hollowed
cheeks) is ours alone.
"""

import numpy as np

from core.records import FloatArray

EXPRESSION_NAMES: tuple[str, ...] = (
    "eyeBlinkLeft", "eyeBlinkRight", "eyeSquintLeft", "eyeSquintRight",
    "eyeWideLeft", "eyeWideRight", "browDownLeft", "browDownRight",
    "browInnerUpLeft", "browInnerUpRight", "browOuterUpLeft", "browOuterUpRight",
    "cheekPuffLeft", "cheekPuffRight", "cheekSquintLeft", "cheekSquintRight", "cheekSuck",
    "noseSneerLeft", "noseSneerRight", "jawForward", "jawLeft", "jawRight", "jawOpen",
    "mouthClose", "mouthFunnel", "mouthPucker", "mouthLeft", "mouthRight",
    "mouthSmileLeft", "mouthSmileRight", "mouthFrownLeft", "mouthFrownRight",
    "mouthDimpleLeft", "mouthDimpleRight", "mouthStretchLeft", "mouthStretchRight",
    "mouthRollLower", "mouthRollUpper", "mouthShrugLower", "mouthShrugUpper",
    "mouthPressLeft", "mouthPressRight", "mouthLowerDownLeft", "mouthLowerDownRight",
    "mouthUpperUpLeft", "mouthUpperUpRight",
)  # fmt: skip

ARKIT_NAMES: tuple[str, ...] = (
    "eyeBlinkLeft", "eyeLookDownLeft", "eyeLookInLeft", "eyeLookOutLeft", "eyeLookUpLeft",
    "eyeSquintLeft", "eyeWideLeft", "eyeBlinkRight", "eyeLookDownRight", "eyeLookInRight",
    "eyeLookOutRight", "eyeLookUpRight", "eyeSquintRight", "eyeWideRight",
    "jawForward", "jawLeft", "jawRight", "jawOpen", "mouthClose", "mouthFunnel", "mouthPucker",
    "mouthLeft", "mouthRight", "mouthSmileLeft", "mouthSmileRight", "mouthFrownLeft",
    "mouthFrownRight", "mouthDimpleLeft", "mouthDimpleRight", "mouthStretchLeft",
    "mouthStretchRight", "mouthRollLower", "mouthRollUpper", "mouthShrugLower",
    "mouthShrugUpper", "mouthPressLeft", "mouthPressRight", "mouthLowerDownLeft",
    "mouthLowerDownRight", "mouthUpperUpLeft", "mouthUpperUpRight",
    "browDownLeft", "browDownRight", "browInnerUp", "browOuterUpLeft", "browOuterUpRight",
    "cheekPuff", "cheekSquintLeft", "cheekSquintRight", "noseSneerLeft", "noseSneerRight",
    "tongueOut",
)  # fmt: skip

#: Eye rotation that counts as a full look in each direction.
FULL_LOOK_RAD = np.deg2rad(30.0)


def mirror_permutation() -> list[int]:
    """Return for each expression the index of its mirror image."""
    swap = {"Left": "Right", "Right": "Left"}

    def mirrored(name: str) -> str:
        for side, other in swap.items():
            if name.endswith(side):
                return name.removesuffix(side) + other
        return name

    return [EXPRESSION_NAMES.index(mirrored(name)) for name in EXPRESSION_NAMES]


def arkit_from(expression: FloatArray, gaze_rad: FloatArray) -> FloatArray:
    """Return the 52 ARKit coefficients (..., 52) in [0, 1].

    Args:
        expression: (..., 46) in the order of EXPRESSION_NAMES.
        gaze_rad: (..., 2, 2) yaw and pitch of the right, then the left eye; see FaceState.
    """
    expression, gaze = np.asarray(expression, float), np.asarray(gaze_rad, float)
    out = np.zeros((*expression.shape[:-1], len(ARKIT_NAMES)))
    for index, name in enumerate(ARKIT_NAMES):
        if name in EXPRESSION_NAMES:
            out[..., index] = expression[..., EXPRESSION_NAMES.index(name)]
    for name in ("browInnerUp", "cheekPuff"):
        left = EXPRESSION_NAMES.index(name + "Left")
        out[..., ARKIT_NAMES.index(name)] = expression[..., left : left + 2].mean(axis=-1)
    looks = np.clip(gaze / FULL_LOOK_RAD, -1, 1)
    for eye, side, inward in ((0, "Right", 1.0), (1, "Left", -1.0)):
        yaw, pitch = looks[..., eye, 0], looks[..., eye, 1]
        for name, value in (
            ("eyeLookIn", inward * yaw),
            ("eyeLookOut", -inward * yaw),
            ("eyeLookUp", pitch),
            ("eyeLookDown", -pitch),
        ):
            out[..., ARKIT_NAMES.index(name + side)] = np.maximum(value, 0)
    return out
