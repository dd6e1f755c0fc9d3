"""All expressions on the reference head, left or central; right ones are mirror images."""

from dataclasses import dataclass

import numpy as np

from assets.build.face_model import sculpt_face, sculpt_mouth, sculpt_open
from assets.build.face_model.jaw import Jaw, make_jaw
from assets.build.face_model.sculptor import Sculptor

CLOSED_MOUTH = {
    "mouthPucker": sculpt_mouth.pucker, "mouthLeft": sculpt_mouth.mouth_left,
    "mouthSmileLeft": sculpt_mouth.smile, "mouthFrownLeft": sculpt_mouth.frown,
    "mouthDimpleLeft": sculpt_mouth.dimple, "mouthStretchLeft": sculpt_mouth.stretch,
    "mouthRollLower": sculpt_mouth.roll_lower, "mouthRollUpper": sculpt_mouth.roll_upper,
    "mouthShrugLower": sculpt_mouth.shrug_lower, "mouthShrugUpper": sculpt_mouth.shrug_upper,
    "mouthPressLeft": sculpt_mouth.press,
}  # fmt: skip
OPEN_MOUTH = {
    "mouthFunnel": sculpt_open.funnel, "mouthLowerDownLeft": sculpt_open.lower_down,
    "mouthUpperUpLeft": sculpt_open.upper_up,
}  # fmt: skip
REST = {
    "browDownLeft": sculpt_face.brow_down, "browInnerUpLeft": sculpt_face.brow_inner_up,
    "browOuterUpLeft": sculpt_face.brow_outer_up, "cheekPuffLeft": sculpt_face.cheek_puff,
    "cheekSquintLeft": sculpt_face.cheek_squint, "cheekSuck": sculpt_face.cheek_suck,
    "noseSneerLeft": sculpt_face.nose_sneer, "eyeSquintLeft": sculpt_face.eye_squint,
}  # fmt: skip


@dataclass(frozen=True)
class Sculpture:
    """The expressions of the reference head: name -> (V, 3) mm, lids not yet moved."""

    fields: dict[str, np.ndarray]
    jaw: Jaw


def sculpt(sculptor: Sculptor) -> Sculpture:
    """Return all left and central expressions on the reference head."""
    jaw = make_jaw(sculptor, sculpt_open.TARGET_OPEN)
    opened = sculpt_open.jaw_open(sculptor, jaw)
    fields = {
        "jawOpen": opened,
        "jawForward": sculpt_open.jaw_forward(sculptor, jaw),
        "jawLeft": sculpt_open.jaw_left(sculptor, jaw),
        "mouthClose": sculpt_open.mouth_close(sculptor, opened),
    }
    for name, make in (CLOSED_MOUTH | OPEN_MOUTH | REST).items():
        fields[name] = make(sculptor)
    return Sculpture(fields, jaw)
