"""What the robustness study lets happen to the performer, and its films."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass

import numpy as np

from app.performer.conditions import (
    CUP,
    HAND,
    HAND_EYE,
    HUNTING,
    NEIGHBOUR,
    PASSER,
    POSTER,
    STROKE,
    SWITCH,
)
from app.performer.events import (
    PASSING_MM,
    held_share,
    light_is_on,
    passing_mm,
    stroke_share,
    visit_share,
)
from app.performer.opening import Scenario, open_performer
from core.camera import project
from core.evaluation import Truth
from core.landmarks import N_INTERNAL
from core.records import Camera, FloatArray, Frame, Progress

#: Somebody who passes is before the face from so near to it on.
_PASSING_BEFORE_MM = 0.3 * PASSING_MM

Share = Callable[[float], float]


@dataclass(frozen=True, slots=True)
class Event:
    """Something that makes a face hard to follow.

    Attributes:
        scenario: What the performer plays.
        share: How far it has come at a time; None: while the face is not wholly in the picture.
        frames: How many are filmed at most.
    """

    scenario: Scenario
    share: Share | None
    frames: int = 240


@dataclass(frozen=True, slots=True, eq=False)
class Filmed:
    """A film of an event.

    Attributes:
        frames: N frames.
        truths: What is really there.
        camera: The true one.
        shares: (N,) how far the event has come.
    """

    frames: Sequence[Frame]
    truths: Sequence[Truth]
    camera: Camera
    shares: FloatArray


def events(person: str) -> dict[str, Event]:
    """Return what happens, by name."""

    def talk(condition: str, share: Share) -> Event:
        return Event(Scenario("talking", person, seed=3, conditions=(condition,)), share)

    return {
        "nothing": Event(Scenario("talking", person, seed=3), _never),
        "hand over the mouth": talk(HAND, held_share),
        "hand over an eye": talk(HAND_EYE, held_share),
        "hand strokes the face": talk(STROKE, stroke_share),
        "cup": talk(CUP, held_share),
        "somebody passes before": talk(PASSER, _passer_share),
        "somebody leans in": talk(NEIGHBOUR, visit_share),
        "poster": talk(POSTER, _never),
        "light off and on": talk(SWITCH, lambda time_s: float(not light_is_on(time_s))),
        "exposure hunts": talk(HUNTING, _never),
        "shake": Event(Scenario("shake", person, seed=3), _never, 330),
        "leaves, comes back": Event(Scenario("leaving", person, seed=3), None, 330),
    }


def filmed(name: str, event: Event) -> Generator[Progress, None, Filmed]:
    """Film an event.

    Yields:
        Progress, once per frame.
    """
    frames: list[Frame] = []
    with open_performer(event.scenario) as source:
        total = min(event.frames, source.n_frames)
        while len(frames) < total and (frame := source.read()) is not None:
            frames.append(frame)
            yield Progress(len(frames), total, f"Filming: {name}")
        truths = [source.truth(n) for n in range(len(frames))]
        shares = _shares(event, frames, truths, source.camera)
        return Filmed(frames, truths, source.camera, shares)


def _shares(
    event: Event, frames: Sequence[Frame], truths: Sequence[Truth], camera: Camera
) -> FloatArray:
    if event.share is not None:
        return np.array([event.share(frame.time_s) for frame in frames])
    inside = []
    for truth in truths:
        points = project(camera, truth.points_mm[:N_INTERNAL])
        inside.append(bool(np.all((points > 0) & (points < np.array(camera.size_px)))))
    return 1.0 - np.array(inside, float)


def _never(time_s: float) -> float:
    return 0.0


def _passer_share(time_s: float) -> float:
    """Return 1 while somebody covers the face, less while they are only in the picture."""
    away = abs(passing_mm(time_s))
    return 0.0 if away >= 0.99 * PASSING_MM else 1.0 if away < _PASSING_BEFORE_MM else 0.5
