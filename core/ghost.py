"""The outline of a head that is held as asked, where the user's head is now: a ghost to move into.

An arrow says which way to turn; the ghost shows how far. It is drawn from the user's own neutral
head, as far as it is known, turned as the prompt asks.
"""

from dataclasses import dataclass

import numpy as np

from core.camera import project
from core.face_model import FaceModel
from core.geometry import matrix_from_head_angles, matrix_from_quaternion
from core.landmarks import CURVES, N_INTERNAL, NAMES
from core.records import I32, Camera, FaceState, FloatArray
from core.setup_plan import Shot

#: The joint on which a head turns, in the model frame.
NECK_MM = np.array([0.0, 70.0, 90.0])
#: Directions in which the outline is looked for.
N_DIRECTIONS = 60
#: The neck begins below the line from the chin to the nape: how much it rises per mm backwards.
NAPE_RISE = 0.4
#: Share of the directions beside in the reach of one.
SMOOTHING = {-2: 0.1, -1: 0.25, 0: 0.3, 1: 0.25, 2: 0.1}
#: A curve of the face is shown while it points so much towards the camera.
FACING = 0.15


@dataclass(frozen=True, slots=True, eq=False)
class Ghost:
    """Lines over a picture.

    Attributes:
        outline_px: (N_DIRECTIONS, 2) closed outline of the head.
        curves_px: Brows, eyes, nose and lips that would be seen, each (n, 2).
    """

    outline_px: FloatArray
    curves_px: tuple[FloatArray, ...]


class GhostHead:
    """Knows which vertices of the face model are the head and which its features."""

    def __init__(self, model: FaceModel) -> None:
        """Prepare; takes some milliseconds.

        Args:
            model: The face model.
        """
        self._marks: I32 = model.landmark_vertices
        mean = model.mean_mm.astype(float)
        strip = model.contour_strips[NAMES.index("chin") - N_INTERNAL]
        under_chin = mean[strip[strip >= 0][-1]]
        behind_mm = np.maximum(mean[:, 2] - under_chin[2], 0.0)
        above = mean[:, 1] <= under_chin[1] - NAPE_RISE * behind_mm
        skin = np.zeros(len(mean), bool)
        skin[np.unique(model.triangles[model.part_triangles("skin")])] = True
        self._head: I32 = np.flatnonzero(above & skin)[::2].astype(np.int32)

    def ghost(
        self, shot: Shot, neutral_mm: FloatArray, facing_wxyz: FloatArray, state: FaceState,
        camera: Camera,
    ) -> Ghost:  # fmt: skip
        """Return the lines of a head held as a prompt asks.

        Args:
            shot: The prompt.
            neutral_mm: (V, 3) the user's head.
            facing_wxyz: (4,) rotation of the head when the user looks straight ahead.
            state: Where the head is now.
            camera: Of the picture.
        """
        turned = matrix_from_quaternion(facing_wxyz) @ matrix_from_head_angles(
            shot.yaw, shot.pitch, shot.roll
        )
        # The neck stays where it is while the head turns on it.
        now = matrix_from_quaternion(state.rotation_wxyz)
        place = state.translation_mm + (now - turned) @ NECK_MM
        head = neutral_mm[self._head] @ turned.T + place
        marks = neutral_mm[self._marks] @ turned.T + place
        ahead = marks - head.mean(axis=0)
        toward = -ahead[:, 2] / np.linalg.norm(ahead, axis=1)
        marks_px = project(camera, marks)
        curves = tuple(
            marks_px[list(curve)] for curve in CURVES
            if max(curve) < N_INTERNAL and toward[list(curve)].mean() > FACING
        )  # fmt: skip
        return Ghost(outline(project(camera, head)), curves)


def outline(points_px: FloatArray) -> FloatArray:
    """Return the outline (N_DIRECTIONS, 2) of points (P, 2) as seen from their middle.

    In each direction it goes through the outermost point: nose and chin of a profile show.
    """
    middle = 0.5 * (points_px.min(axis=0) + points_px.max(axis=0))
    away = points_px - middle
    angle = np.arctan2(away[:, 1], away[:, 0])
    which = np.floor((angle + np.pi) / (2 * np.pi) * N_DIRECTIONS).astype(int) % N_DIRECTIONS
    distance = np.hypot(away[:, 0], away[:, 1])
    reach = np.zeros(N_DIRECTIONS)
    np.maximum.at(reach, which, distance)
    # Vertices lie apart where the skull is smooth: some directions miss the outermost one.
    reach = np.maximum.reduce([np.roll(reach, step) for step in (-1, 0, 1)])
    smooth = np.sum([share * np.roll(reach, step) for step, share in SMOOTHING.items()], axis=0)
    center = (np.arange(N_DIRECTIONS) + 0.5) / N_DIRECTIONS * 2 * np.pi - np.pi
    around = np.column_stack([np.cos(center), np.sin(center)])
    return np.asarray(middle + smooth[:, None] * around)
