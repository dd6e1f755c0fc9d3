"""Puts a performance together from names: what the command line and the window ask for."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from app.avatars.wardrobe import load_wardrobe
from app.performer.conditions import (
    CONDITIONS,
    DIM,
    DIM_SENSOR,
    HUNTING,
    SWITCH,
    check_conditions,
    dimmed,
    dimmed_room,
)
from app.performer.events import hunting_gain, switching_gain
from app.performer.guests import other_than
from app.performer.lights import LIGHTS
from app.performer.people import CAST, load_person
from app.performer.performer import FPS, Filming, VirtualPerformer
from app.performer.prompts import setup_take
from app.performer.room import paint_room
from app.performer.sensor import SensorSettings
from app.performer.stage import Setting
from app.performer.takes import TAKES, Take, make_take
from app.resources import asset
from core.camera import camera_for
from core.evaluation import Truth
from core.face_model import load_face_model
from core.records import Frame

#: Focal lengths of a wide, a usual and a narrow webcam at 640x480.
FOCAL_LENGTHS_PX = (520.0, 620.0, 760.0)
#: The name of the take in which the prompts of the setup are followed.
SETUP = "setup"
TAKE_NAMES: tuple[str, ...] = (*TAKES, SETUP)
PEOPLE: tuple[str, ...] = tuple(CAST)
LIGHT_NAMES: tuple[str, ...] = tuple(LIGHTS)
CONDITION_NAMES: tuple[str, ...] = tuple(CONDITIONS)


@dataclass(frozen=True, slots=True)
class Scenario:
    """Who does what in front of which webcam.

    Attributes:
        take: One of TAKE_NAMES.
        person: One of PEOPLE.
        light: One of LIGHT_NAMES.
        focal_px: Focal length of the webcam for pictures 640 wide.
        size_px: (width, height) of the pictures.
        seed: Of the take's details, the room and the noise.
        conditions: Some of CONDITION_NAMES: what the person wears or holds, bad light.
    """

    take: str = "mixed"
    person: str = "mara"
    light: str = "window"
    focal_px: float = 620.0
    size_px: tuple[int, int] = (640, 480)
    seed: int = 0
    conditions: tuple[str, ...] = ()


def open_performer(
    scenario: Scenario | None = None, *, live: bool = False, loop: bool = False
) -> VirtualPerformer:
    """Return the source that plays a scenario.

    Args:
        scenario: What to play.
        live: Frames come by the clock, unread ones are lost; else as fast as they are read.
        loop: The take starts again when it ends.

    Raises:
        ValueError: A name in the scenario is not known.
        PeopleFileError: The performers cannot be read; FaceModelFileError, AvatarFileError alike.
    """
    scenario = scenario or Scenario()
    filming = Filming(scenario.seed, live, loop, sensor=_sensor(scenario))
    return _filmed(scenario, _take(scenario), filming)


def setup_pictures(scenario: Scenario | None = None) -> list[tuple[str, Frame, Truth]]:
    """Return the pictures of a setup session: name of the shot, frame, what is really there.

    Args:
        scenario: Who and where; its take does not matter.
    """
    scenario = scenario or Scenario()
    session = setup_take(scenario.seed)
    with _filmed(
        scenario, session.take, Filming(scenario.seed, sensor=_sensor(scenario))
    ) as performer:
        indices = [round(float(time_s) * FPS) for time_s in session.times_s]
        return _pictures(performer, session.names, indices)


def _pictures(
    performer: VirtualPerformer, names: Sequence[str], indices: Sequence[int]
) -> list[tuple[str, Frame, Truth]]:
    return [
        (name, performer.picture(index), performer.truth(index))
        for name, index in zip(names, indices, strict=True)
    ]


def _take(scenario: Scenario) -> Take:
    if scenario.take == SETUP:
        return setup_take(scenario.seed).take
    return make_take(scenario.take, scenario.seed)


def _filmed(scenario: Scenario, take: Take, filming: Filming) -> VirtualPerformer:
    if scenario.light not in LIGHTS:
        raise ValueError(f"no light is called {scenario.light!r}; there are {', '.join(LIGHTS)}")
    check_conditions(scenario.conditions)
    model = load_face_model(asset("face_model.npz"))
    focal_px = scenario.focal_px * scenario.size_px[0] / 640
    lights, room = LIGHTS[scenario.light], paint_room(scenario.size_px, scenario.seed)
    dim = DIM in scenario.conditions
    setting = Setting(
        model,
        load_person(asset("people.npz"), model, scenario.person),
        load_wardrobe(asset("."), model),
        camera_for(scenario.size_px, focal_px),
        dimmed(lights) if dim else lights,
        dimmed_room(room) if dim else room,
        scenario.conditions,
        (dimmed(lights), dimmed_room(room)) if SWITCH in scenario.conditions else None,
        load_person(asset("people.npz"), model, other_than(scenario.person)),
    )
    return VirtualPerformer(take, setting, filming)


def _sensor(scenario: Scenario) -> SensorSettings:
    usual = DIM_SENSOR if DIM in scenario.conditions else SensorSettings()
    gains = {SWITCH: switching_gain, HUNTING: hunting_gain}
    chosen = [gain for name, gain in gains.items() if name in scenario.conditions]
    return replace(usual, gain=chosen[-1]) if chosen else usual
