"""A person's own face without any setup, from the first frames of a live stream.

[FaceIt19] tracks everybody with one set of blendshapes. Ours starts with the mean face of the
bilinear model and improves it while the tracking goes on: identity weights, offsets of landmarks
and, if the camera is not known, the focal length are fitted to a few frames that differ in pose
and expression. The expression prior is sparse and belongs to each frame, identity is shared by
all: what a person shows in every frame becomes the face, what comes and goes does not.
"""

from collections.abc import Generator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from core.blendshapes import spread_offsets
from core.face_model import FaceModel, deltas_mm, neutral_mm
from core.fit_problem import State
from core.fit_space import Face, fit_space
from core.geometry import matrix_from_quaternion
from core.joint_step import Person
from core.landmarks import N_INTERNAL
from core.model_fit import (
    LEAST_LANDMARKS,
    FitSettings,
    trusted_landmarks,
)
from core.quick_frames import Keyframe, Keyframes, KeyframeSettings, place_of
from core.quick_problem import FocalPrior, FocalSettings, quick_problem
from core.quick_step import Guess, Stepped, follow, quick_step
from core.quick_stranger import StrangerSettings, StrangerWatch
from core.records import Camera, FloatArray, Landmarks2D, UserBlendshapes


@dataclass(frozen=True, slots=True)
class QuickSettings:
    """How the face is fitted while it is tracked.

    Attributes:
        fit: Weights of landmarks and priors. The outline hardly counts: automatic landmarks are
            worst there.
        frames: Which frames are kept.
        stranger: When another person is taken to sit there.
        focal: How free the focal length is.
        least_confidence: Frames with less are not looked at.
        first_calls: Calls of `advance` before the first better face, one call being one frame.
        slower: Factor on the calls between two faces, each time.
        most_calls: Most calls between two faces.
        least_change_mm: A face that differs less is not worth a switch.
        least_focal_change: The same for the logarithm of the focal length.
        settled_calls: A face that has hardly changed in so many calls has settled.
        settled_change: What `hardly` is, in the two least changes above.
        settled_frames: Nothing has settled with fewer frames.
        tolerance: The fit rests when the energy falls by less than this share.
    """

    fit: FitSettings = field(
        default_factory=lambda: FitSettings(contour_weight=0.05, identity_weight=3.0, offset_mm=0.5)
    )
    frames: KeyframeSettings = field(default_factory=KeyframeSettings)
    stranger: StrangerSettings = field(default_factory=StrangerSettings)
    focal: FocalSettings = field(default_factory=FocalSettings)
    least_confidence: float = 0.5
    first_calls: int = 24
    slower: float = 1.5
    most_calls: int = 300
    least_change_mm: float = 0.1
    least_focal_change: float = 0.01
    settled_calls: int = 90
    settled_change: float = 3.0
    settled_frames: int = 4
    tolerance: float = 1e-3


@dataclass(frozen=True, eq=False)
class Personal:
    """A face of one's own, as far as it is known.

    Attributes:
        model: The bilinear face model.
        camera: With the focal length that goes with the face.
        identity: (I,) identity weights.
        offsets_mm: (60, 3) landmarks beside the model's.
        face: At the points of a fit.
        focal_spread: Standard deviation of the logarithm of the focal length.
        settled: Little more will change.
    """

    model: FaceModel
    camera: Camera
    identity: FloatArray
    offsets_mm: FloatArray
    face: Face
    focal_spread: float
    settled: bool

    @cached_property
    def user(self) -> UserBlendshapes:
        """All vertices, made when first asked for: they cost more than tracking a frame."""
        neutral = neutral_mm(self.model, self.identity)
        smooth = spread_offsets(neutral, self.model.landmark_vertices, self.offsets_mm)
        left = self.offsets_mm - smooth[self.model.landmark_vertices]
        deltas = deltas_mm(self.model, self.identity)
        return UserBlendshapes(self.identity, neutral + smooth, deltas, left)


class QuickIdentity:
    """Fits the face of whoever is tracked, a little in each frame."""

    def __init__(
        self, model: FaceModel, camera: Camera, focal_known: bool,
        settings: QuickSettings | None = None,
    ) -> None:  # fmt: skip
        """Start with the mean face.

        Args:
            model: The bilinear face model.
            camera: Known, or a first guess of the usual focal length.
            focal_known: Whether its focal length is not to be touched.
            settings: How to fit.
        """
        self._model, self._camera = model, camera
        self._settings = settings = settings or QuickSettings()
        self._space = fit_space(model)
        self._focal = FocalPrior(camera.focal_px, focal_known, settings.focal)
        self.reset()

    def reset(self) -> None:
        """Forget the person, but not the camera; called by itself when somebody else sits down.

        The face in use stays in use until there is a better one.
        """
        self._keyframes = Keyframes(self._settings.frames)
        self._person = Person(np.zeros(self._space.n_identities), np.zeros((N_INTERNAL, 3)))
        self._face = self._space.face(self._person.identity, self._person.offsets_mm)
        self._shown, self._settled = (self._face.neutral_mm, self._camera.focal_px), False
        self._focal_spread = self._focal.widest
        self._stranger = StrangerWatch(self._face, self._camera, self._settings.stranger)
        self._work: Generator[None, None, None] | None = None
        self._damping, self._resting = _DAMPING, True
        self._calls, self._pause = 0, float(self._settings.first_calls)

    def offer(
        self, landmarks: Landmarks2D, expression: FloatArray, rotation_wxyz: FloatArray,
        translation_mm: FloatArray, confidence: float,
    ) -> None:  # fmt: skip
        """Show a tracked frame; it is kept if it is good and unlike those that are kept.

        Frames that have long been of somebody else start the search for the face anew.

        Args:
            landmarks: Of the generic aligner.
            expression: (B,) as tracked with the present face.
            rotation_wxyz: (4,) model to camera.
            translation_mm: (3,).
            confidence: In [0, 1].
        """
        unsure = confidence < self._settings.least_confidence
        if unsure or trusted_landmarks(landmarks) < LEAST_LANDMARKS:
            return
        rotation = matrix_from_quaternion(rotation_wxyz)
        place = place_of(rotation, translation_mm, expression, self._settings.frames)
        keyframe = Keyframe(
            landmarks, rotation, np.array(translation_mm), np.array(expression), confidence, place
        )
        if self._stranger.is_stranger(keyframe):
            self.reset()
        if self._keyframes.offer(keyframe):
            self._resting, self._damping = False, min(self._damping, _DAMPING)

    def advance(self) -> Personal | None:
        """Do one piece of work, a few ms; return a face when a clearly better one is ready."""
        self._calls += 1
        if self._work is None and not self._resting:
            self._work = self._improve()
        if self._work is not None:
            if next(self._work, _DONE) is not _DONE:
                return None
            self._work = None
        return self._release() if self._calls >= self._pause else None

    def _improve(self) -> Generator[None, None, None]:
        """Take one Gauss-Newton step on face, focal length and keyframes."""
        frames = self._keyframes.frames
        state = State(
            np.stack([one.rotation for one in frames]),
            np.stack([one.translation_mm for one in frames]),
            np.stack([one.expression for one in frames]),
        )
        guess = Guess(self._person, self._face, self._camera, state)
        spread = self._focal.spread(frames, self._settings.frames.angle_rad)
        problem = quick_problem(
            self._space, guess, frames, self._settings.fit, self._focal.usual_px, spread
        )
        yield
        fresh = np.flatnonzero([one.fresh for one in frames]).astype(np.int32)
        if fresh.size:
            guess = yield from follow(problem, guess, fresh, _FIRST_ITERATIONS)
        stepped = yield from quick_step(problem, guess, self._damping)
        self._judge(stepped, frames)

    def _judge(self, stepped: Stepped, frames: tuple[Keyframe, ...]) -> None:
        """Keep a step that made the energy fall."""
        gain = stepped.before - stepped.after
        if not gain > 0:  # a step to nowhere gives NaN
            self._damping *= _MORE
            self._resting = self._damping > _STUCK
            return
        self._damping = max(self._damping * _LESS, _LEAST_DAMPING)
        guess, state = stepped.guess, stepped.guess.state
        self._person, self._face, self._camera = guess.person, guess.face, guess.camera
        prior_spread = self._focal.spread(frames, self._settings.frames.angle_rad)
        self._focal_spread = self._focal.told(stepped.focal_spread, prior_spread)
        after = tuple(
            replace(frame, rotation=turned, translation_mm=place, expression=shapes, fresh=False)
            for frame, turned, place, shapes in zip(
                frames, state.rotations, state.translations_mm, state.expressions, strict=True
            )
        )
        self._keyframes.solved(frames, after)
        fresh = any(one.fresh for one in self._keyframes.frames)
        self._resting = gain < self._settings.tolerance * stepped.before and not fresh

    def _release(self) -> Personal | None:
        """Return the present face if it is worth a switch."""
        settings = self._settings
        change = self._change_since_release()
        settled = self._pause >= settings.settled_calls and change < settings.settled_change
        settled &= len(self._keyframes.frames) >= settings.settled_frames
        self._calls, self._pause = 0, min(self._pause * settings.slower, settings.most_calls)
        if change < 1 and settled <= self._settled:
            return None
        self._settled = settled
        self._shown = self._face.neutral_mm, self._camera.focal_px
        self._stranger.use(self._face, self._camera)
        person = self._person
        return Personal(
            self._model, self._camera, person.identity, person.offsets_mm,
            _with_smooth_offsets(self._face, person.offsets_mm), self._focal_spread, settled,
        )  # fmt: skip

    def _change_since_release(self) -> float:
        """Return how far face and focal length are from those last shown, in least changes."""
        neutral_mm, focal_px = self._shown
        moved = np.linalg.norm(self._face.neutral_mm - neutral_mm, axis=1)
        change_mm = float(np.sqrt(np.mean(moved**2)))
        ratio = abs(float(np.log(self._camera.focal_px / focal_px)))
        settings = self._settings
        return max(change_mm / settings.least_change_mm, ratio / settings.least_focal_change)


def _with_smooth_offsets(face: Face, offsets_mm: FloatArray) -> Face:
    """Return the face with the points around the landmarks moved along with them."""
    raw = face.neutral_mm.copy()
    raw[:N_INTERNAL] -= offsets_mm
    smooth = spread_offsets(raw, np.arange(N_INTERNAL, dtype=np.int32), offsets_mm)
    neutral = face.neutral_mm.copy()
    neutral[N_INTERNAL:] += smooth[N_INTERNAL:]
    return replace(face, neutral_mm=neutral)


_DONE = object()
#: Steps that fit a new keyframe to the present face.
_FIRST_ITERATIONS = 3
#: Levenberg-Marquardt: start, least, factor after a good and after a bad step; given up when stuck.
_DAMPING, _LEAST_DAMPING, _LESS, _MORE, _STUCK = 0.01, 1e-6, 0.1, 10.0, 1e3
