"""What a performer does on purpose: speak, turn, shake the head, pull faces.

Every act begins and ends at rest, so acts can be joined in any order. The recipes (viseme
tables, minimum-jerk keys) are unlike those of the tracker's animation prior on purpose.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.performer.curves import minimum_jerk, pulse, through
from core.arkit import EXPRESSION_NAMES
from core.records import FloatArray, freeze

#: Grid of all curves; linear interpolation between its points is exact enough to blur motion.
RATE_HZ = 240.0

_N = len(EXPRESSION_NAMES)

#: Mouth shapes of speech; a name without a side means both sides.
VISEMES: dict[str, dict[str, float]] = {
    "ah": {"jawOpen": 0.48, "mouthLowerDown": 0.25, "mouthUpperUp": 0.12},
    "eh": {"jawOpen": 0.28, "mouthStretch": 0.2, "mouthLowerDown": 0.3, "mouthSmile": 0.1},
    "ee": {"jawOpen": 0.12, "mouthStretch": 0.3, "mouthLowerDown": 0.35, "mouthSmile": 0.22},
    "oh": {"jawOpen": 0.32, "mouthFunnel": 0.5, "mouthPucker": 0.15},
    "oo": {"jawOpen": 0.12, "mouthPucker": 0.62, "mouthFunnel": 0.28},
    "m": {"jawOpen": 0.08, "mouthClose": 0.08, "mouthPress": 0.22, "mouthRollUpper": 0.12},
    "f": {"jawOpen": 0.09, "mouthRollLower": 0.42, "mouthUpperUp": 0.2},
    "s": {"jawOpen": 0.05, "mouthLowerDown": 0.3, "mouthUpperUp": 0.15, "mouthStretch": 0.12},
    "l": {"jawOpen": 0.2, "mouthLowerDown": 0.2, "mouthUpperUp": 0.08},
    "sh": {"jawOpen": 0.1, "mouthFunnel": 0.42, "mouthPucker": 0.22, "mouthUpperUp": 0.1},
    "th": {"jawOpen": 0.14, "mouthLowerDown": 0.25, "mouthShrugUpper": 0.08},
}
_VOWELS = ("ah", "eh", "ee", "oh", "oo")
_CONSONANTS = ("m", "f", "s", "l", "sh", "th")

#: Faces pulled one after the other.
FACES: dict[str, dict[str, float]] = {
    "smile": {"mouthSmile": 0.75, "cheekSquint": 0.35, "eyeSquint": 0.2},
    "grin": {"mouthSmile": 0.9, "jawOpen": 0.22, "mouthUpperUp": 0.4, "cheekSquint": 0.6},
    "frown": {"mouthFrown": 0.8, "mouthShrugLower": 0.35, "browInnerUp": 0.5},
    "surprise": {"jawOpen": 0.6, "browInnerUp": 0.8, "browOuterUp": 0.8, "eyeWide": 0.8},
    "anger": {"browDown": 0.85, "noseSneer": 0.5, "mouthPress": 0.6, "eyeSquint": 0.3},
    "disgust": {"noseSneer": 0.9, "mouthUpperUp": 0.6, "browDown": 0.4, "eyeSquint": 0.4},
    "wink left": {"eyeBlinkLeft": 1.0, "cheekSquintLeft": 0.6, "mouthSmileLeft": 0.45},
    "wink right": {"eyeBlinkRight": 1.0, "cheekSquintRight": 0.6, "mouthSmileRight": 0.45},
    "brow up left": {"browOuterUpLeft": 0.9, "browInnerUpLeft": 0.5, "browDownRight": 0.4},
    "brow up right": {"browOuterUpRight": 0.9, "browInnerUpRight": 0.5, "browDownLeft": 0.4},
    "puff": {"cheekPuff": 0.9, "mouthPress": 0.3},
    "puff left": {"cheekPuffLeft": 0.85, "mouthPressRight": 0.3},
    "puff right": {"cheekPuffRight": 0.85, "mouthPressLeft": 0.3},
    "suck": {"cheekSuck": 0.9, "mouthPucker": 0.45},
    "jaw left": {"jawLeft": 0.9, "jawOpen": 0.12},
    "jaw right": {"jawRight": 0.9, "jawOpen": 0.12},
    "jaw forward": {"jawForward": 0.9, "mouthShrugLower": 0.15},
    "kiss": {"mouthPucker": 0.95, "eyeSquint": 0.15},
    "funnel": {"mouthFunnel": 0.9, "jawOpen": 0.3},
    "mouth left": {"mouthLeft": 0.9},
    "mouth right": {"mouthRight": 0.9},
    "wide open": {"jawOpen": 0.95, "mouthStretch": 0.2},
    "closed jaw drop": {"jawOpen": 0.45, "mouthClose": 0.42},
    "lips in": {"mouthRollLower": 0.8, "mouthRollUpper": 0.8},
    "shrug": {"mouthShrugLower": 0.8, "mouthShrugUpper": 0.5, "browOuterUp": 0.4},
    "teeth": {"mouthLowerDown": 0.8, "mouthUpperUp": 0.6, "mouthStretch": 0.4},
    "dimples": {"mouthDimple": 0.8, "mouthPress": 0.4},
    "eyes shut": {"eyeBlink": 1.0, "eyeSquint": 0.5, "cheekSquint": 0.4},
}


@dataclass(frozen=True, slots=True, eq=False)
class Act:
    """A stretch of purposeful movement that starts and ends at rest, on the grid of RATE_HZ.

    Attributes:
        expression: (K, B) coefficients in [0, 1].
        head_rad: (K, 3) yaw, pitch, roll.
        shift_mm: (K, 3) movement of the body from its place, in the camera frame.
    """

    expression: FloatArray
    head_rad: FloatArray
    shift_mm: FloatArray

    def __post_init__(self) -> None:
        freeze(
            self,
            expression=(np.float64, ("K", _N)),
            head_rad=(np.float64, ("K", 3)),
            shift_mm=(np.float64, ("K", 3)),
        )


def grid(duration_s: float) -> FloatArray:
    """Return the times of an act that lasts so long."""
    return np.arange(round(duration_s * RATE_HZ) + 1) / RATE_HZ


def weights(named: Mapping[str, float]) -> FloatArray:
    """Return (B,) coefficients; a name that lacks its side sets both sides."""
    out = np.zeros(_N)
    for name, value in named.items():
        sides = [name] if name in EXPRESSION_NAMES else [name + "Left", name + "Right"]
        for side in sides:
            out[EXPRESSION_NAMES.index(side)] = value
    return out


def blend(*layers: FloatArray) -> FloatArray:
    """Return layers of coefficients put together smoothly, still within [0, 1]."""
    rest = np.ones(())
    for layer in layers:
        rest = rest * (1 - layer)
    return np.clip(1 - rest, 0, 1)


def join(acts: Sequence[Act]) -> Act:
    """Return the acts one after the other."""
    names = ("expression", "head_rad", "shift_mm")
    # Each act ends where the next begins, at rest: one of the two samples is enough.
    parts = ([getattr(a, n)[: None if a is acts[-1] else -1] for a in acts] for n in names)
    return Act(*(np.concatenate(part) for part in parts))


def rest(duration_s: float) -> Act:
    """Return an act of doing nothing."""
    k = len(grid(duration_s))
    return Act(np.zeros((k, _N)), np.zeros((k, 3)), np.zeros((k, 3)))


def speak(duration_s: float, rng: np.random.Generator) -> Act:
    """Return talk: syllables in phrases, brows that stress, a head that goes along."""
    times = grid(duration_s)
    knots, poses, stresses = _syllables(duration_s, rng)
    mouth = through(times, np.array(knots), np.array(poses))
    brows, head = np.zeros((len(times), _N)), np.zeros((len(times), 3))
    raised = weights({"browInnerUp": 0.4, "browOuterUp": 0.5})
    knitted = weights({"browDown": 0.4, "eyeSquint": 0.15})
    for stress in stresses:
        stroke = pulse(times, stress - 0.12, 0.16, 0.12, 0.35)[:, None]
        brows += stroke * (raised if rng.random() < 0.7 else knitted) * rng.uniform(0.3, 1.0)
        head += stroke * rng.normal(0, [0.03, 0.05, 0.03])
    window = pulse(times, 0.0, 0.4, duration_s - 0.8, 0.4)[:, None]
    head = head + _turns_of_phrase(times, rng)
    return Act(np.clip(mouth + brows, 0, 1) * window, head * window, np.zeros((len(times), 3)))


def _syllables(
    duration_s: float, rng: np.random.Generator
) -> tuple[list[float], list[FloatArray], list[float]]:
    """Return key times, key mouth shapes (each (B,)) and the times of stressed syllables."""
    table = {name: weights(named) for name, named in VISEMES.items()}
    knots, poses, stresses, time = [0.0], [np.zeros(_N)], [], 0.3
    while time < duration_s - 0.8:
        loud = rng.uniform(0.65, 1.15)
        stresses.append(time + rng.uniform(0.1, 0.5))
        for _ in range(rng.integers(3, 10)):
            for group, length in ((_CONSONANTS, 0.085), (_VOWELS, 0.13)):
                key = table[group[rng.integers(len(group))]] * rng.uniform(0.7, 1.0)
                knots.append(time)
                poses.append(np.clip(key * loud, 0, 1))
                time += length * rng.uniform(0.75, 1.5)
        # A pause, sometimes with a smile in it.
        pause = rng.uniform(0.25, 0.8)
        mood = weights({"mouthSmile": 0.4, "cheekSquint": 0.2}) * float(rng.random() < 0.4)
        knots += [time + 0.05, time + 0.05 + pause]
        poses += [mood, mood]
        time += pause + 0.15
    return [*knots, time + 0.2], [*poses, np.zeros(_N)], stresses


def _turns_of_phrase(times_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return (K, 3) small head postures that change every second or so."""
    knots = np.cumsum(np.concatenate([[0.0], rng.uniform(0.5, 1.3, 400)]))
    poses = rng.normal(0, [0.1, 0.055, 0.05], (len(knots), 3))
    poses[0] = 0
    return through(times_s, knots, poses)


def turn(poses: Sequence[Sequence[float]], rng: np.random.Generator) -> Act:
    """Return the head going through poses with a short stop at each, and back to rest.

    Args:
        poses: Each (yaw, pitch, roll in degrees, x, y, z shift in mm).
        rng: Source of the variation in timing.
    """
    knots, path, time = [0.0], [np.zeros(6)], 0.1
    for pose in [*poses, [0.0] * 6]:
        target = np.array(pose, float)
        way = float(np.abs(target - path[-1])[:3].max())
        reach = 0.35 + way / 90 * rng.uniform(0.8, 1.2)
        knots += [time, time + reach]
        path += [path[-1], target]
        time += reach + rng.uniform(0.1, 0.35)
    times = grid(time)
    moved = through(times, np.array([*knots, time + 1]), np.array([*path, path[-1]]))
    return Act(np.zeros((len(times), _N)), np.deg2rad(moved[:, :3]), moved[:, 3:])


def oscillate(amplitude: Sequence[float], rate_hz: float, cycles: float) -> Act:
    """Return a quick swing to both sides, such as a shake of the head.

    Args:
        amplitude: (yaw, pitch, roll in degrees, x, y, z in mm) at the extremes.
        rate_hz: Swings per second.
        cycles: How many of them; a multiple of a half.
    """
    duration = cycles / rate_hz + 0.3
    times = grid(duration)
    window = minimum_jerk(times / 0.3) * minimum_jerk((duration - times) / 0.3)
    wave = np.sin(2 * np.pi * rate_hz * (times - 0.15)) * window
    moved = wave[:, None] * np.array(amplitude, float)
    return Act(np.zeros((len(times), _N)), np.deg2rad(moved[:, :3]), moved[:, 3:])


def step_out(pose: Sequence[float], way_s: float, stay_s: float) -> Act:
    """Return going to a pose, staying there, and coming back.

    Args:
        pose: (yaw, pitch, roll in degrees, x, y, z shift in mm).
        way_s: Time of either way.
        stay_s: Time there.
    """
    times = grid(2 * way_s + stay_s)
    moved = pulse(times, 0.0, way_s, stay_s, way_s)[:, None] * np.array(pose, float)
    return Act(np.zeros((len(times), _N)), np.deg2rad(moved[:, :3]), moved[:, 3:])


def pull_faces(
    names: Sequence[str],
    rng: np.random.Generator,
    faces: Mapping[str, Mapping[str, float]] = FACES,
) -> Act:
    """Return the named faces one after the other, each at its own speed and a bit uneven."""
    knots, poses, time = [0.0], [np.zeros(_N)], 0.2
    for name in names:
        face = weights(faces[name]) * rng.uniform(0.8, 1.08) * rng.normal(1, 0.05, _N)
        rise, hold, fall = rng.uniform(0.18, 0.45), rng.uniform(0.15, 0.5), rng.uniform(0.2, 0.5)
        knots += [time, time + rise, time + rise + hold]
        poses += [np.zeros(_N), np.clip(face, 0, 1), np.clip(face * 0.95, 0, 1)]
        time += rise + hold + fall
    times = grid(time + 0.3)
    face = through(times, np.array([*knots, time, time + 1]), np.array([*poses, *[poses[0]] * 2]))
    postures = np.deg2rad(5.0) * rng.normal(size=(len(names), 3))
    peaks = np.array(knots[2::3])
    lean = through(
        times,
        np.concatenate([[0.0], peaks, [time + 0.25, time + 1]]),
        np.concatenate([np.zeros((1, 3)), postures, np.zeros((2, 3))]),
    )
    return Act(face, lean, np.zeros((len(times), 3)))
