"""Landmarks of every frame, of which only some are looked at by the landmark network.

Between two looks optical flow carries the points [FaceIt19, landmarks]. A look corrects what
flow drifted: small corrections are spread over some frames, large ones are real and come at once.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from core.alignment import Alignment
from core.detection_policy import Detection, DetectionPolicy, PolicySettings
from core.face_keeper import FaceKeeper
from core.face_regions import Region
from core.flow_error import Signs, confidences_of, expected_error
from core.flow_motion import N_FOLLOWED, camera_between, carried, face_size_px, follow_points
from core.flow_patches import difference, patches
from core.landmark_confidence import inside, smooth_step
from core.landmarks import GROUPS, MESH478, N_INTERNAL, N_LANDMARKS, PUPILS478
from core.records import F32, U8, FloatArray, Frame, Landmarks2D

#: Between two frames further apart than this in time nothing is carried.
LONGEST_GAP_S = 0.5
#: The followed points among landmarks and pupils.
_FOLLOWED = np.r_[0:N_INTERNAL, N_LANDMARKS : N_LANDMARKS + 2]

#: Landmarks and pupils in the network's mesh.
_MESH = np.concatenate([MESH478, PUPILS478])
#: Outer corner, middle of the upper lid, inner corner, middle of the lower lid; right and left.
_LIDS = np.array([GROUPS[name] for name in ("eye_right", "eye_left")])[:, [0, 2, 4, 6]]
#: Opening of the lids in parts of the eye's width: no iris to be seen, and enough of it.
_OPENING = (0.1, 0.2)


class Aligner(Protocol):
    """What is needed of the generic aligner."""

    def follow(self, rgb: U8, previous: Alignment | None) -> Alignment | None:
        """Return the face near the previous one, or after None the largest."""
        ...


@dataclass(frozen=True, slots=True)
class FlowSettings:
    """How landmarks are carried from frame to frame.

    Attributes:
        detection: The network looks at "every" frame, at every n-th one for a number, or, if
            "adaptive", as flow, eyes and mouth ask for and the budget allows.
        budget_ms: What network and flow may cost per frame on average, adaptive only.
        policy: How that is brought about.
        small: Corrections well below this, in parts of the face's size, are drift or noise.
        per_frame: Share of what is left of a small correction that each frame brings.
    """

    detection: Detection = "adaptive"
    budget_ms: float = 9.0
    policy: PolicySettings = field(default_factory=PolicySettings)
    small: float = 0.012
    per_frame: float = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """The face in one frame.

    Attributes:
        landmarks: The 75 landmarks and both pupils.
        alignment: What the network saw, None in frames in which it did not look.
        by_network: Whether it looked.
        confidence: In [0, 1], of the frame as a whole.
        error: Expected RMS error of flow in parts of the face's size, 0 where nothing was carried.
    """

    landmarks: Landmarks2D
    alignment: Alignment | None
    by_network: bool
    confidence: float
    error: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class _Past:
    """What is remembered of the frame before and of the last look.

    Attributes:
        frame: The one before.
        points_px: (Q, 2) what was given out for it: landmarks, then pupils.
        waiting_px: (Q, 2) corrections that are still to come.
        trust: (P,) in the followed points, less with every frame since the look.
        looked_s: Time of the last look.
        looked_px: (Q, 2) what was given out then.
        alignment: What the network saw then.
        patches: Of that frame.
    """

    frame: Frame
    points_px: FloatArray
    waiting_px: FloatArray
    trust: FloatArray
    looked_s: float
    looked_px: FloatArray
    alignment: Alignment
    patches: list[F32]


class LandmarkFollower:
    """Follows the landmarks of one face through the frames of a source."""

    def __init__(
        self,
        aligner: Aligner,
        settings: FlowSettings | None = None,
        clock: Callable[[], float] | None = None,
        keeper: FaceKeeper | None = None,
    ) -> None:
        """Prepare to follow.

        Args:
            aligner: Finds and follows the face by the network.
            settings: How.
            clock: Seconds of processor time, to measure what network and flow cost; None counts
                with the settings' costs, and the same frames then give the same landmarks.
            keeper: Of the aligner: stays with one face, sees what covers it; None: whoever is
                there is followed.
        """
        self._aligner, self._clock, self._keeper = aligner, clock, keeper
        self._settings = settings or FlowSettings()
        self._policy = DetectionPolicy(
            self._settings.detection, self._settings.budget_ms, self._settings.policy
        )
        self._past: _Past | None = None

    def reset(self) -> None:
        """Forget the past, as after a cut."""
        self._past = None
        self._policy.reset()

    def step(self, frame: Frame) -> Followed | None:
        """Return the landmarks of the next frame, None without a face."""
        if self._past is not None and self._past.frame.gray.shape != frame.gray.shape:
            self.reset()
        times_s = [self._now_s()]
        flowed = self._carried(frame)
        error = 0.0 if flowed is None else expected_error(_signs(flowed))
        looks = flowed is None or self._policy.wants_look(error, frame.time_s - flowed.looked_s)
        times_s.append(self._now_s())
        self._past = self._looked(frame, flowed) if looks else flowed
        times_s.append(self._now_s())
        if self._past is None:
            # Looking for a face is not charged: once found it must not start with debts.
            return None
        self._book(times_s, flowed=flowed is not None, looked=looks)
        return replace(_followed(self._past, looks), error=error)

    def _now_s(self) -> float:
        return 0.0 if self._clock is None else self._clock()

    def _book(self, times_s: list[float], *, flowed: bool, looked: bool) -> None:
        flow_ms, network_ms = np.diff(times_s) * 1000
        measured = self._clock is not None
        self._policy.spent(
            flow_ms if measured and flowed else None,
            network_ms if measured and looked else None,
            looked=looked,
        )

    def _carried(self, frame: Frame) -> _Past | None:
        """Return the past carried on to a frame by flow, None where that cannot be."""
        past = self._past
        if past is None or self._settings.detection == "every":
            return None
        if not 0 <= frame.time_s - past.frame.time_s <= LONGEST_GAP_S:
            return None
        depth = _depth_px(past.alignment)
        motion = follow_points(
            past.frame.gray, frame.gray, past.points_px[_FOLLOWED], depth[_FOLLOWED]
        )
        if motion is None:
            return None
        points = carried(motion.camera, past.points_px, depth)
        points[_FOLLOWED] = motion.points_px
        coming = self._settings.per_frame * past.waiting_px
        return replace(
            past,
            frame=frame,
            points_px=points + coming,
            waiting_px=past.waiting_px - coming,
            trust=past.trust * motion.trust,
        )

    def _looked(self, frame: Frame, carried: _Past | None) -> _Past | None:
        """Return what the network sees, corrections of what flow carried spread; None: no face."""
        before = self._past if carried is None else carried
        place = None if before is None else _moved(before)
        if self._keeper is not None:
            found = self._keeper.follow(frame, place)
        else:
            found = self._aligner.follow(frame.rgb, place)
        if found is None:
            return None
        seen = found.landmarks
        points = np.concatenate([seen.points_px, seen.pupils_px])
        waiting = np.zeros_like(points)
        if carried is not None:
            waiting = self._waiting(points - carried.points_px, face_size_px(points))
        points = points - waiting
        return _Past(
            frame, points, waiting, np.ones(N_FOLLOWED), frame.time_s, points, found,
            patches(frame.gray, points),
        )  # fmt: skip

    def _waiting(self, correction_px: FloatArray, size_px: float) -> FloatArray:
        """Return the part (Q, 2) of a correction that comes later: small ones are not urgent."""
        large = np.sum(correction_px**2, axis=1) / (self._settings.small * size_px) ** 2
        later = np.exp(-large)[:, None] * (1 - self._settings.per_frame)
        return np.asarray(later * correction_px)


def _followed(past: _Past, looked: bool) -> Followed:
    """Return the landmarks that are given out; flow can only lose confidence."""
    seen = past.alignment.landmarks
    if looked and not past.waiting_px.any():
        return Followed(seen, past.alignment, True, past.alignment.presence)
    height, width = past.frame.gray.shape
    points, pupils = past.points_px[:N_LANDMARKS], past.points_px[N_LANDMARKS:]
    sure = confidences_of(past.trust)
    confidence = seen.confidence * inside(points, (width, height))
    confidence[:N_INTERNAL] *= sure[:N_INTERNAL]
    confidence[N_INTERNAL:] *= sure.mean()
    iris_seen = np.minimum(seen.pupil_confidence, _iris_shares(points)) * sure[N_INTERNAL:]
    pupil_confidence = iris_seen * inside(pupils, (width, height))
    landmarks = Landmarks2D(points, seen.edited, confidence, pupils, pupil_confidence)
    alignment = past.alignment if looked else None
    return Followed(landmarks, alignment, looked, past.alignment.presence * float(sure.mean()))


def _iris_shares(points_px: FloatArray) -> FloatArray:
    """Return how much of the irises (2,) the lids leave to be seen."""
    outer, up, inner, low = (points_px[_LIDS[:, k]] for k in range(4))
    wide = np.linalg.norm(outer - inner, axis=1) + 1e-9
    return smooth_step(np.linalg.norm(up - low, axis=1) / wide, *_OPENING)


def _signs(carried: _Past) -> Signs:
    """Return what has happened since the network looked."""
    now = patches(carried.frame.gray, carried.points_px)
    right, left, mouth = (difference(a, b) for a, b in zip(now, carried.patches, strict=True))
    worse = np.sort(carried.trust)[N_FOLLOWED // 5]
    turned = float(np.hypot(*_camera_since(carried)[:, 2]))
    profile = abs(float(carried.alignment.rotation[0, 2]))
    return Signs(float(1 / max(worse, 1e-3) - 1), max(right, left), mouth, turned, profile)


def _moved(past: _Past) -> Alignment:
    """Return the last look's alignment moved to where flow has carried the face since."""
    seen = past.alignment
    camera = _camera_since(past)
    center = camera[:, :2] @ seen.region.center_px + camera[:, 3]
    region = Region(center, seen.region.size_px, seen.region.angle_rad)
    mesh = carried(camera, seen.mesh_px, seen.mesh_depth_px)
    return replace(seen, mesh_px=mesh, region=region)


def _camera_since(past: _Past) -> FloatArray:
    """Return the affine camera (2, 4) that moved the face since the network looked."""
    return camera_between(
        past.looked_px[_FOLLOWED],
        _depth_px(past.alignment)[_FOLLOWED],
        past.points_px[_FOLLOWED],
        past.trust + 1e-6,
    )


def _depth_px(alignment: Alignment) -> FloatArray:
    """Return how deep (Q,) landmarks and pupils lay in the picture when the network looked."""
    return np.asarray(alignment.mesh_depth_px[_MESH])
