"""What is really there: the performer's state and shape at any time of a take."""

import numpy as np

from app.performer.people import Person
from app.performer.posture import Posture, posture_of
from app.performer.takes import Take
from app.render.puppet import lids_following
from core.evaluation import Truth
from core.face_model import FaceModel, eye_centers_mm, shape_vertices
from core.geometry import matrix_from_head_angles
from core.records import FloatArray

#: Where the eyes' midpoint is at rest in front of a webcam of 620 px focal length.
_SEAT_MM = np.array([0.0, -28.0, 590.0])
_USUAL_FOCAL_PX = 620.0


class Script:
    """Answers what a person does at a time of a take, seen from the webcam.

    It keeps the shapes of the 75 surface points apart from the mesh: asking costs microseconds.
    """

    def __init__(self, take: Take, person: Person, model: FaceModel, focal_px: float) -> None:
        self._take = take
        rows = shape_vertices(model)
        self._neutral, self._deltas = person.neutral_mm[rows], person.deltas_mm[:, rows]
        self._centers = eye_centers_mm(model, person.neutral_mm)
        balls = (model.eyeball_vertices_right, model.eyeball_vertices_left)
        self._radii = np.array([
            np.linalg.norm(person.neutral_mm[ball] - center, axis=1).mean()
            for ball, center in zip(balls, self._centers, strict=True)
        ])  # fmt: skip
        # Before a wider lens people sit closer, but not so close that the face looks as large.
        self._seat_mm = _SEAT_MM * [1, 1, np.sqrt(focal_px / _USUAL_FOCAL_PX)]

    def posture(self, time_s: float) -> Posture:
        """Return where head and body are."""
        return posture_of(self._take.at(time_s), self._seat_mm)

    def truth(self, time_s: float) -> Truth:
        """Return pose, expression, gaze and the 77 shape points.

        The expression is the one drawn: lids that follow the gaze are part of it.
        """
        moment, posture = self._take.at(time_s), self.posture(time_s)
        expression = lids_following(moment.expression, moment.gaze_rad)
        surface = self._neutral + np.tensordot(expression, self._deltas, axes=1)
        points = np.concatenate([surface, self._pupils(moment.gaze_rad)])
        head, place = posture.head_to_camera[:3, :3], posture.translation_mm
        return Truth(
            points @ head.T + place,
            posture.rotation_wxyz,
            posture.translation_mm,
            expression,
            moment.gaze_rad,
        )

    def _pupils(self, gaze_rad: FloatArray) -> FloatArray:
        """Return (2, 3) where the pupils are on the eyeballs, model frame."""
        forward = [-matrix_from_head_angles(yaw, pitch, 0.0)[:, 2] for yaw, pitch in gaze_rad]
        return np.asarray(self._centers + self._radii[:, None] * np.array(forward))
