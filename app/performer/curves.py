"""Timing curves: how a body gets from one pose to the next.

All curves are sampled on a grid of times, in s, that the caller chooses.
"""

import numpy as np

from core.records import FloatArray

#: Phases of a blink: the lid falls fast, rests shortly and rises slowly.
BLINK_CLOSING_S, BLINK_CLOSED_S, BLINK_OPENING_S = 0.075, 0.035, 0.15


def minimum_jerk(share: FloatArray) -> FloatArray:
    """Return the way covered, 0 to 1, after a share of the time of a smooth movement.

    The quintic with zero velocity and acceleration at both ends, which human reaching follows
    [Flash and Hogan 1985].
    """
    u = np.clip(np.asarray(share, float), 0.0, 1.0)
    return np.asarray(u**3 * (10 - 15 * u + 6 * u * u))


def through(times_s: FloatArray, knots_s: FloatArray, poses: FloatArray) -> FloatArray:
    """Return poses (K, D) on a path that rests shortly at each of the given ones.

    Args:
        times_s: (K,) the grid.
        knots_s: (P,) increasing times of the given poses.
        poses: (P, D). Two equal ones in a row are a hold.
    """
    knots, values = np.asarray(knots_s, float), np.asarray(poses, float)
    after = np.clip(np.searchsorted(knots, times_s, side="right"), 1, len(knots) - 1)
    begin, end = knots[after - 1], knots[after]
    way = minimum_jerk((times_s - begin) / (end - begin))[:, None]
    return np.asarray(values[after - 1] + way * (values[after] - values[after - 1]))


def pulse(
    times_s: FloatArray, start_s: float, rise_s: float, hold_s: float, fall_s: float
) -> FloatArray:
    """Return (K,) 0 to 1 and back: a rise, a hold and a fall."""
    up = minimum_jerk((times_s - start_s) / rise_s)
    down = minimum_jerk((times_s - start_s - rise_s - hold_s) / fall_s)
    return np.asarray(up - down)


def wander(times_s: FloatArray, rng: np.random.Generator, periods_s: FloatArray) -> FloatArray:
    """Return (K,) an idle drift of about unit size that comes back to its start at the end.

    Periods are rounded so that a whole number of them fills the grid; a take can then be
    played in a loop without a jump.

    Args:
        times_s: (K,) the grid.
        rng: Source of phases and sizes.
        periods_s: Wanted periods of the waves that are added.
    """
    duration = float(times_s[-1] - times_s[0])
    total = np.zeros(len(times_s))
    for period in np.asarray(periods_s, float):
        cycles = max(1, round(duration / period * rng.uniform(0.85, 1.15)))
        phase = rng.uniform(0, 2 * np.pi)
        wave = np.sin(2 * np.pi * cycles * (times_s - times_s[0]) / duration + phase)
        total += rng.uniform(0.6, 1.0) * (wave - np.sin(phase))
    return np.asarray(total / max(1.0, np.sqrt(len(periods_s))))


def blinks(times_s: FloatArray, rng: np.random.Generator, mean_gap_s: float) -> FloatArray:
    """Return (K,) lid closure, 0 open and 1 shut, with blinks at irregular times."""
    closure = np.zeros(len(times_s))
    length = BLINK_CLOSING_S + BLINK_CLOSED_S + BLINK_OPENING_S
    start = float(times_s[0] + rng.uniform(0.2, 1.0) * mean_gap_s)
    while start + 2 * length < times_s[-1]:
        depth = rng.uniform(0.9, 1.0)
        phases = (BLINK_CLOSING_S, BLINK_CLOSED_S, BLINK_OPENING_S * rng.uniform(0.9, 1.5))
        closure = np.maximum(closure, depth * pulse(times_s, start, *phases))
        # Now and then people blink twice in a row.
        gap = 0.1 if rng.random() < 0.12 else rng.gamma(3.0, mean_gap_s / 3.0)
        start += length + gap
    return closure


def saccades(times_s: FloatArray, rng: np.random.Generator, size_rad: FloatArray) -> FloatArray:
    """Return (K, 2) yaw and pitch of a gaze that jumps between fixations, 0 at both ends.

    Args:
        times_s: (K,) the grid.
        rng: Source of fixations.
        size_rad: (2,) standard deviation of the fixations about straight ahead.
    """
    knots, poses = [float(times_s[0])], [np.zeros(2)]
    here, time = np.zeros(2), float(times_s[0])
    while True:
        time += 0.15 + rng.gamma(2.0, 0.45)
        # Most fixations return to the screen.
        there = rng.normal(size=2) * size_rad * (1.0 if rng.random() < 0.4 else 0.25)
        # The main sequence: 2.2 ms per degree and 21 ms more.
        flight = 0.021 + 0.0022 * float(np.rad2deg(np.linalg.norm(there - here)))
        if time + flight > times_s[-1] - 0.4:
            break
        knots += [time, time + flight]
        poses += [here, there]
        here, time = there, time + flight
    last = float(times_s[-1])
    return through(
        times_s,
        np.array([*knots, last - 0.2, last - 0.15, last]),
        np.array([*poses, here, np.zeros(2), np.zeros(2)]),
    )
