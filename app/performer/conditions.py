"""What makes a face harder to follow: things worn or held, and bad light. They can be combined."""

import numpy as np

from app.performer.sensor import SensorSettings
from app.render.scene import Lights
from core.records import U8

GLASSES, BEARD, FRINGE, HAND = "glasses", "beard", "fringe", "hand"
MICROPHONE, DIM = "microphone", "dim"
HAND_EYE, STROKE, CUP = "hand_eye", "stroke", "cup"
PASSER, NEIGHBOUR, POSTER = "passer", "neighbour", "poster"
SWITCH, HUNTING = "switch", "hunting"

#: What each condition is, for people.
CONDITIONS: dict[str, str] = {
    GLASSES: "dark rims and lenses that mirror a little",
    BEARD: "a full beard",
    FRINGE: "hair over forehead and brows",
    HAND: "a hand that comes, covers the mouth and goes, again and again",
    MICROPHONE: "a microphone before the chin",
    DIM: "little light, and the webcam's noise in it",
    HAND_EYE: "a hand that comes, covers the right eye and goes, again and again",
    STROKE: "a hand that strokes over nose and mouth, again and again",
    CUP: "a cup to drink from, again and again",
    PASSER: "somebody who passes between performer and webcam, again and again",
    NEIGHBOUR: "somebody who leans in beside the performer, nearer to the webcam",
    POSTER: "a poster with a large face on the wall",
    SWITCH: "light that is switched off and on, again and again",
    HUNTING: "a webcam that does not find the right exposure",
}
#: Those that last: worn, held or lit all the time, but for the hand.
LASTING = (GLASSES, BEARD, FRINGE, HAND, MICROPHONE, DIM)

#: Share of the light that is left, and of the picture of the room; a screen adds blue.
_LIGHT_LEFT, _ROOM_LEFT = 0.16, 0.42
_SCREEN_TINT = np.array([0.9, 1.0, 1.22])
#: A webcam in the dark: long exposure, much gain, and the compression eats what is left.
DIM_SENSOR = SensorSettings(
    exposure_s=1 / 31,
    softness_px=0.75,
    focus_breath_px=0.35,
    sharpening=0.15,
    read_noise=4.5,
    shot_noise=9.0,
    flicker=0.03,
    jpeg_quality=74,
)


def check_conditions(names: tuple[str, ...]) -> None:
    """Check that all conditions exist and none is given twice.

    Raises:
        ValueError: One does not exist, or is there twice.
    """
    for name in names:
        if name not in CONDITIONS:
            raise ValueError(f"no condition is called {name!r}; there are {', '.join(CONDITIONS)}")
        if names.count(name) > 1:
            raise ValueError(f"the condition {name!r} is given twice; once is enough")


def dimmed(lights: Lights) -> Lights:
    """Return what is left of the lights in a dark room before a screen."""
    left = _LIGHT_LEFT * _SCREEN_TINT
    return Lights(
        lights.directions,
        lights.colors * left,
        lights.ambient_above * left,
        lights.ambient_below * left,
    )


def dimmed_room(room: U8) -> U8:
    """Return the room (H, W, 3) in the dark."""
    dark = room * (_ROOM_LEFT * np.sqrt(_SCREEN_TINT))
    return np.asarray(np.clip(dark, 0, 255).astype(np.uint8))
