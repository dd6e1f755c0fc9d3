"""Keeps a camera from changing its exposure, focus and white balance by itself.

Light and colour that drift from picture to picture make a worse regressor, so the setup asks the
camera to stay as it is. OpenCV passes such wishes on as well as each system lets it:

* Linux (V4L2): menu values as the driver has them: automatic exposure is 3 (aperture priority),
  by hand is 1; the exposure itself counts in 0.1 ms. It is often not known while it is automatic,
  so we search for the one that leaves the picture as bright as it was.
* Windows (DirectShow): 1 is automatic, 0 by hand; the exposure is a power of two of seconds. What
  is set cannot always be read back: then -1 is read.
* macOS (AVFoundation): OpenCV lets nobody tell the camera anything.
"""

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2

EXPOSURE, FOCUS, WHITE_BALANCE = "exposure", "focus", "white balance"
#: What is read where a value is not known.
UNKNOWN = -1.0
#: The picture may become so much brighter or darker, as a natural logarithm, by being held.
SAME_LEVEL = 0.12
#: A step of the exposure on Windows is a factor of two.
SAME_LEVEL_COARSE = 0.3
#: Tries to find the exposure; share of an exposure's logarithm that pictures show, see gamma.
TRIES, GAMMA = 8, 0.6


@dataclass(frozen=True, slots=True)
class Knob:
    """One setting of a camera.

    Attributes:
        name: For people.
        switch: OpenCV's property that makes it automatic.
        value: OpenCV's property of the setting itself.
        by_hand: What turns the switch off.
        automatic: What turns it on, if it is not known how it was.
    """

    name: str
    switch: int
    value: int
    by_hand: float
    automatic: float


@dataclass(frozen=True, slots=True)
class Held:
    """What became of the wish to hold a setting.

    Attributes:
        knob: The setting.
        held: Whether it is held.
        value: What it is held at, UNKNOWN if that cannot be read.
        before: Position of the switch before.
    """

    knob: Knob
    held: bool
    value: float
    before: float


def knobs(system: str = sys.platform) -> tuple[Knob, ...]:
    """Return the settings that OpenCV can reach on a system; on some they are refused."""
    by_hand, automatic = (1.0, 3.0) if system == "linux" else (0.0, 1.0)
    return (
        Knob(
            EXPOSURE, cv2.CAP_PROP_AUTO_EXPOSURE, cv2.CAP_PROP_EXPOSURE, by_hand, automatic
        ),
        Knob(FOCUS, cv2.CAP_PROP_AUTOFOCUS, cv2.CAP_PROP_FOCUS, 0.0, 1.0),
        Knob(WHITE_BALANCE, cv2.CAP_PROP_AUTO_WB, cv2.CAP_PROP_WB_TEMPERATURE, 0.0, 1.0),
    )  # fmt: skip


def hold(device: Any, level: Callable[[], float], system: str = sys.platform) -> tuple[Held, ...]:
    """Hold what can be held, at what the camera has chosen by itself.

    Args:
        device: Like cv2.VideoCapture, open.
        level: Reads some frames, and returns how bright the last one is, in grey levels.
        system: As sys.platform has it.
    """
    done = []
    for knob in knobs(system):
        wanted = level() if knob.name == EXPOSURE else 0.0
        held = _switched_off(device, knob)
        if held.held and knob.name == EXPOSURE:
            held = _as_bright(device, held, level, wanted, coarse=system != "linux")
        done.append(held)
    return tuple(done)


def hold_again(device: Any, held: Sequence[Held]) -> None:
    """Hold a camera that was opened anew as it was held before."""
    for one in held:
        if one.held:
            device.set(one.knob.switch, one.knob.by_hand)
            if one.value != UNKNOWN:
                device.set(one.knob.value, one.value)


def release(device: Any, held: Sequence[Held]) -> None:
    """Let the camera choose by itself again."""
    for one in held:
        if one.held:
            device.set(one.knob.switch, one.before)


def told(held: Sequence[Held]) -> str:
    """Return what is held and what is not, for people."""
    kept = [one.knob.name for one in held if one.held]
    refused = [one.knob.name for one in held if not one.held]
    text = f"Held still: {_listed(kept)}." if kept else "Nothing could be held still."
    if refused:
        text += f" This camera does not let itself be told its {_listed(refused)}."
    return text


def _switched_off(device: Any, knob: Knob) -> Held:
    """Turn a knob's switch off; the setting stays where it is, as far as the driver is sane."""
    before = float(device.get(knob.switch))
    # By hand already: most likely left so by a program that was killed, perhaps this one.
    was = before if before not in (knob.by_hand, UNKNOWN, 0.0) else knob.automatic
    value = float(device.get(knob.value))
    accepted = bool(device.set(knob.switch, knob.by_hand))
    now = float(device.get(knob.switch))
    held = accepted and (abs(now - knob.by_hand) < 0.01 or now == UNKNOWN)
    if accepted and not held:
        device.set(knob.switch, was)
    return Held(knob, held, value if value > 0 or knob.name == EXPOSURE else UNKNOWN, was)


def _as_bright(
    device: Any, held: Held, level: Callable[[], float], wanted: float, coarse: bool
) -> Held:
    """Search for the exposure that leaves the picture as bright as it was; else let go."""
    value, allowed = held.value, SAME_LEVEL_COARSE if coarse else SAME_LEVEL
    device.set(held.knob.value, value)
    for _ in range(TRIES):
        off = math.log(max(wanted, 1.0) / max(level(), 1.0))
        if abs(off) < allowed:
            return replace(held, value=value)
        value = _nudged(value, off / GAMMA, coarse)
        device.set(held.knob.value, value)
    device.set(held.knob.switch, held.before)
    return replace(held, held=False)


def _nudged(value: float, log_factor: float, coarse: bool) -> float:
    """Return an exposure that lets in more light by about this factor's logarithm."""
    if coarse:
        step = round(log_factor / math.log(2))
        return value + (step or math.copysign(1, log_factor))
    factor = math.exp(min(max(log_factor, -1.5), 1.5))
    changed = round(max(value, 1.0) * factor)
    return float(changed if changed != value else value + math.copysign(1, log_factor))


def _listed(names: Sequence[str]) -> str:
    return " and ".join((", ".join(names[:-1]), names[-1])) if len(names) > 1 else "".join(names)
