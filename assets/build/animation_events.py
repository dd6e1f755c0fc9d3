"""Animation from events: coefficients that rise, stay and fall, and speech that blends visemes.

An event has an onset, an apex and an offset of its own durations, with minimum-jerk flanks as
measured in faces. Speech follows Cohen and Massaro: every sound pulls towards its viseme with a
dominance that rises before and falls after it, so neighbours blend (co-articulation).
"""

from dataclasses import dataclass

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.records import FloatArray


def targets(**amounts: float) -> FloatArray:
    """Return coefficients (46,) by name; a name without its side sets both sides."""
    out = np.zeros(len(EXPRESSION_NAMES))
    for name, amount in amounts.items():
        sides = [name] if name in EXPRESSION_NAMES else [name + "Left", name + "Right"]
        for side in sides:
            out[EXPRESSION_NAMES.index(side)] = amount
    return out


@dataclass(frozen=True, slots=True)
class Event:
    """One movement.

    Attributes:
        start_s: When it leaves rest.
        rise_s: Duration of the onset.
        hold_s: Duration of the apex.
        fall_s: Duration of the offset.
        target: (46,) coefficients at the apex.
    """

    start_s: float
    rise_s: float
    hold_s: float
    fall_s: float
    target: FloatArray

    @property
    def end_s(self) -> float:
        """When it is back at rest."""
        return self.start_s + self.rise_s + self.hold_s + self.fall_s


def minimum_jerk(phase: FloatArray) -> FloatArray:
    """Return 0 -> 1 along the smoothest path; phase is clipped to [0, 1]."""
    p = np.clip(phase, 0.0, 1.0)
    return np.asarray(p**3 * (10 - 15 * p + 6 * p**2))


def play(events: list[Event], times_s: FloatArray) -> FloatArray:
    """Return coefficients (N, 46) of all events added up, not yet clipped."""
    out = np.zeros((times_s.size, len(EXPRESSION_NAMES)))
    for event in events:
        first, last = np.searchsorted(times_s, [event.start_s, event.end_s])
        since = times_s[first:last] - event.start_s
        onset = minimum_jerk(since / event.rise_s)
        offset = minimum_jerk((since - event.rise_s - event.hold_s) / event.fall_s)
        out[first:last] += (onset - offset)[:, None] * event.target
    return out


def speak(
    centers_s: FloatArray, visemes: FloatArray, widths_s: FloatArray, times_s: FloatArray
) -> FloatArray:
    """Return coefficients (N, 46) of a chain of sounds.

    Args:
        centers_s: (M,) when each sound is at its clearest.
        visemes: (M, 46) what each pulls towards.
        widths_s: (M,) standard deviation of each sound's dominance.
        times_s: (N,).
    """
    distance = (times_s[:, None] - centers_s) / widths_s
    dominance = np.exp(-0.5 * distance**2)
    # Silence pulls gently all the time, so the mouth rests where no sound is near.
    return np.asarray(dominance @ visemes / (dominance.sum(axis=1, keepdims=True) + 0.08))


def wander(
    rng: np.random.Generator, times_s: FloatArray, amplitude: float, correlation_s: float
) -> FloatArray:
    """Return slow random drifts (N, 46) of the given standard deviation."""
    knots_s = np.arange(times_s[0], times_s[-1] + 2 * correlation_s, correlation_s)
    values = amplitude * rng.standard_normal((knots_s.size, len(EXPRESSION_NAMES)))
    index = np.searchsorted(knots_s, times_s, side="right") - 1
    phase = (times_s - knots_s[index]) / correlation_s
    weight = minimum_jerk(phase)[:, None]
    return np.asarray(values[index] * (1 - weight) + values[index + 1] * weight)
