"""More pictures for a profile: under another light, with glasses, with a hand before the face.

[Cao13, sec. 7] names both light and things before the face as what makes its tracking fail, and
more setup images as the remedy. A set repeats a few of the 60 shots; a picture is stored under its
set and its shot, "glasses~smile_yaw+0", which every stage reads as that shot.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from core.landmarks import GROUPS, NAMES
from core.records import Landmarks2D
from core.setup_plan import SET_MARK, SHOTS, Shot, set_of


@dataclass(frozen=True, slots=True)
class ExtraSet:
    """A set of more pictures.

    Attributes:
        key: Begins the names of its pictures.
        title: For people.
        reason: When it helps.
        request: What to do before the first picture.
        shots: Names of the shots that it repeats, a cover before each where a hand is asked for.
    """

    key: str
    title: str
    reason: str
    request: str
    shots: tuple[str, ...]


_FACES = (
    "pose_yaw+0", "pose_yaw-30", "pose_yaw+30", "pose_pitch+15", "mouth_stretch_yaw+0",
    "smile_yaw+0", "brow_raise_yaw+0", "eyes_closed_yaw+0",
)  # fmt: skip
SETS: tuple[ExtraSet, ...] = (
    ExtraSet(
        "light", "Another light",
        "If the face is lost or trembles in the evening, or under another lamp",
        "Switch to the light in which you will play", _FACES,
    ),
    ExtraSet(
        "glasses", "With glasses",
        "If you wear glasses, a cap or a headset only at times", "Put them on", _FACES,
    ),
    ExtraSet(
        "hand", "A hand before the face",
        "If the avatar grimaces when you touch your face or drink",
        "Hold a hand before your face where you are asked to",
        (
            "mouth~pose_yaw+0", "mouth~brow_raise_yaw+0", "chin~pose_yaw+0", "chin~smile_yaw+0",
            "right-cheek~pose_yaw+0", "left-cheek~pose_yaw+0", "right-eye~pose_yaw+0",
            "left-eye~pose_yaw+0",
        ),
    ),
)  # fmt: skip


def _marks(*names: str) -> frozenset[int]:
    return frozenset(NAMES.index(name) for name in names)


def _cheek(side: str) -> frozenset[int]:
    corners = _marks(f"{side}_mouth_corner", f"{side}_lipin_corner")
    return corners | _marks(*(f"{side}{n}" for n in range(2, 8)))


_JAW = _marks("R7", "chin", "L7")
#: What a hand covers -> landmarks that cannot be seen then.
COVERS: dict[str, frozenset[int]] = {
    "mouth": frozenset(GROUPS["lips_outer"] + GROUPS["lips_inner"]) | _JAW | _marks("R6", "L6"),
    "chin": _JAW | _marks("R5", "R6", "L5", "L6"),
    "right-cheek": _cheek("R"),
    "left-cheek": _cheek("L"),
    "right-eye": frozenset(GROUPS["eye_right"] + GROUPS["brow_right"]) | _marks("R1"),
    "left-eye": frozenset(GROUPS["eye_left"] + GROUPS["brow_left"]) | _marks("L1"),
}
#: Pupils that are behind the hand, too.
_PUPILS = {"right-eye": 0, "left-eye": 1}


def extra_set(key: str) -> ExtraSet:
    """Return a set by its key.

    Raises:
        ValueError: There is none.
    """
    for one in SETS:
        if one.key == key:
            return one
    raise ValueError(f"no set of more pictures is called {key!r}")


def extra_shots(one: ExtraSet, known: Iterable[str] = ()) -> tuple[Shot, ...]:
    """Return the prompts of a set that was not taken before.

    Args:
        one: The set.
        known: Names of pictures that there are. A set of which all are there begins anew under
            another name: there is more than one lamp.
    """
    number, there = 1, set(known)
    while True:
        key = one.key if number == 1 else f"{one.key}-{number}"
        shots = tuple(_shot(key, name) for name in one.shots)
        if not {shot.name for shot in shots} <= there:
            return shots
        number += 1


def cover_of(stem: str) -> str:
    """Return what a hand covers in the picture with this file stem, "" without a hand."""
    cover = set_of(stem).rpartition(SET_MARK)[2]
    return cover if cover in COVERS else ""


def as_seen(stem: str, landmarks: Landmarks2D) -> Landmarks2D:
    """Return the landmarks of a picture without trust in those behind the hand.

    The aligner sees through hands: it tells where a covered point should be and is sure of it.

    Args:
        stem: The picture's name.
        landmarks: As found in it.
    """
    cover = cover_of(stem)
    if not cover:
        return landmarks
    confidence, pupils = landmarks.confidence.copy(), landmarks.pupil_confidence.copy()
    behind = sorted(COVERS[cover])
    confidence[behind] = np.where(landmarks.edited[behind], confidence[behind], 0.0)
    if cover in _PUPILS:
        pupils[_PUPILS[cover]] = 0.0
    return replace(landmarks, confidence=confidence, pupil_confidence=pupils)


def _shot(key: str, name: str) -> Shot:
    cover, _, stem = name.rpartition(SET_MARK)
    shot = next(one for one in SHOTS if one.name == stem)
    whole = f"{key}{SET_MARK}{name}"
    if not cover:
        return replace(shot, name=whole)
    face = shot.instruction.rstrip(".").rpartition(", and ")[0]
    where = f"hold a hand before your {cover.replace('-', ' ')}"
    return replace(shot, name=whole, instruction=f"{face}, and {where}.")
