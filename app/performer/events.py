"""What happens to a performer again and again, and when: shares of 0 (not at all) to 1 (wholly).

A round lasts ROUND_S. Everything begins after CALM_S: until then a tracker can get to know the
face.
"""

import numpy as np

from app.performer.curves import minimum_jerk

ROUND_S, CALM_S = 4.0, 1.2
#: Seconds of coming, staying and going.
_STROKE = (0.22, 0.08, 0.25)
_HOLD = (0.5, 1.8, 0.5)
_VISIT = (0.9, 1.2, 0.9)
#: When the light goes out and comes back, and how long the webcam needs to get used to either.
LIGHT_OFF_S, LIGHT_ON_S = 1.2, 2.7
_DARK_GAIN, _TO_DARK_S, _TO_LIGHT_S = 1.75, 0.5, 0.3
#: The exposure that hunts: its gains lie between these, and so many seconds apart.
_HUNT_GAINS, _HUNT_S = (0.45, 1.75), 1.7
#: Half the way of somebody who passes by, mm, and how long that takes.
PASSING_MM, PASSING_S = 560.0, 2.4


def held_share(time_s: float) -> float:
    """Return how far up something is that comes, stays before the face and goes."""
    return _pulse(time_s, _HOLD)


def stroke_share(time_s: float) -> float:
    """Return how far a quick hand is on its way to the nose; it goes back at once."""
    return _pulse(time_s, _STROKE)


def visit_share(time_s: float) -> float:
    """Return how far somebody has come into the picture who leans in from the side."""
    return _pulse(time_s, _VISIT)


def passing_mm(time_s: float) -> float:
    """Return where somebody is who passes from the picture's left to its right."""
    since = time_s % ROUND_S - CALM_S
    return PASSING_MM * float(np.clip(2 * since / PASSING_S - 1, -1, 1))


def light_is_on(time_s: float) -> bool:
    """Return whether the lamps that are switched are on."""
    return not LIGHT_OFF_S <= time_s % ROUND_S < LIGHT_ON_S


def switching_gain(time_s: float) -> float:
    """Return the gain of a webcam that gets used to the dark, and to the light again."""
    since = time_s % ROUND_S
    if since < LIGHT_OFF_S:
        return 1.0
    if light_is_on(time_s):
        dark = _DARK_GAIN + (1 - _DARK_GAIN) * np.exp((LIGHT_OFF_S - LIGHT_ON_S) / _TO_DARK_S)
        return float(1 + (dark - 1) * np.exp(-(since - LIGHT_ON_S) / _TO_LIGHT_S))
    return float(_DARK_GAIN + (1 - _DARK_GAIN) * np.exp((LIGHT_OFF_S - since) / _TO_DARK_S))


def hunting_gain(time_s: float) -> float:
    """Return the gain of a webcam that does not find the exposure, calm in the beginning."""
    if time_s < CALM_S:
        return 1.0
    low, high = np.log(_HUNT_GAINS)
    phase = 2 * np.pi * (time_s - CALM_S) / _HUNT_S
    size = high if np.sin(phase) > 0 else -low
    return float(np.exp(size * np.sin(phase)))


def _pulse(time_s: float, seconds: tuple[float, float, float]) -> float:
    """Return 0, a smooth rise to 1, a hold and a fall in each round."""
    come_s, stay_s, go_s = seconds
    since = time_s % ROUND_S - CALM_S
    up = minimum_jerk(np.array(since / come_s))
    down = minimum_jerk(np.array((since - come_s - stay_s) / go_s))
    return float(up - down)
