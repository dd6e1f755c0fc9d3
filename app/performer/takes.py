"""Takes: acts joined, with blinks, gaze and idle sway added, as functions of time."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.performer import acts
from app.performer.acts import Act
from app.performer.curves import blinks, saccades, wander
from app.performer.measured import asymmetric, head_motion, statue
from core.arkit import EXPRESSION_NAMES
from core.geometry import matrix_from_head_angles
from core.records import FloatArray, freeze

#: The eyes turn this far in the head, yaw and pitch; beyond, the gaze goes with the head.
_EYE_LIMIT_RAD = np.deg2rad([27.0, 20.0])
#: Half the angle between the eyes' lines of sight to a camera at arm's length.
_VERGENCE_RAD = np.deg2rad(2.6)
#: The upper lids come down so much of a blink per rad of looking down.
_LID_PER_RAD = 0.75


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """The performer's state at one time.

    Attributes:
        expression: (B,) coefficients in [0, 1].
        head_rad: (3,) yaw, pitch, roll.
        shift_mm: (3,) of the body from its place, in the camera frame.
        gaze_rad: (2, 2) yaw and pitch of the right, then the left eye, in the head frame.
    """

    expression: FloatArray
    head_rad: FloatArray
    shift_mm: FloatArray
    gaze_rad: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Take:
    """A performance, sampled on the grid of acts.RATE_HZ.

    It ends as it begins, so it can be played in a loop.

    Attributes:
        name: What it is called on the command line.
        expression: (K, B) coefficients in [0, 1].
        head_rad: (K, 3) yaw, pitch, roll.
        shift_mm: (K, 3) of the body from its place, in the camera frame.
        gaze_rad: (K, 2, 2) yaw and pitch of the right, then the left eye, in the head frame.
    """

    name: str
    expression: FloatArray
    head_rad: FloatArray
    shift_mm: FloatArray
    gaze_rad: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            expression=(np.float64, ("K", len(EXPRESSION_NAMES))),
            head_rad=(np.float64, ("K", 3)),
            shift_mm=(np.float64, ("K", 3)),
            gaze_rad=(np.float64, ("K", 2, 2)),
        )

    @property
    def duration_s(self) -> float:
        """Time from the first sample to the last."""
        return float((len(self.expression) - 1) / acts.RATE_HZ)

    def at(self, time_s: float) -> Moment:
        """Return the state at a time; before the start and after the end nothing moves."""
        place = float(np.clip(time_s * acts.RATE_HZ, 0, len(self.expression) - 1))
        index = min(int(place), len(self.expression) - 2)
        share = place - index
        tracks = (self.expression, self.head_rad, self.shift_mm, self.gaze_rad)
        return Moment(*((1 - share) * t[index] + share * t[index + 1] for t in tracks))


def make_take(name: str, seed: int = 0) -> Take:
    """Return the take of that name; the same seed gives the same take.

    Raises:
        ValueError: There is no take of that name.
    """
    if name not in TAKES:
        raise ValueError(f"no take is called {name!r}; there are {', '.join(sorted(TAKES))}")
    # The name's own numbers keep the takes of one seed from sharing their blinks and sway.
    rng = np.random.default_rng([seed, *name.encode()])
    act = TAKES[name](rng)
    if name in LIFELESS:
        return animate(name, act, np.zeros(len(act.expression)), rng, liveliness=0.0)
    lids = blinks(np.arange(len(act.expression)) / acts.RATE_HZ, rng, 3.0)
    return animate(name, act, lids, rng)


def animate(
    name: str, act: Act, lids: FloatArray, rng: np.random.Generator, liveliness: float = 1.0
) -> Take:
    """Return the act with what no living person leaves out: blinks, gaze, idle sway.

    Args:
        name: Of the take.
        act: What is done on purpose.
        lids: (K,) closure of both lids in blinks.
        rng: Source of sway and gaze.
        liveliness: Size of sway and gaze shifts; 0 stands and stares like a statue.
    """
    times = np.arange(len(act.expression)) / acts.RATE_HZ
    sway = np.deg2rad(np.array([1.6, 1.2, 1.0]) * liveliness)
    head = act.head_rad + sway * np.stack(
        [wander(times, rng, np.array([5.5, 3.1, 1.7])) for _ in range(3)], axis=1
    )
    drift = np.array([4.0, 2.0, 5.0]) * liveliness
    shift = act.shift_mm + drift * np.stack(
        [wander(times, rng, np.array([6.5, 3.7])) for _ in range(3)], axis=1
    )
    targets = saccades(times, rng, np.deg2rad([9.0, 5.0]) * liveliness)
    gaze = eyes_towards(targets, head)
    follow = np.clip(-_LID_PER_RAD * gaze[:, :, 1].mean(axis=1), 0, 0.5)
    closing = blend_lids(lids, follow)
    return Take(name, acts.blend(act.expression, closing), head, shift, gaze)


def eyes_towards(targets_rad: FloatArray, head_rad: FloatArray) -> FloatArray:
    """Return (K, 2, 2) angles in the head of eyes that look at targets while the head turns.

    Args:
        targets_rad: (K, 2) yaw and pitch of what is looked at, seen from a head that faces the
            camera; 0 is the camera.
        head_rad: (K, 3) yaw, pitch, roll.
    """
    gaze = np.empty((len(head_rad), 2))
    for k, (target, head) in enumerate(zip(targets_rad, head_rad, strict=True)):
        direction = matrix_from_head_angles(target[0], target[1], 0.0)[:, 2]
        x, y, z = matrix_from_head_angles(head[0], head[1], head[2]).T @ -direction
        gaze[k] = np.arctan2(x, -z), np.arcsin(np.clip(-y, -1, 1))
    gaze = _EYE_LIMIT_RAD * np.tanh(gaze / _EYE_LIMIT_RAD)
    converging = np.array([[_VERGENCE_RAD, 0.0], [-_VERGENCE_RAD, 0.0]])
    return np.asarray(gaze[:, None, :] + converging)


def blend_lids(lids: FloatArray, follow: FloatArray) -> FloatArray:
    """Return (K, B) with both lids closed as far as blinks and looking down ask, (K,) each."""
    both = acts.weights({"eyeBlink": 1.0})
    return np.asarray(acts.blend(lids, follow)[:, None] * both)


def _still(rng: np.random.Generator) -> Act:
    return acts.rest(8.0)


def _talking(rng: np.random.Generator) -> Act:
    return acts.speak(15.0, rng)


def _head_turns(rng: np.random.Generator) -> Act:
    return acts.turn(
        [
            [60, 0, 0, 0, 0, 0], [-60, 0, 0, 0, 0, 0], [0, 30, 0, 0, 0, 0],
            [0, -30, 0, 0, 0, 0], [0, 0, 30, 0, 0, 0], [0, 0, -30, 0, 0, 0],
            [0, 0, 0, 0, 0, -170], [0, 0, 0, 60, 10, 220], [35, 18, -10, -50, 0, 80],
            [-40, -15, 12, 40, -10, 0], [-50, 15, 0, 0, 0, -80], [45, -18, 8, 60, 10, 60],
        ],
        rng,
    )  # fmt: skip


def _fast_motion(rng: np.random.Generator) -> Act:
    swings = (
        ([24, 0, 0, 0, 0, 0], 1.7, 3.0), ([0, 13, 0, 0, 0, 0], 2.2, 3.0),
        ([0, 0, 15, 0, 0, 0], 1.6, 2.0), ([0, 0, 0, 55, 0, 0], 1.1, 2.0),
        ([35, 0, 0, 0, 0, 0], 1.2, 2.0), ([12, 10, 0, 20, 0, 40], 1.8, 2.5),
    )  # fmt: skip
    parts = []
    for amplitude, rate_hz, cycles in swings:
        size = np.array(amplitude) * rng.uniform(0.9, 1.1)
        parts += [acts.oscillate(list(size), rate_hz * rng.uniform(0.9, 1.1), cycles)]
        parts += [acts.rest(rng.uniform(0.2, 0.5))]
    return acts.join(parts)


def _expressions(rng: np.random.Generator) -> Act:
    return acts.pull_faces(list(acts.FACES), rng)


def _mixed(rng: np.random.Generator) -> Act:
    faces = [list(acts.FACES)[i] for i in rng.permutation(len(acts.FACES))[:5]]
    turns = [
        [40, 0, 0, 10, 0, 0], [-50, 8, 0, -10, 0, -60],
        [0, -20, 12, 30, 0, 60], [15, 18, -15, 0, 0, 0],
    ]  # fmt: skip
    return acts.join(
        [
            acts.pull_faces(["smile"], rng),
            acts.speak(6.0, rng),
            acts.turn(turns, rng),
            acts.pull_faces(faces, rng),
            acts.oscillate([20, 0, 0, 0, 0, 0], 1.6, 2.0),
            acts.oscillate([0, 11, 0, 0, 0, 0], 2.0, 2.0),
            acts.rest(0.6),
        ]
    )


def _leaving(rng: np.random.Generator) -> Act:
    """Leave the picture to a side, come back; the same downwards and to the other side."""
    away = [[0, 0, 0, 520, 0, 0], [0, 0, 0, 0, 420, 0], [20, 0, 0, -520, 0, 0]]
    parts = [acts.rest(1.2)]
    for pose in away:
        parts += [acts.step_out(pose, rng.uniform(0.4, 0.6), 0.6), acts.rest(1.0)]
    return acts.join(parts)


def _shake(rng: np.random.Generator) -> Act:
    swings = (
        ([38, 0, 0, 0, 0, 0], 2.6), ([0, 20, 0, 0, 0, 0], 3.0), ([0, 0, 24, 0, 0, 0], 2.6),
        ([0, 0, 0, 110, 0, 0], 2.2), ([30, 12, 10, 60, 20, 0], 2.8),
    )  # fmt: skip
    parts = [acts.rest(1.0)]
    for amplitude, rate_hz in swings:
        parts += [acts.oscillate(amplitude, rate_hz * rng.uniform(0.95, 1.05), 2.5)]
        parts += [acts.rest(0.7)]
    return acts.join(parts)


#: Every take by the name it has on the command line.
TAKES: dict[str, Callable[[np.random.Generator], Act]] = {
    "mixed": _mixed,
    "talking": _talking,
    "head_turns": _head_turns,
    "fast_motion": _fast_motion,
    "expressions": _expressions,
    "still": _still,
    "asymmetric": asymmetric,
    "head_motion": head_motion,
    "statue": statue,
    "leaving": _leaving,
    "shake": _shake,
}
#: Takes in which not even an eyelid moves.
LIFELESS = frozenset({"statue"})
