"""What the generated faces do: visemes, emotions, blinks and scenes made of them.

Every function draws from the generator it is given; times are continuous, so that frames fall on
every phase of a fast movement.
"""

import numpy as np

from assets.build.animation_events import Event, play, speak, targets, wander
from core.arkit import EXPRESSION_NAMES
from core.records import FloatArray

N = len(EXPRESSION_NAMES)
FRAME_S = 1 / 30
JAW, CLOSE = EXPRESSION_NAMES.index("jawOpen"), EXPRESSION_NAMES.index("mouthClose")

VISEMES = (
    targets(jawOpen=0.06, mouthClose=0.06, mouthPress=0.3, mouthRollLower=0.2, mouthRollUpper=0.15),
    targets(jawOpen=0.08, mouthRollLower=0.4, mouthUpperUp=0.2, mouthClose=0.02),
    targets(jawOpen=0.15, mouthLowerDown=0.25, mouthUpperUp=0.1),
    targets(jawOpen=0.14, mouthLowerDown=0.3, mouthUpperUp=0.15, mouthStretch=0.1),
    targets(jawOpen=0.22, mouthUpperUp=0.15, mouthStretch=0.12),
    targets(jawOpen=0.12, mouthFunnel=0.45, mouthShrugUpper=0.15, mouthUpperUp=0.15),
    targets(jawOpen=0.06, mouthStretch=0.25, mouthLowerDown=0.25, mouthUpperUp=0.15,
            jawForward=0.1),
    targets(jawOpen=0.12, mouthLowerDown=0.15, mouthDimple=0.1),
    targets(jawOpen=0.12, mouthFunnel=0.3, mouthPucker=0.25),
    targets(jawOpen=0.55, mouthLowerDown=0.3, mouthUpperUp=0.25),
    targets(jawOpen=0.3, mouthStretch=0.2, mouthSmile=0.15, mouthLowerDown=0.3, mouthUpperUp=0.1),
    targets(jawOpen=0.15, mouthSmile=0.3, mouthStretch=0.25, mouthLowerDown=0.15, mouthDimple=0.1),
    targets(jawOpen=0.38, mouthFunnel=0.5, mouthPucker=0.2),
    targets(jawOpen=0.14, mouthPucker=0.7, mouthFunnel=0.3),
    targets(jawOpen=0.1, mouthShrugLower=0.2, mouthShrugUpper=0.1),
)  # fmt: skip

EMOTIONS = (
    targets(mouthSmile=0.6, cheekSquint=0.4, eyeSquint=0.3, mouthDimple=0.15),
    targets(mouthSmile=0.95, cheekSquint=0.7, eyeSquint=0.6, jawOpen=0.4, mouthUpperUp=0.4,
            mouthLowerDown=0.35, mouthStretch=0.2),
    targets(mouthFrown=0.6, browInnerUp=0.7, mouthShrugLower=0.35, eyeSquint=0.15),
    targets(browDown=0.9, eyeSquint=0.4, noseSneer=0.4, mouthPress=0.5, mouthRollLower=0.2),
    targets(browDown=0.8, noseSneer=0.8, mouthUpperUp=0.7, jawOpen=0.25, mouthLowerDown=0.5,
            mouthStretch=0.3, cheekSquint=0.4),
    targets(noseSneer=0.9, mouthUpperUp=0.5, cheekSquint=0.5, browDown=0.4, mouthShrugUpper=0.4),
    targets(browInnerUp=0.9, browOuterUp=0.9, eyeWide=0.8, jawOpen=0.6),
    targets(browInnerUp=0.9, browOuterUp=0.3, eyeWide=0.8, mouthStretch=0.7, jawOpen=0.2),
    targets(mouthSmileLeft=0.5, mouthDimpleLeft=0.5, cheekSquintLeft=0.2),
    targets(browOuterUpLeft=0.9, browInnerUpLeft=0.4, browDownRight=0.5),
    targets(eyeBlink=1.0, eyeSquint=0.8, cheekSquint=0.7, noseSneer=0.5, browDown=0.6),
    targets(mouthPucker=0.9, mouthFunnel=0.2), targets(mouthFunnel=0.8, jawOpen=0.3),
    targets(mouthShrugLower=0.7, mouthFrown=0.4, mouthPucker=0.2),
    targets(cheekPuff=0.9, mouthPress=0.3), targets(cheekPuffLeft=0.9, mouthPress=0.2),
    targets(cheekSuck=0.8, mouthPucker=0.4), targets(jawForward=0.9),
    targets(jawLeft=0.9), targets(jawLeft=0.6, jawOpen=0.3), targets(mouthLeft=0.9),
    targets(mouthLeft=0.5, mouthSmileLeft=0.3), targets(jawOpen=1.0), targets(jawOpen=0.5),
    targets(jawOpen=0.5, mouthClose=0.45), targets(jawOpen=0.9, eyeSquint=0.5, eyeBlink=0.6,
            mouthStretch=0.2, browInnerUp=0.4),
    targets(mouthRollLower=0.8, mouthRollUpper=0.8, mouthPress=0.3), targets(mouthRollLower=0.7),
    targets(mouthShrugLower=0.6, mouthShrugUpper=0.6, browInnerUp=0.5),
    targets(mouthUpperUp=0.8, mouthLowerDown=0.8, mouthSmile=0.3),
    targets(mouthDimple=0.7, mouthPress=0.4), targets(mouthFrown=0.9), targets(mouthStretch=0.9),
    targets(browDown=0.7), targets(browInnerUp=0.8, browOuterUp=0.8), targets(browInnerUp=0.8),
    targets(eyeWide=0.8), targets(eyeSquint=0.8), targets(eyeBlinkLeft=1.0, cheekSquintLeft=0.5,
            mouthSmileLeft=0.3, eyeSquintLeft=0.3),
    targets(noseSneerLeft=0.8, mouthUpperUpLeft=0.6), targets(mouthLowerDown=0.8, mouthFrown=0.3),
)  # fmt: skip

#: Both sides of a face move alike, but seldom equally.
SIDE_SPREAD = 0.12


def varied(rng: np.random.Generator, target: FloatArray, spread: float) -> FloatArray:
    """Return a target with every coefficient scaled by chance, both sides nearly alike."""
    common = rng.standard_normal(N)
    for index, name in enumerate(EXPRESSION_NAMES):
        if name.endswith("Right"):
            common[index] = common[EXPRESSION_NAMES.index(name.removesuffix("Right") + "Left")]
    log_gain = spread * common + min(spread, SIDE_SPREAD) * rng.standard_normal(N)
    return np.asarray(target * np.exp(log_gain))


def blinks(rng: np.random.Generator, end_s: float) -> list[Event]:
    """Return spontaneous blinks: fast down, slower up, now and then double or half."""
    events, start = [], rng.exponential(2.0)
    while start < end_s:
        depth = rng.uniform(0.4, 0.8) if rng.random() < 0.12 else rng.uniform(0.9, 1.05)
        lids = varied(rng, targets(eyeBlink=depth, eyeSquint=rng.uniform(0, 0.15)), 0.03)
        rise, hold, fall = rng.uniform(0.06, 0.13), rng.uniform(0.0, 0.07), rng.uniform(0.1, 0.3)
        events.append(Event(start, rise, hold, fall, lids))
        start += rise + hold + fall + (0.1 if rng.random() < 0.1 else rng.exponential(2.8))
    return events


def winks(rng: np.random.Generator, end_s: float) -> list[Event]:
    """Return one-eyed blinks and long closures of either or both eyes."""
    events, start = [], rng.exponential(1.0)
    while start < end_s:
        side = rng.choice(["Left", "Right", ""], p=[0.4, 0.4, 0.2])
        amounts = {"eyeBlink": 1.0, "eyeSquint": rng.uniform(0, 0.5), "cheekSquint": 0.3}
        pose = targets(**{name + side: amount for name, amount in amounts.items()})
        rise, fall = rng.uniform(0.07, 0.2), rng.uniform(0.1, 0.3)
        events.append(Event(start, rise, rng.uniform(0.05, 1.2), fall, varied(rng, pose, 0.05)))
        start = events[-1].end_s + rng.exponential(0.8)
    return events


def feelings(rng: np.random.Generator, end_s: float, strength: float) -> list[Event]:
    """Return emotions and grimaces, some mirrored, some overlapping."""
    events, start = [], rng.exponential(0.5)
    while start < end_s:
        pose = varied(rng, EMOTIONS[rng.integers(len(EMOTIONS))], 0.25)
        rise, fall = np.exp(rng.uniform(np.log(0.12), np.log(0.7), 2)) * (1.0, 1.4)
        hold = rng.exponential(0.9)
        events.append(Event(start, rise, hold, fall, strength * rng.uniform(0.4, 1.1) * pose))
        start += rise + hold + fall * rng.uniform(0.2, 1.0) + rng.exponential(0.6)
    return events


def brow_flashes(rng: np.random.Generator, end_s: float) -> list[Event]:
    """Return raised and lowered brows as they accent speech."""
    events, start = [], rng.exponential(2.0)
    poses = (
        targets(browInnerUp=0.5, browOuterUp=0.5),
        targets(browDown=0.4),
        targets(browInnerUp=0.5),
    )
    while start < end_s:
        pose = rng.uniform(0.4, 1.4) * varied(rng, poses[rng.integers(3)], 0.2)
        rise, fall = rng.uniform(0.1, 0.25), rng.uniform(0.15, 0.4)
        events.append(Event(start, rise, rng.exponential(0.2), fall, pose))
        start = events[-1].end_s + rng.exponential(1.5)
    return events


def random_combinations(rng: np.random.Generator, end_s: float) -> list[Event]:
    """Return one to four shapes of all 46 at a time, so that none is unheard of."""
    events, start = [], 0.0
    while start < end_s:
        pose = np.zeros(N)
        pose[rng.choice(N, rng.integers(1, 5), replace=False)] = rng.uniform(0.2, 1.0)
        pose[JAW] = max(pose[JAW], pose[CLOSE])
        rise, fall = np.exp(rng.uniform(np.log(0.08), np.log(0.8), 2))
        events.append(Event(start, rise, rng.exponential(0.6), fall, varied(rng, pose, 0.4)))
        start += rng.uniform(0.4, 1.6)
    return events


def speech(rng: np.random.Generator, times_s: FloatArray) -> FloatArray:
    """Return coefficients (N, 46) of phrases of 4 to 7 syllables a second with pauses."""
    centers: list[float] = []
    start = rng.exponential(0.5)
    while start < times_s[-1]:
        rate = rng.uniform(8.0, 14.0)
        for _ in range(rng.integers(8, 40)):
            start += rng.gamma(6.0, 1 / 6.0) / rate
            centers.append(start)
        start += rng.exponential(0.9)
    kinds = rng.integers(len(VISEMES), size=len(centers))
    visemes = np.array([varied(rng, VISEMES[kind], 0.3) for kind in kinds])
    widths = rng.uniform(0.03, 0.06, len(centers))
    return rng.uniform(0.6, 1.25) * speak(np.array(centers), visemes, widths, times_s)


def scene(rng: np.random.Generator, kind: str, seconds: float) -> FloatArray:
    """Return one clip (N, 46) in [0, 1] of a kind that `KINDS` names."""
    times = np.arange(0, seconds, FRAME_S) + rng.uniform(0, FRAME_S)
    clip = wander(rng, times, rng.uniform(0.0, 0.012), rng.uniform(0.4, 2.0))
    if kind != "winks":
        clip += play(blinks(rng, seconds), times)
    if kind in ("talk", "lively talk"):
        clip += speech(rng, times) + play(brow_flashes(rng, seconds), times)
    if kind in ("lively talk", "feelings"):
        clip += play(feelings(rng, seconds, 1.0 if kind == "feelings" else 0.6), times)
    if kind == "winks":
        clip += play(winks(rng, seconds), times)
    if kind == "combinations":
        clip += play(random_combinations(rng, seconds), times)
    clip = np.clip(clip, 0.0, 1.0)
    clip[:, CLOSE] = np.minimum(clip[:, CLOSE], clip[:, JAW])
    return clip


#: Share of the time that each kind of scene takes.
KINDS = {
    "still": 0.15,
    "talk": 0.25,
    "lively talk": 0.15,
    "feelings": 0.25,
    "winks": 0.05,
    "combinations": 0.15,
}


def performance(rng: np.random.Generator, minutes: float) -> list[FloatArray]:
    """Return clips (N, 46) of about `minutes` in all, kinds in their shares."""
    clips = []
    for kind, share in KINDS.items():
        left = 60 * minutes * share
        while left > 0:
            seconds = min(left, float(rng.uniform(10.0, 40.0)))
            clips.append(scene(rng, kind, max(seconds, 2.0)))
            left -= seconds
    return clips
