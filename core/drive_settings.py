"""Settings of the drive: how a solved face is made into what the avatar does.

Every number has its limits beside it; `core.drive_json` clamps to them and the control panel shows
them. The defaults leave a face as it was tracked, but steadier.
"""

from dataclasses import dataclass, field
from typing import Any

from core.arkit import EXPRESSION_NAMES
from core.records import FloatArray

#: Keys 1 to 9.
N_KEYS = 9


def number(default: float, low: float, high: float) -> Any:
    """Return a field that holds a number within limits."""
    return field(default=default, metadata={"low": low, "high": high})


def choice(default: str, *others: str) -> Any:
    """Return a field that holds one of a few words."""
    return field(default=default, metadata={"choices": (default, *others)})


@dataclass(frozen=True, slots=True)
class Steadiness:
    """How each group is filtered: 0 as steady as possible, 1 as tracked.

    Attributes:
        head: Turn and place of the head.
        brows: Brows.
        eyes: Lids and gaze.
        mouth: Everything else.
    """

    head: float = number(0.5, 0.0, 1.0)
    brows: float = number(0.5, 0.0, 1.0)
    eyes: float = number(0.5, 0.0, 1.0)
    mouth: float = number(0.5, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Response:
    """How one coefficient is passed on: gain * (value - low) / (high - low) + offset, in [0, 1].

    Attributes:
        gain: Factor.
        low: Tracked value that counts as 0.
        high: Tracked value that counts as 1.
        offset: Added at the end.
    """

    gain: float = number(1.0, 0.0, 4.0)
    low: float = number(0.0, 0.0, 0.9)
    high: float = number(1.0, 0.05, 1.0)
    offset: float = number(0.0, -1.0, 1.0)


@dataclass(frozen=True, slots=True)
class HeadMotion:
    """Factors of the head's movement from its centre.

    Attributes:
        yaw: Turning left and right.
        pitch: Nodding.
        roll: Leaning to a shoulder.
        x: Moving sideways.
        y: Moving up and down.
        z: Moving to and from the camera.
    """

    yaw: float = number(1.0, 0.0, 3.0)
    pitch: float = number(1.0, 0.0, 3.0)
    roll: float = number(1.0, 0.0, 3.0)
    x: float = number(1.0, 0.0, 3.0)
    y: float = number(1.0, 0.0, 3.0)
    z: float = number(1.0, 0.0, 3.0)


@dataclass(frozen=True, slots=True)
class Centring:
    """Whether the centre follows how the user sits and rests.

    Attributes:
        head: Turn and place of the head.
        face: The resting face.
        time_s: Time in which most of a lasting deviation is taken off.
    """

    head: bool = False
    face: bool = False
    time_s: float = number(45.0, 5.0, 600.0)


@dataclass(frozen=True, slots=True)
class EyeSettings:
    """How lids and gaze are passed on.

    Attributes:
        link_lids: "blinks": both lids move together except in a wink; "never"; "always".
        link_gaze: Both eyes look in one direction.
        own_levels: Open and closed mean what they are for this user.
        gaze_gain: Factor of the gaze.
        gaze_up_rad: Added to the gaze: eyes that seem to look too low are raised.
    """

    link_lids: str = choice("blinks", "never", "always")
    link_gaze: bool = False
    own_levels: bool = True
    gaze_gain: float = number(1.0, 0.0, 2.0)
    gaze_up_rad: float = number(0.0, -0.3, 0.3)


@dataclass(frozen=True, slots=True)
class IdleSettings:
    """What the avatar does by itself.

    Attributes:
        breathing: "lost": while no face is seen; "never"; "always".
        breath: Size of the breathing.
        blinking: The same for blinks.
        hold_s: Time for which a lost face is held.
        ease_s: Time in which it then goes to rest.
        back_s: Longest time in which it goes back to a face that is seen again.
    """

    breathing: str = choice("lost", "never", "always")
    breath: float = number(1.0, 0.0, 3.0)
    blinking: str = choice("lost", "never", "always")
    hold_s: float = number(0.5, 0.0, 10.0)
    ease_s: float = number(1.2, 0.1, 10.0)
    back_s: float = number(0.3, 0.05, 3.0)


@dataclass(frozen=True, slots=True)
class ExpressionKey:
    """A face that a key calls up.

    Attributes:
        name: For people.
        weights: (B,) coefficients in [0, 1].
        hold: Shown while the key is pressed; else one press shows it, the next takes it off.
        way: "add" to what is tracked, replace the "part" of the face that it uses, or the "face".
        fade_in_s: Time until it is fully there.
        fade_out_s: Time until it is gone.
    """

    name: str
    weights: tuple[float, ...]
    hold: bool = False
    way: str = choice("add", "part", "face")
    fade_in_s: float = number(0.2, 0.0, 5.0)
    fade_out_s: float = number(0.35, 0.0, 5.0)

    def __post_init__(self) -> None:
        if len(self.weights) != len(EXPRESSION_NAMES):
            raise ValueError(
                f"expression key {self.name!r} has {len(self.weights)} weights, expected "
                f"{len(EXPRESSION_NAMES)}, one for each of EXPRESSION_NAMES"
            )


@dataclass(frozen=True, slots=True)
class DriveSettings:
    """All settings of the drive.

    Attributes:
        steadiness: How each group is filtered.
        responses: (B,) of every coefficient.
        head: Factors of the head's movement.
        centring: Whether the centre follows the user.
        eyes: Lids and gaze.
        idle: What the avatar does by itself.
        keys: At most N_KEYS; the first is called by key 1.
    """

    steadiness: Steadiness = field(default_factory=Steadiness)
    responses: tuple[Response, ...] = (Response(),) * len(EXPRESSION_NAMES)
    head: HeadMotion = field(default_factory=HeadMotion)
    centring: Centring = field(default_factory=Centring)
    eyes: EyeSettings = field(default_factory=EyeSettings)
    idle: IdleSettings = field(default_factory=IdleSettings)
    keys: tuple[ExpressionKey, ...] = ()

    def __post_init__(self) -> None:
        if len(self.responses) != len(EXPRESSION_NAMES) or len(self.keys) > N_KEYS:
            raise ValueError(
                f"drive settings have {len(self.responses)} responses and {len(self.keys)} keys, "
                f"expected {len(EXPRESSION_NAMES)} and at most {N_KEYS}"
            )


def key_from(name: str, expression: FloatArray, hold: bool = False) -> ExpressionKey:
    """Return a key that shows a face (B,)."""
    weights = tuple(round(min(max(float(value), 0.0), 1.0), 3) for value in expression)
    return ExpressionKey(name, weights, hold)
