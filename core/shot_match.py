"""How well a face does what a prompt asks for."""

from dataclasses import dataclass

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.records import BoolArray, FloatArray
from core.setup_plan import Shot

#: Beyond this the face is lost to the network; such prompts are followed on trust.
LAST_SEEN_RAD = float(np.deg2rad(55))


@dataclass(frozen=True, slots=True)
class MatchSettings:
    """How exactly a prompt must be followed. The fit finds the true pose and expression.

    Attributes:
        angle_rad: Error of each head angle.
        angle_share: And this share of a large turn, which is both made and measured less exactly.
        share: Share of an asked coefficient that must be reached, for the strongest ones.
        other: A coefficient that is not asked for may go so far in a neutral prompt.
    """

    angle_rad: float = float(np.deg2rad(9))
    angle_share: float = 0.12
    share: float = 0.4
    other: float = 0.35


@dataclass(frozen=True, slots=True, eq=False)
class Match:
    """How far a face is from a prompt.

    Attributes:
        turn_rad: (3,) yaw, pitch and roll still to go: asked minus present.
        pose: Whether the head is right.
        expression: Whether the face roughly does what is asked.
        reached: Share of the asked expression, in [0, 1]; 1 where none is asked for.
    """

    turn_rad: FloatArray
    pose: bool
    expression: bool
    reached: float

    @property
    def good(self) -> bool:
        """Whether a picture may be taken."""
        return self.pose and self.expression


def head_angles(rotation_wxyz: FloatArray, rest_wxyz: FloatArray) -> FloatArray:
    """Return yaw, pitch, roll (3,) of a head against how this person looks straight ahead.

    Args:
        rotation_wxyz: (4,) head to camera.
        rest_wxyz: (4,) the same in the first picture, straight into the camera.
    """
    relative = matrix_from_quaternion(rest_wxyz).T @ matrix_from_quaternion(rotation_wxyz)
    return head_angles_from_matrix(relative)


def match(
    shot: Shot, angles_rad: FloatArray, expression: FloatArray,
    settings: MatchSettings | None = None,
) -> Match:  # fmt: skip
    """Compare a tracked face with a prompt.

    Args:
        shot: The prompt.
        angles_rad: (3,) yaw, pitch, roll of the head.
        expression: (B,) coefficients.
        settings: How exactly.
    """
    settings = settings or MatchSettings()
    asked = np.array([shot.yaw, shot.pitch, shot.roll])
    # The head is not seen turned further than this, so nobody can be asked to show more.
    asked[0] = np.clip(asked[0], -LAST_SEEN_RAD, LAST_SEEN_RAD)
    turn = asked - angles_rad
    beyond = abs(shot.yaw) > LAST_SEEN_RAD and np.sign(shot.yaw) * turn[0] < 0
    errors = np.abs(turn)
    if beyond:
        errors[0] = 0.0
    pose = bool(np.all(errors < settings.angle_rad + settings.angle_share * np.abs(asked)))
    reached = _reached(shot, expression)
    calm = bool(shot.standard.any() or np.max(expression[_FACE]) < settings.other)
    return Match(turn, pose, bool(reached >= settings.share) and calm, reached)


def follows_unseen(shot: Shot, last_angles_rad: FloatArray) -> bool:
    """Return whether a face that is no longer seen has turned away as a prompt asks.

    Args:
        shot: The prompt.
        last_angles_rad: (3,) when the face was last seen.
    """
    far = abs(shot.yaw) > LAST_SEEN_RAD
    return far and bool(np.sign(shot.yaw) * last_angles_rad[0] > np.deg2rad(35))


def is_visible(shot: Shot) -> bool:
    """Return whether landmarks show that a prompt's expression is made.

    Where they do not, people need time to make it.
    """
    return not shot.standard.any() or bool(np.any(_strongest(shot)))


#: What a neutral face must not do much; brows and lids differ too much from person to person.
_FACE = [
    index for index, name in enumerate(EXPRESSION_NAMES)
    if name in ("jawOpen", "mouthSmileLeft", "mouthSmileRight", "mouthPucker", "mouthFunnel")
]  # fmt: skip
#: Shapes that landmarks hardly show: nobody is held up by them.
_WEAK = [
    index for index, name in enumerate(EXPRESSION_NAMES)
    if name.startswith(("cheek", "noseSneer", "eyeSquint", "mouthPress", "eyeWide"))
]  # fmt: skip


def _strongest(shot: Shot) -> BoolArray:
    """Return which coefficients (B,) tell best whether the expression is made."""
    asked = shot.standard.copy()
    asked[_WEAK] = 0.0
    return np.asarray((asked > 0) & (asked >= 0.6 * asked.max()))


def _reached(shot: Shot, expression: FloatArray) -> float:
    """Return the share of the asked expression that is seen; what cannot be seen counts as done."""
    strongest = _strongest(shot)
    if not strongest.any():
        return 1.0
    return float(np.mean(np.clip(expression[strongest] / shot.standard[strongest], 0.0, 1.0)))
