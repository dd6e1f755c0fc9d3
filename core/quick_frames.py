"""Which frames of a live stream the quick identity fit looks at: few, and as unlike as possible."""

from dataclasses import dataclass

import numpy as np

from core.geometry import head_angles_from_matrix, rotation_facing_camera
from core.records import FloatArray, Landmarks2D


@dataclass(frozen=True, slots=True)
class KeyframeSettings:
    """How frames are compared.

    Attributes:
        most: Keyframes kept.
        angle_rad: Difference of yaw or pitch that counts as one step.
        roll_rad: Of roll, which shows nothing new of a face.
        log_depth: Of the logarithm of the distance.
        expression: Of the coefficients, root of the summed squares.
        furthest_rad: Heads turned further are not looked at: the aligner guesses their far side.
        least_step: A frame nearer than this to a kept one can only take its place.
        better: A frame takes a similar one's place if so much more confident.
        neutral_step: The neutral frame is replaced by one that is so many steps nearer to neutral.
    """

    most: int = 16
    angle_rad: float = 0.17
    roll_rad: float = 0.5
    log_depth: float = 0.2
    expression: float = 0.5
    furthest_rad: float = 0.9
    least_step: float = 1.0
    better: float = 0.05
    neutral_step: float = 0.15


@dataclass(frozen=True, slots=True, eq=False)
class Keyframe:
    """A frame that the fit looks at.

    Attributes:
        landmarks: Of the aligner.
        rotation: (3, 3) model to camera.
        translation_mm: (3,).
        expression: (B,).
        confidence: In [0, 1].
        place: (4 + B,) where it lies among the others, in steps; 0 is a neutral frontal face.
        fresh: Whether it is as the tracker left it, not yet fitted.
    """

    landmarks: Landmarks2D
    rotation: FloatArray
    translation_mm: FloatArray
    expression: FloatArray
    confidence: float
    place: FloatArray
    fresh: bool = True

    @property
    def strangeness(self) -> float:
        """Return how many steps it is from a neutral frontal face at any distance."""
        return float(np.linalg.norm(np.delete(self.place, 3)))


def place_of(
    rotation: FloatArray, translation_mm: FloatArray, expression: FloatArray,
    settings: KeyframeSettings,
) -> FloatArray:  # fmt: skip
    """Return where a frame lies among others, (4 + B,) in steps of diversity.

    Angles count from a head that faces the camera, wherever it is in the picture.
    """
    seen = rotation_facing_camera(translation_mm).T @ rotation
    angles = head_angles_from_matrix(seen)
    turned = angles / [settings.angle_rad, settings.angle_rad, settings.roll_rad]
    depth = np.log(translation_mm[2]) / settings.log_depth
    return np.concatenate([turned, [depth], np.asarray(expression) / settings.expression])


class Keyframes:
    """Keeps the frames; the first is the most neutral one."""

    def __init__(self, settings: KeyframeSettings) -> None:
        self._settings = settings
        self.frames: tuple[Keyframe, ...] = ()

    def offer(self, frame: Keyframe) -> bool:
        """Take a frame if it tells something new; return whether it was taken."""
        yaw, pitch = frame.place[:2] * self._settings.angle_rad
        if max(abs(yaw), abs(pitch)) > self._settings.furthest_rad:
            return False
        if not self.frames:
            self.frames = (frame,)
            return True
        anchor = self.frames[0]
        if frame.strangeness < anchor.strangeness - self._settings.neutral_step:
            self.frames = (frame, *self.frames[1:])
            self._take_other(anchor)
            return True
        return self._take_other(frame)

    def _take_other(self, frame: Keyframe) -> bool:
        """Take a frame that is not the most neutral one."""
        frames = list(self.frames)
        steps = np.linalg.norm([one.place - frame.place for one in frames], axis=1)
        near = int(steps.argmin())
        if steps[near] < self._settings.least_step:
            if near == 0 or frame.confidence < frames[near].confidence + self._settings.better:
                return False
            frames[near] = frame
        elif len(frames) < self._settings.most:
            frames.append(frame)
        else:
            dispensable, distance = _most_alike(frames)
            if steps[near] <= distance:
                return False
            frames[dispensable] = frame
        self.frames = tuple(frames)
        return True

    def solved(self, before: tuple[Keyframe, ...], after: tuple[Keyframe, ...]) -> None:
        """Put solved frames in the places of those that are still kept."""
        known = {id(old): new for old, new in zip(before, after, strict=True)}
        self.frames = tuple(known.get(id(one), one) for one in self.frames)


def _most_alike(frames: list[Keyframe]) -> tuple[int, float]:
    """Return the frame, never the first, that is nearest to another one, and how near."""
    places = np.stack([one.place for one in frames])
    squares = np.sum(places**2, axis=1)
    between = squares[:, None] + squares - 2 * places @ places.T
    between[np.diag_indices(len(frames))] = np.inf
    first, second = np.unravel_index(between.argmin(), between.shape)
    distance = float(np.sqrt(max(between[first, second], 0.0)))
    one, other = int(first), int(second)
    if one == 0:
        return other, distance
    if other == 0 or frames[one].confidence < frames[other].confidence:
        return one, distance
    return other, distance
