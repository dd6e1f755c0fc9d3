"""Watches live frames while a prompt is followed, and takes the picture by itself."""

from dataclasses import dataclass, field, replace

import numpy as np

from core.frame_selection import sharpness
from core.geometry import quaternion_from_matrix, rotation_facing_camera
from core.ghost import Ghost
from core.landmarks import N_INTERNAL
from core.records import U8, FaceState, FloatArray, Frame, Landmarks2D
from core.setup_plan import Shot
from core.shot_match import (
    LAST_SEEN_RAD,
    Match,
    MatchSettings,
    follows_unseen,
    head_angles,
    is_visible,
    match,
)
from core.shot_quality import HARMLESS, WHY_WEAK, Advisor, Looked, QualitySettings, troubles
from core.shutter import Shutter, ShutterSettings, ShutterState

#: Time to make an expression that the landmarks do not show, before the shutter may go.
UNSEEN_PAUSE_S = 2.0
#: Frames over which the camera's speed is measured.
_SPEED_FRAMES = 30
_BLOCKS = 16
#: From when to when less of an expression is asked for, and how much less in the end.
_PATIENCE = (3.0, 9.0, 0.25)
#: Heads turned less tell where the user sits; share of the way that each frame goes there.
_FRONTAL_RAD, _SETTLING = float(np.deg2rad(20)), 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Taken:
    """A picture that was taken.

    Attributes:
        shot: Its prompt.
        frame: The frame.
        landmarks: Of the face, None where it was not seen.
        quality: Facts for people, JSON values.
    """

    shot: Shot
    frame: Frame
    landmarks: Landmarks2D | None
    quality: dict[str, object]


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """What is said of a frame.

    Attributes:
        advice: Key of core.shot_quality.ADVICE to tell the user, "" if there is none.
        match: How far the face is from the prompt, None without a face or a prompt.
        shutter: What the shutter is doing.
        taken: The picture, once it is complete.
        ghost: How the head is to be held, None where no picture of that helps.
    """

    advice: str
    match: Match | None
    shutter: ShutterState
    taken: Taken | None
    ghost: Ghost | None = None


@dataclass(frozen=True, slots=True)
class CaptureSettings:
    """How pictures are taken."""

    match: MatchSettings = field(default_factory=MatchSettings)
    quality: QualitySettings = field(default_factory=QualitySettings)
    shutter: ShutterSettings = field(default_factory=ShutterSettings)


class CaptureJudge:
    """Judges one frame after the other; remembers the prompt and the best frame so far."""

    def __init__(self, settings: CaptureSettings | None = None) -> None:
        self._settings = settings or CaptureSettings()
        self._shutter = Shutter(self._settings.shutter)
        self._advisor = Advisor()
        self._shot: Shot | None = None
        self._asked_s, self._paused, self._now_wanted = -np.inf, False, False
        self._times: list[tuple[float, int]] = []
        self._angles = np.zeros(3)
        self._best: Taken | None = None
        self._rest: FloatArray | None = None
        self._seat_mm: FloatArray | None = None
        self._facing_wxyz = np.array([1.0, 0.0, 0.0, 0.0])

    @property
    def shot(self) -> Shot | None:
        """The prompt that is waited for."""
        return self._shot

    @property
    def facing_wxyz(self) -> FloatArray:
        """How the head (4,) is turned when this person looks straight ahead, as last measured."""
        return self._facing_wxyz

    def ask(self, shot: Shot | None) -> None:
        """Wait for another prompt to be followed; None takes no pictures."""
        self._shot, self._asked_s, self._best = shot, np.nan, None

    def pause(self, paused: bool) -> None:
        """Take no pictures by itself while paused."""
        self._paused = paused

    def shoot_now(self) -> None:
        """Take the next frame whatever it shows."""
        self._now_wanted = True

    def face_forward(self, rotation_wxyz: FloatArray) -> None:
        """Count head angles from how this person looks straight ahead, (4,)."""
        self._rest = rotation_wxyz

    def step(
        self, frame: Frame, state: FaceState, landmarks: Landmarks2D | None, rivals: int = 0
    ) -> Judgement:
        """Judge a frame.

        Args:
            frame: The frame.
            state: The face tracked in it.
            landmarks: What the network saw in it, None without a face.
            rivals: Other faces about as large.
        """
        seen = landmarks if landmarks is not None and not state.lost else None
        points = None if seen is None else seen.points_px[:N_INTERNAL]
        sharp = sharpness(frame.gray, points) if points is not None else 1.0
        looked = Looked(
            frame.gray, None if seen is None else seen.points_px, rivals,
            sharp if points is not None else float("nan"), self._fps(frame),
        )  # fmt: skip
        found = troubles(looked, self._settings.quality)
        matched = self._match(state, seen, frame.time_s)
        unseen = (
            seen is None and self._shot is not None and follows_unseen(self._shot, self._angles)
        )
        if unseen:
            found = [name for name in found if name != "no_face"]
        advice = self._advisor.step(found, frame.time_s)
        good = (unseen or (matched is not None and matched.good)) and not set(found) - HARMLESS
        still = block_points(frame.gray) if unseen else points
        return self._shoot(frame, seen, advice, matched, (good, still, sharp))

    def _fps(self, frame: Frame) -> float:
        """Return how many frames a second the camera gives, those left out here counted, too."""
        if self._times and frame.index <= self._times[-1][1]:
            # Another source, with a clock of its own.
            self._times = []
        self._times = [*self._times[-_SPEED_FRAMES:], (frame.time_s, frame.index)]
        (first_s, first), (last_s, last) = self._times[0], self._times[-1]
        known = len(self._times) > _SPEED_FRAMES // 2 and last_s > first_s
        return (last - first) / (last_s - first_s) if known else float("nan")

    def _match(self, state: FaceState, seen: Landmarks2D | None, frame_s: float) -> Match | None:
        if seen is None:
            return None
        self._facing_wxyz = self._facing(state)
        self._angles = head_angles(state.rotation_wxyz, self._facing_wxyz)
        if self._shot is None:
            return None
        tried_s = 0.0 if np.isnan(self._asked_s) else frame_s - self._asked_s
        asked = self._settings.match
        patient = replace(asked, share=asked.share * patience(tried_s))
        return match(self._shot, self._angles, state.expression, patient)

    def _facing(self, state: FaceState) -> FloatArray:
        """Return the rotation of a head that looks into the camera from the user's seat.

        A turned head is not where it looks straight ahead: only frontal ones tell the seat.
        """
        if self._rest is not None:
            return self._rest
        if self._seat_mm is None:
            self._seat_mm = state.translation_mm
        elif np.abs(self._angles).max() < _FRONTAL_RAD:
            self._seat_mm = self._seat_mm + _SETTLING * (state.translation_mm - self._seat_mm)
        return quaternion_from_matrix(rotation_facing_camera(self._seat_mm))

    def _shoot(
        self, frame: Frame, seen: Landmarks2D | None, advice: str, matched: Match | None,
        view: tuple[bool, FloatArray | None, float],
    ) -> Judgement:  # fmt: skip
        good, still, sharp = view
        if self._shot is None:
            return Judgement(advice, matched, ShutterState("waiting", 0.0, False), None)
        if np.isnan(self._asked_s):
            self._asked_s = frame.time_s
            extra = 0.0 if is_visible(self._shot) else UNSEEN_PAUSE_S
            self._shutter.reset(frame.time_s + extra)
        quality = self._quality(matched, advice, sharp)
        if self._now_wanted:
            self._now_wanted = False
            by_hand = Taken(self._shot, frame, seen, quality | {"by_hand": True})
            return Judgement(advice, matched, ShutterState("done", 1.0, True), by_hand)
        state = self._shutter.step(good and not self._paused, still, sharp, frame.time_s)
        if state.best:
            self._best = Taken(self._shot, frame, seen, quality)
        taken = self._best if state.phase == "done" else None
        return Judgement(advice, matched, state, taken)

    def _quality(self, matched: Match | None, advice: str, sharp: float) -> dict[str, object]:
        facts: dict[str, object] = {"sharpness": float(sharp), "trouble": advice}
        if matched is not None:
            yaw, pitch, roll = np.rad2deg(self._angles)
            facts |= {
                "yaw_deg": float(yaw), "pitch_deg": float(pitch), "roll_deg": float(roll),
                "reached": matched.reached, "pose": matched.pose,
            }  # fmt: skip
        return facts


def patience(tried_s: float) -> float:
    """Return the share of the usual demand on an expression after so long a try.

    Nobody makes all of them well, and faces differ: who has tried is not held up.
    """
    early_s, late_s, least = _PATIENCE
    return float(np.interp(tried_s, [early_s, late_s], [1.0, least]))


def block_points(gray: U8) -> FloatArray:
    """Return the mean grey levels of blocks of a picture as points: they move when it changes."""
    height, width = gray.shape
    side = max(min(height, width) // _BLOCKS, 1)
    rows, columns = height // side, width // side
    blocks = gray[: rows * side, : columns * side].reshape(rows, side, columns, side)
    levels = blocks.mean(axis=(1, 3)).ravel()
    return np.column_stack([levels, np.zeros_like(levels)])


def weakness(taken: Taken) -> str:
    """Return why a picture is weak, for people; "" for a good one."""
    quality = taken.quality
    if taken.landmarks is None:
        return "" if abs(taken.shot.yaw) > LAST_SEEN_RAD else "no face was seen"
    trouble = str(quality.get("trouble", ""))
    if trouble and trouble not in HARMLESS:
        return WHY_WEAK[trouble]
    if not quality.get("pose", True):
        return "the head was not quite as asked"
    reached = quality.get("reached", 1.0)
    if isinstance(reached, float) and reached < MatchSettings().share:
        return "the expression was hardly made"
    return ""
