"""The setup session: the 60 prompted poses, done the way people do them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.performer import acts
from app.performer.curves import BLINK_CLOSED_S, BLINK_CLOSING_S, BLINK_OPENING_S, pulse, through
from app.performer.takes import Take, animate
from core.records import FloatArray
from core.setup_plan import SHOTS, Shot

#: Seconds to get into a pose, to hold it, and into the hold when the picture is taken.
MOVE_S, HOLD_S, PICTURE_S = 0.8, 0.8, 0.45
_ANGLE_ERROR_RAD = np.deg2rad(3.0)
_SHIFT_ERROR_MM = np.array([14.0, 6.0, 22.0])


@dataclass(frozen=True, slots=True, eq=False)
class PromptedTake:
    """A setup session on film.

    Attributes:
        take: The whole session.
        names: N names of shots, in the order of the prompts.
        times_s: (N,) when each shot's picture is taken.
    """

    take: Take
    names: tuple[str, ...]
    times_s: FloatArray


def setup_take(seed: int = 0, shots: Sequence[Shot] = SHOTS) -> PromptedTake:
    """Return the session in which the performer follows the prompts.

    The poses are not what was asked for: angles are off by some degrees, expressions made at 70
    to 100 % with one side stronger and a little of others mixed in, and the body shifts.
    """
    rng = np.random.default_rng([seed, *b"setup"])
    poses = [_attempt(shot, rng) for shot in shots]
    starts_s = np.asarray(0.3 + np.arange(len(poses)) * (MOVE_S + HOLD_S), np.float64)
    knots, path = [0.0], [np.zeros_like(poses[0])]
    for start, pose in zip(starts_s, poses, strict=True):
        knots += [start, start + MOVE_S]
        path += [path[-1], pose]
    end = float(starts_s[-1]) + MOVE_S + HOLD_S
    times = acts.grid(end + MOVE_S + 0.3)
    knots += [end, end + MOVE_S, end + MOVE_S + 1]
    moved = through(times, np.array(knots), np.array([*path, path[-1], path[0], path[0]]))
    act = acts.Act(np.clip(moved[:, :-6], 0, 1), moved[:, -6:-3], moved[:, -3:])
    take = animate("setup", act, _lids(times, starts_s, rng), rng, liveliness=0.35)
    names = tuple(shot.name for shot in shots)
    return PromptedTake(take, names, np.asarray(starts_s + MOVE_S + PICTURE_S, np.float64))


def _attempt(shot: Shot, rng: np.random.Generator) -> FloatArray:
    """Return (B + 6,) expression, head angles and shift that a person makes of a prompt."""
    strength = rng.uniform(0.7, 1.0) * rng.normal(1.0, 0.05, len(shot.standard))
    stray = np.clip(rng.normal(-0.06, 0.05, len(shot.standard)), 0, 0.1)
    # A stray mouthClose with a shut jaw would push one lip through the other.
    stray *= 1 - acts.weights({"mouthClose": 1.0})
    expression = np.clip(shot.standard * strength + stray, 0, 1)
    lids = acts.weights({"eyeBlink": 1.0}) > 0
    # Nobody shuts an eye by four fifths when asked to shut it.
    expression[lids] = np.where(shot.standard[lids] > 0.9, rng.uniform(0.95, 1.0), 0)
    head = np.array([shot.yaw, shot.pitch, shot.roll]) + _ANGLE_ERROR_RAD * rng.normal(size=3)
    shift = _SHIFT_ERROR_MM * rng.normal(size=3)
    return np.concatenate([expression, head, shift])


def _lids(times_s: FloatArray, starts_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return (K,) blinks in about half of the moves from pose to pose, none while one is held."""
    closure = np.zeros(len(times_s))
    for start in starts_s[rng.random(len(starts_s)) < 0.5]:
        begin = float(start) + rng.uniform(0.0, 0.4)
        lids = pulse(times_s, begin, BLINK_CLOSING_S, BLINK_CLOSED_S, BLINK_OPENING_S)
        closure = np.maximum(closure, lids)
    return closure
