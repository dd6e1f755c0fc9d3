"""What the user may choose about an avatar's picture: view, background, lights. Plain values."""

import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

#: What may be behind the figure; "key" is one pure colour up to the figure's edge.
BACKGROUNDS = ("studio", "transparent", "color", "picture", "key", "blurred")
#: How much of the figure fills the picture.
FRAMINGS = ("shoulders", "bust", "close")
#: Samples per pixel that may be asked for; what a graphics card gives may be less.
SAMPLES = (0, 2, 4, 8)

Color = tuple[int, int, int]

#: Limits of the numbers: name -> least, greatest.
LIMITS = {
    "yaw_rad": (-math.pi, math.pi),
    # From further below, clothes would be seen from inside.
    "pitch_rad": (-0.6, 1.2),
    "zoom": (0.4, 6.0),
    "pan": (-1.5, 1.5),
    "brightness": (0.3, 2.0),
}


@dataclass(frozen=True, slots=True)
class Background:
    """What is behind the figure.

    Attributes:
        kind: One of BACKGROUNDS.
        color: (red, green, blue) in 0..255 of the kind "color".
        key: The same of the kind "key".
        picture: Path of the image file of the kind "picture".
    """

    kind: str = "studio"
    color: Color = (70, 92, 112)
    key: Color = (0, 255, 0)
    picture: str = ""

    def changed(self, **values: Any) -> "Background":
        """Return this background with some values replaced."""
        return replace(self, **values)


@dataclass(frozen=True, slots=True)
class AvatarLook:
    """How an avatar's picture is taken; the defaults are what is shown without any choice.

    Attributes:
        yaw_rad: Way of the camera round the figure, positive to the figure's left.
        pitch_rad: Way of the camera up over the figure.
        zoom: Enlargement.
        pan: Shift of the figure to the right and down, in heights of the picture.
        framing: One of FRAMINGS.
        background: What is behind the figure.
        lights: A key of app.render.lights.LIGHTS.
        brightness: Factor on all lights.
        mirrored: The figure does what a mirror image would do: who raises the right brow sees the
            brow on the right of the picture go up. Background and lights stay as they are.
        samples: Samples per pixel that are asked for, one of SAMPLES.
    """

    yaw_rad: float = 0.0
    pitch_rad: float = 0.0
    zoom: float = 1.0
    pan: tuple[float, float] = (0.0, 0.0)
    framing: str = "shoulders"
    background: Background = field(default_factory=Background)
    lights: str = "studio"
    brightness: float = 1.0
    mirrored: bool = False
    samples: int = 4

    def changed(self, **values: Any) -> "AvatarLook":
        """Return this look with some values replaced."""
        return replace(self, **values)

    def seen_as_at_first(self) -> "AvatarLook":
        """Return this look without orbit, zoom and pan."""
        return replace(self, yaw_rad=0.0, pitch_rad=0.0, zoom=1.0, pan=(0.0, 0.0))

    def turned(self, right_rad: float, down_rad: float) -> "AvatarLook":
        """Return this look with the figure's front turned to the picture's right, and down."""
        yaw = self.yaw_rad + (right_rad if self.mirrored else -right_rad)
        yaw = (yaw + math.pi) % (2 * math.pi) - math.pi
        return replace(self, yaw_rad=yaw, pitch_rad=within("pitch_rad", self.pitch_rad + down_rad))

    def panned(self, right: float, down: float) -> "AvatarLook":
        """Return this look with the figure shifted, in heights of the picture."""
        return replace(self, pan=(within("pan", self.pan[0] + right),
                                  within("pan", self.pan[1] + down)))  # fmt: skip

    def zoomed(self, factor: float, right: float = 0.0, down: float = 0.0) -> "AvatarLook":
        """Return this look enlarged about a place in the picture, which stays where it is.

        Args:
            factor: Of the enlargement.
            right: Of the place, from the picture's middle, in heights of the picture.
            down: The same.
        """
        zoom = within("zoom", self.zoom * factor)
        grown = zoom / self.zoom
        moved = [at - (at - pan) * grown for at, pan in zip((right, down), self.pan, strict=True)]
        return replace(self, zoom=zoom, pan=(within("pan", moved[0]), within("pan", moved[1])))

    def to_json(self) -> dict[str, Any]:
        """Return the values as plain JSON."""
        return asdict(self)


def look_from_json(values: Any, lights: Iterable[str]) -> AvatarLook:
    """Return the look that JSON describes; what is missing or makes no sense has its default.

    Args:
        values: What `AvatarLook.to_json` gave, perhaps by another version, perhaps edited.
        lights: Names of lights that there are.
    """
    found = values if isinstance(values, dict) else {}
    base, back = AvatarLook(), Background()
    behind = found.get("background")
    behind = behind if isinstance(behind, dict) else {}
    background = Background(
        _one_of(behind.get("kind"), BACKGROUNDS, back.kind),
        _color(behind.get("color"), back.color),
        _color(behind.get("key"), back.key),
        behind["picture"] if isinstance(behind.get("picture"), str) else back.picture,
    )
    numbers = {
        one.name: _number(found.get(one.name), one.name, getattr(base, one.name))
        for one in fields(AvatarLook)
        if one.name in LIMITS and one.name != "pan"
    }
    return AvatarLook(
        pan=_pan(found.get("pan")),
        framing=_one_of(found.get("framing"), FRAMINGS, base.framing),
        background=background,
        lights=_one_of(found.get("lights"), tuple(lights), base.lights),
        mirrored=found.get("mirrored") is True,
        samples=_one_of(found.get("samples"), SAMPLES, base.samples),
        **numbers,
    )


def within(name: str, value: float) -> float:
    """Return a number moved into its LIMITS."""
    least, greatest = LIMITS[name]
    return min(max(value, least), greatest)


def _one_of(value: Any, known: tuple[Any, ...], default: Any) -> Any:
    # True is 1 and 4.0 is 4 for Python; a look holds what is known, not what equals it.
    return next((one for one in known if one == value and type(one) is type(value)), default)


def _number(value: Any, name: str, default: float) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return default
    return within(name, float(value))


def _pan(value: Any) -> tuple[float, float]:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        return 0.0, 0.0
    return _number(value[0], "pan", 0.0), _number(value[1], "pan", 0.0)


def _color(value: Any, default: Color) -> Color:
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        return default
    if not all(type(one) is int and 0 <= one <= 255 for one in value):
        return default
    return value[0], value[1], value[2]
