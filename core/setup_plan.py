"""The 60 setup shots: how the head is held, which expression is made, and its coefficients a*.

15 head poses with a neutral face, then 15 expressions at three yaw angles [Cao13, capture of
setup images]. The order of the prompts is the order of `SHOTS`; a picture is stored under its
shot's name. Every angle is only asked for: the fit finds the true one.
"""

from dataclasses import dataclass

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.records import FloatArray, freeze

#: Coefficients of the prompted expressions; a name without a side means both sides.
STANDARD_WEIGHTS: dict[str, dict[str, float]] = {
    "neutral": {},
    "mouth_stretch": {
        "jawOpen": 0.9, "mouthStretch": 0.3, "mouthLowerDown": 0.25, "mouthUpperUp": 0.15,
    },
    "smile": {"mouthSmile": 0.9, "cheekSquint": 0.4, "eyeSquint": 0.2},
    "brow_raise": {"browInnerUp": 0.9, "browOuterUp": 0.9, "eyeWide": 0.4},
    "disgust": {
        "noseSneer": 0.9, "mouthUpperUp": 0.6, "browDown": 0.5, "eyeSquint": 0.4,
        "cheekSquint": 0.4,
    },
    "squeeze_left_eye": {
        "eyeBlinkLeft": 1.0, "eyeSquintLeft": 0.6, "cheekSquintLeft": 0.7,
        "browDownLeft": 0.3, "mouthSmileLeft": 0.3,
    },
    "squeeze_right_eye": {
        "eyeBlinkRight": 1.0, "eyeSquintRight": 0.6, "cheekSquintRight": 0.7,
        "browDownRight": 0.3, "mouthSmileRight": 0.3,
    },
    "anger": {"browDown": 0.9, "noseSneer": 0.3, "eyeSquint": 0.3, "mouthPress": 0.5},
    "jaw_left": {"jawLeft": 0.9, "mouthLeft": 0.3},
    "jaw_right": {"jawRight": 0.9, "mouthRight": 0.3},
    "grin": {
        "mouthSmile": 0.8, "mouthStretch": 0.4, "mouthUpperUp": 0.5, "mouthLowerDown": 0.5,
        "cheekSquint": 0.3,
    },
    "chin_raise": {"mouthShrugLower": 0.9, "mouthShrugUpper": 0.5, "mouthFrown": 0.3},
    "lip_pucker": {"mouthPucker": 0.9},
    "lip_funnel": {"mouthFunnel": 0.9, "jawOpen": 0.15},
    "cheek_blowing": {"cheekPuff": 0.9, "mouthPress": 0.2},
    "eyes_closed": {"eyeBlink": 1.0},
}  # fmt: skip

#: Between the name of a set of more pictures and that of the shot that it repeats.
SET_MARK = "~"

#: What the person is asked to do.
REQUESTS: dict[str, str] = {
    "neutral": "Relax your face, lips closed, eyes open",
    "mouth_stretch": "Open your mouth as wide as you can",
    "smile": "Smile broadly with your lips closed",
    "brow_raise": "Raise both eyebrows as high as you can",
    "disgust": "Wrinkle your nose and raise your upper lip, as at a bad smell",
    "squeeze_left_eye": "Squeeze your left eye shut",
    "squeeze_right_eye": "Squeeze your right eye shut",
    "anger": "Look angry: eyebrows down and together, lips pressed",
    "jaw_left": "Move your lower jaw to your left",
    "jaw_right": "Move your lower jaw to your right",
    "grin": "Grin: show your teeth, upper and lower",
    "chin_raise": "Push your chin and lower lip up",
    "lip_pucker": "Pucker your lips as for a kiss",
    "lip_funnel": "Push your lips forward and round, as for a long “oo”",
    "cheek_blowing": "Blow up both cheeks, lips closed",
    "eyes_closed": "Close both eyes gently",
}


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """One picture that the user is asked for.

    Attributes:
        name: File stem of the picture, e.g. "smile_yaw+30".
        yaw: Head angle in rad, positive to the subject's left.
        pitch: Head angle in rad, positive up.
        roll: Head angle in rad, positive towards the subject's left shoulder.
        expression_name: A key of STANDARD_WEIGHTS.
        standard: (B,) standard coefficients a* [Cao13, eq. 7].
        instruction: What to tell the user.
    """

    name: str
    yaw: float
    pitch: float
    roll: float
    expression_name: str
    standard: FloatArray
    instruction: str

    def __post_init__(self) -> None:
        freeze(self, standard=(np.float64, ("B",)))


def coefficients(weights: dict[str, float]) -> FloatArray:
    """Return coefficients (B,) from names with or without a side.

    Raises:
        ValueError: A name is not one of EXPRESSION_NAMES nor a pair of them.
    """
    out = np.zeros(len(EXPRESSION_NAMES))
    for name, weight in weights.items():
        meant = {name, name + "Left", name + "Right"}
        found = [index for index, known in enumerate(EXPRESSION_NAMES) if known in meant]
        if not found:
            raise ValueError(f"no expression is called {name}")
        out[found] = weight
    return out


def set_of(stem: str) -> str:
    """Return the set of more pictures that a file stem belongs to, "" for a first one."""
    return stem.rpartition(SET_MARK)[0]


def shot_of(stem: str) -> Shot | None:
    """Return the shot that a file stem repeats, None if it is none.

    Pictures added later are named by their set and the shot: "glasses~smile_yaw+0".
    """
    name = stem.rpartition(SET_MARK)[2]
    return next((shot for shot in SHOTS if shot.name == name), None)


def standard_for(stem: str) -> FloatArray:
    """Return the coefficients a* (B,) of the shot with this file stem, NaN if it is no shot."""
    shot = shot_of(stem)
    return np.full(len(EXPRESSION_NAMES), np.nan) if shot is None else shot.standard


def _turn_words(yaw_deg: int, pitch_deg: int, roll_deg: int) -> str:
    if yaw_deg:
        side = "left" if yaw_deg > 0 else "right"
        return f"turn your head {abs(yaw_deg)}° to your {side}"
    if pitch_deg:
        return f"tilt your head {abs(pitch_deg)}° {'up' if pitch_deg > 0 else 'down'}"
    if roll_deg:
        side = "left" if roll_deg > 0 else "right"
        return f"lean your head {abs(roll_deg)}° towards your {side} shoulder"
    return "look straight into the camera"


def _shot(prefix: str, expression_name: str, axis: str, angle_deg: int) -> Shot:
    degrees = {"yaw": 0, "pitch": 0, "roll": 0} | {axis: angle_deg}
    turn = _turn_words(degrees["yaw"], degrees["pitch"], degrees["roll"])
    yaw, pitch, roll = (float(np.deg2rad(degrees[name])) for name in ("yaw", "pitch", "roll"))
    return Shot(
        f"{prefix}_{axis}{angle_deg:+d}", yaw, pitch, roll, expression_name,
        coefficients(STANDARD_WEIGHTS[expression_name]),
        f"{REQUESTS[expression_name]}, and {turn}.",
    )  # fmt: skip


def _shots() -> tuple[Shot, ...]:
    poses = [("yaw", angle) for angle in range(-90, 91, 30)]
    poses += [(axis, angle) for axis in ("pitch", "roll") for angle in (-30, -15, 15, 30)]
    shots = [_shot("pose", "neutral", axis, angle) for axis, angle in poses]
    for name in STANDARD_WEIGHTS:
        if name != "neutral":
            shots += [_shot(name, name, "yaw", angle) for angle in (-30, 0, 30)]
    return tuple(shots)


#: The shots in the order of the prompts.
SHOTS: tuple[Shot, ...] = _shots()
