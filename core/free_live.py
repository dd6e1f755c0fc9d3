"""Frame by frame without any setup [FaceIt19]: landmarks, energy minimisation, gaze.

Everything inside counts in the pixels of one camera, whatever the frames' size: noise and the
face's proportions then mean the same after a change, and the person's own face, which is found
while tracking goes on, stays.
"""

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from core.blendshapes import mean_user, spread_offsets
from core.camera import camera_for, project, seen_by, unproject
from core.energy_tracker import EnergySettings, EnergyTracker, Solved
from core.face_blend import FaceBlend, KnownHead
from core.face_model import FaceModel, eye_centers_mm
from core.fit_space import face_at
from core.gaze import GazeFilter, GazeSettings, pupil_directions, vergence_rad
from core.geometry import matrix_from_quaternion
from core.landmark_flow import Followed
from core.landmarks import N_INTERNAL
from core.live import resting_state
from core.pupils import SEEN
from core.quick_identity import Personal, QuickIdentity, QuickSettings
from core.records import (
    I32,
    Camera,
    FaceState,
    FloatArray,
    Frame,
    Landmarks2D,
    UserBlendshapes,
)
from core.region_check import region_confidence
from core.region_ease import RegionEase
from core.tracker import BLINKS
from core.usual_rotation import UsualRotation

#: An unknown camera: pictures of a usual webcam, the focal length as long as they are wide.
UNKNOWN_CAMERA = camera_for((640, 480), 640.0)
#: Time after which the usual rotation is that of the person.
ACQUAINTED_S = 2.0


class Follower(Protocol):
    """What is needed of the landmark follower."""

    def step(self, frame: Frame) -> Followed | None:
        """Return the landmarks of the next frame, None without a face."""
        ...

    def reset(self) -> None:
        """Forget the past, as after a cut."""
        ...


@dataclass(frozen=True, slots=True)
class FreeSettings:
    """How a face is tracked without setup.

    Attributes:
        energy: How a frame is solved.
        identity: How the person's own face is found.
        learn: Whether it is looked for at all.
        face_blend_s: Time in which a better face replaces the one in use.
        gaze: How gaze is measured and filtered.
        gap_s: Time without frames after which all begins anew: a camera was gone.
        eased: Whether what is covered is held and let go; else it is shown as it was solved.
    """

    energy: EnergySettings = field(default_factory=EnergySettings)
    identity: QuickSettings = field(default_factory=QuickSettings)
    learn: bool = True
    face_blend_s: float = 0.5
    gaze: GazeSettings = field(default_factory=GazeSettings)
    gap_s: float = 1.0
    eased: bool = True


class FreeTracker:
    """Turns frames into face states; learns the person's face and the focal length meanwhile."""

    def __init__(
        self, model: FaceModel, follower: Follower, camera: Camera | None = None,
        settings: FreeSettings | None = None, user: UserBlendshapes | None = None,
    ) -> None:  # fmt: skip
        """Prepare to follow anybody.

        Args:
            model: The face model.
            follower: Gives the landmarks of every frame.
            camera: The source's; None: the focal length is found while tracking.
            settings: How.
            user: Whose face it is; None: it is found while tracking.
        """
        self._model, self._follower = model, follower
        self._settings = settings or FreeSettings()
        self._anybody: UserBlendshapes | Personal = mean_user(model)
        self._assumed = user
        self._home = camera or UNKNOWN_CAMERA
        head = head_of(model, user or self._anybody, self._home)
        self._faces = FaceBlend(head, self._settings.face_blend_s)
        self._energy = EnergyTracker(head.face, head.camera, self._settings.energy)
        self._identity = QuickIdentity(
            model, self._home, camera is not None, self._settings.identity
        )
        self._gaze = GazeFilter(self._settings.gaze)
        self._radii = np.full(2, float(model.eyeball_radius_mm))
        self._usual = UsualRotation()
        self._size_px = self._home.size_px
        self._followed: Followed | None = None
        self._ease = RegionEase()
        self._last = resting_state("free")

    @property
    def model(self) -> FaceModel:
        """The face model."""
        return self._model

    @property
    def camera(self) -> Camera:
        """The camera in pixels of the last frame, as far as it is known."""
        return seen_by(self._faces.head.camera, self._size_px)

    @property
    def user(self) -> UserBlendshapes:
        """The face that is assumed or found so far, and how it usually looks at the screen.

        The first question after a better one takes some 20 ms.
        """
        used = self._assumed or self._anybody
        known = used.user if isinstance(used, Personal) else used
        return replace(known, rest_wxyz=self._usual.rotation_wxyz(known.rest_wxyz))

    @property
    def acquainted(self) -> bool:
        """Whether `user` is the person before the camera rather than anybody."""
        return isinstance(self._anybody, Personal) and self._usual.seen_s >= ACQUAINTED_S

    @property
    def looked(self) -> Landmarks2D | None:
        """The landmarks of the last frame, None if the network did not look or saw nothing."""
        followed = self._followed
        return followed.landmarks if followed is not None and followed.by_network else None

    def reset(self) -> None:
        """Forget where the face was, as after a cut; what is known of the person stays."""
        self._follower.reset()
        self._forget()

    def assume(self, user: UserBlendshapes | None) -> None:
        """Take the face for somebody's from now on, or with None for the one that was found."""
        if user is not self._assumed:
            self._assumed = user
            self._approach(self._last.time_s)

    def step(self, frame: Frame) -> FaceState:
        """Return the face in a frame; `lost` and the last good state where there is none."""
        size_px = (frame.gray.shape[1], frame.gray.shape[0])
        gap_s = frame.time_s - self._last.time_s
        if size_px != self._size_px or not 0 < gap_s <= self._settings.gap_s:
            self.reset()
        self._size_px = size_px
        self._followed = self._follower.step(frame)
        if self._followed is None:
            self._forget()
            self._last = replace(self._last, time_s=frame.time_s, confidence=0.0, lost=True)
            return self._shown()
        landmarks = self._at_home(self._followed.landmarks)
        solved = self._energy.step(landmarks.points_px, landmarks.confidence, frame.time_s)
        confidence = solved.confidence * self._followed.confidence
        self._last = self._state(frame.time_s, landmarks, solved, confidence)
        if self._settings.learn:
            self._learn(landmarks, solved, frame.time_s)
        if not self._faces.arrived:
            head = self._faces.step(frame.time_s)
            self._energy.use(head.face, head.camera)
        return self._shown()

    def _shown(self) -> FaceState:
        """Return the last state, what is covered of it held or let go."""
        return self._ease.step(self._last) if self._settings.eased else self._last

    def _forget(self) -> None:
        self._energy.reset()
        self._gaze.reset()

    def _at_home(self, landmarks: Landmarks2D) -> Landmarks2D:
        """Return landmarks of the frame in pixels of the home camera."""
        if self._size_px == self._home.size_px:
            return landmarks
        frame, home = seen_by(self._home, self._size_px), self._home
        factor = home.focal_px / frame.focal_px
        return replace(
            landmarks,
            points_px=(landmarks.points_px - frame.center_px) * factor + home.center_px,
            pupils_px=(landmarks.pupils_px - frame.center_px) * factor + home.center_px,
        )

    def _state(
        self, time_s: float, landmarks: Landmarks2D, solved: Solved, confidence: float
    ) -> FaceState:
        shape_mm = self._energy.points_mm()
        return FaceState(
            time_s=time_s,
            rotation_wxyz=solved.rotation_wxyz,
            translation_mm=solved.translation_mm,
            expression=solved.expression,
            gaze_rad=self._gaze_of(time_s, landmarks, solved),
            shape_mm=shape_mm,
            landmarks_px=project(self.camera, shape_mm),
            confidence=confidence,
            mode="free",
            lost=False,
            regions=region_confidence(landmarks.confidence),
        )

    def _gaze_of(self, time_s: float, landmarks: Landmarks2D, solved: Solved) -> FloatArray:
        """Return the gaze; an eye whose pupil is not seen counts as closed."""
        head = self._faces.head
        pose = np.vstack([matrix_from_quaternion(solved.rotation_wxyz), solved.translation_mm])
        sight = unproject(head.camera, landmarks.pupils_px, np.ones(2))
        directions = pupil_directions(sight, pose, head.eye_centers_mm, self._radii)
        seen = landmarks.pupil_confidence >= SEEN
        closed = np.where(seen, solved.expression[BLINKS], 1.0)
        distance_mm = float(np.linalg.norm(solved.translation_mm))
        inward = vergence_rad(head.eye_centers_mm, distance_mm)
        return self._gaze.step(directions, closed, time_s, inward)

    def _learn(self, landmarks: Landmarks2D, solved: Solved, time_s: float) -> None:
        """Show the frame to the search for the person's face; use a better face and camera."""
        if self.looked is not None:
            self._usual.add(solved.rotation_wxyz, solved.translation_mm, time_s)
            self._identity.offer(
                landmarks, solved.expression, solved.rotation_wxyz, solved.translation_mm,
                self._last.confidence,
            )  # fmt: skip
        better = self._identity.advance()
        if better is not None:
            self._anybody = better
            self._approach(time_s)

    def _approach(self, time_s: float) -> None:
        """Begin to use the face that is assumed or found."""
        found = self._anybody
        camera = found.camera if isinstance(found, Personal) else self._home
        head = head_of(self._model, self._assumed or found, camera)
        self._faces.begin(head, time_s)


def head_of(model: FaceModel, user: UserBlendshapes | Personal, camera: Camera) -> KnownHead:
    """Return what tracking needs of a person."""
    if isinstance(user, Personal):
        return KnownHead(user.face, camera, eye_centers_of(model, user))
    return KnownHead(face_at(model, user), camera, eye_centers_mm(model, user.neutral_mm))


def eye_centers_of(model: FaceModel, person: Personal) -> FloatArray:
    """Return the eyeball centres (2, 3) without making all the person's vertices."""
    vertices: I32 = np.concatenate([model.landmark_vertices, model.eye_center_vertices])
    modes = model.identity_modes_mm[:, vertices]
    points = model.mean_mm[vertices] + np.tensordot(person.identity, modes, axes=1)
    landmarks = np.arange(N_INTERNAL, dtype=np.int32)
    moved = points + spread_offsets(points, landmarks, person.offsets_mm)
    return np.asarray(moved[N_INTERNAL:])
