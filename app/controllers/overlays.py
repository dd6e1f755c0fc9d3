"""What lies over the pictures, as the menu View says."""

from collections import deque
from collections.abc import Generator
from typing import Protocol

import numpy as np
from PySide6.QtCore import QObject

from app.controllers.face_mesh import FaceMesh
from app.controllers.player import Performer
from app.views.layers import APPEARANCE_COLOR, AXIS_COLORS, Bars, Layer, Lines, Points, Trace
from app.views.live_actions import LiveActions
from app.workers.job_slot import JobSlot
from core.arkit import EXPRESSION_NAMES
from core.camera import project
from core.fern_regressor import FernRegressor
from core.geometry import matrix_from_quaternion
from core.landmarks import CURVES, N_INTERNAL, N_LANDMARKS
from core.records import Camera, FaceState, FloatArray, Frame, Progress, UserBlendshapes

#: The last landmarks stand for the outline but lie on the skin: they are dots, not a line.
DRAWN_CURVES = tuple(curve for curve in CURVES if max(curve) < N_INTERNAL)
#: Below this confidence landmarks are drawn in the warning colour.
SURE = 0.5
AXIS_MM = 70.0
#: Left, up and forwards in the model frame.
AXES = np.diag([1.0, -1.0, -1.0])
TRACE_S, TRACE_FRAMES = 6.0, 400
#: Nearer to the camera than this nothing is drawn.
NEAREST_MM = 10.0


class MeshMaker(Protocol):
    """What is needed of the toolbox."""

    def face_mesh(self, user: UserBlendshapes | None) -> FaceMesh:
        """Return the lines of a user's face; called in a background thread."""
        ...


class Overlays(QObject):
    """Makes the layers of a state; the mesh, which takes a while, in the background."""

    def __init__(self, deeds: LiveActions, maker: MeshMaker, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._deeds, self._maker = deeds, maker
        self._performer: Performer | None = None
        self._user: UserBlendshapes | None = None
        self._mesh: FaceMesh | None = None
        self._job = JobSlot(self, self._make_mesh)
        self._history: deque[tuple[float, float, float]] = deque(maxlen=TRACE_FRAMES)
        deeds["mesh"].toggled.connect(self._make_mesh)

    def use(self, performer: Performer | None, user: UserBlendshapes | None) -> None:
        """Draw what belongs to another performer, or to the same as another user."""
        if performer is None:
            self._history.clear()
        if user is not self._user or performer is None:
            self._mesh = None
        self._performer, self._user = performer, user
        self._make_mesh()

    def stop(self) -> None:
        """Wait for the end of what is being made, and make nothing more."""
        self._performer = None
        self._job.stop()

    def note(self, frame: Frame, state: FaceState) -> None:
        """Remember how sure the tracker was; called in the live thread."""
        sure = 0.0 if state.lost else state.confidence
        least = 0.0 if state.lost else float(state.regions.min())
        self._history.append((state.time_s, sure, least))

    def over_source(self, state: FaceState) -> list[Layer]:
        """Return what lies over the picture that a state was solved from."""
        on, layers = self._deeds.on, list[Layer]()
        if not state.lost:
            camera = self._camera()
            if on("mesh") and self._mesh is not None and camera is not None:
                layers.append(Lines(self._mesh.lines_px(state, camera)))
            if on("points") and camera is not None:
                layers += self._points(state, camera)
            if on("landmarks"):
                certain = state.confidence > SURE
                layers.append(Points(state.landmarks_px, DRAWN_CURVES, certain=certain))
            if on("axes") and camera is not None:
                layers += axes(state, camera)
        if on("trace"):
            layers += self._trace()
        return layers

    def over_avatar(self, driven: FaceState) -> list[Layer]:
        """Return what lies over the avatar's picture."""
        if not self._deeds.on("bars"):
            return []
        return [Bars(driven.expression, EXPRESSION_NAMES)]

    def _camera(self) -> Camera | None:
        tracker = self._performer.tracker if self._performer is not None else None
        camera: Camera | None = getattr(tracker, "camera", None)
        return camera

    def _points(self, state: FaceState, camera: Camera) -> list[Layer]:
        regressor = self._performer.regressor if self._performer is not None else None
        if regressor is None or state.mode != "trained":
            return []
        places_px = project(camera, appearance_points_mm(regressor, state.shape_mm))
        return [Points(places_px, radius=1.2, color=APPEARANCE_COLOR)]

    def _trace(self) -> list[Layer]:
        history = np.array(list(self._history))
        if len(history) < 2:
            return []
        ages_s = history[-1, 0] - history[:, 0]
        kept = (ages_s >= 0) & (ages_s <= TRACE_S)
        return [Trace(ages_s[kept], history[kept, 1], history[kept, 2], TRACE_S)]

    # -- the mesh ------------------------------------------------------------------------

    def _make_mesh(self) -> None:
        if self._job.busy or self._mesh is not None or self._performer is None:
            return
        if not self._deeds.on("mesh"):
            return
        user = self._user
        job = self._job.put(_mesh_steps(self._maker, user))
        job.returned.connect(lambda mesh: self._on_mesh(mesh, user))
        job.start()

    def _on_mesh(self, mesh: FaceMesh, user: UserBlendshapes | None) -> None:
        if user is self._user:
            self._mesh = mesh


def _mesh_steps(
    maker: MeshMaker, user: UserBlendshapes | None
) -> Generator[Progress, None, FaceMesh]:
    yield Progress(0, 1, "Making the mesh")
    return maker.face_mesh(user)


def axes(state: FaceState, camera: Camera) -> list[Layer]:
    """Return the head's axes: its left, up and where the face looks, in AXIS_COLORS."""
    rotation = matrix_from_quaternion(state.rotation_wxyz)
    ends_mm = state.translation_mm + AXIS_MM * (AXES @ rotation.T)
    if min(ends_mm[:, 2].min(), state.translation_mm[2]) < NEAREST_MM:
        return []
    start, *ends = project(camera, np.vstack([state.translation_mm, ends_mm]))
    return [
        Lines(np.concatenate([start, end])[None], color, 3.0)
        for end, color in zip(ends, AXIS_COLORS, strict=True)
    ]


def appearance_points_mm(regressor: FernRegressor, shape_mm: FloatArray) -> FloatArray:
    """Return the appearance points of the first stage on a shape (P, 3).

    Points that a pupil carries are left out: states tell only where landmarks are.
    """
    points = regressor.points(0)
    kept = (points.corners < N_LANDMARKS).all(axis=1)
    corners = shape_mm[points.corners[kept]]
    return np.asarray(np.einsum("pk,pkc->pc", points.weights[kept].astype(float), corners))
