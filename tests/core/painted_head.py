"""Pictures of a whole head whose skin has a pattern of its own, before a grey wall."""

import cv2
import numpy as np

from core.camera import project
from core.face_model import PART_NAMES
from core.fit_problem import State
from core.geometry import matrix_from_head_angles
from core.profile_search import posed_mm


def head_state(angles, place_mm):
    """The neutral face at head angles, turned in the picture plane by a fourth one if given."""
    in_plane = matrix_from_head_angles(0, 0, angles[3] if len(angles) > 3 else 0.0)
    rotation = in_plane @ matrix_from_head_angles(*angles[:3])
    return State(rotation[None], np.array([place_mm], float), np.zeros((1, 46)))


def head_picture(model, user, camera, state):
    """Grey levels of the head, triangle by triangle, the near ones last."""
    waves = np.random.default_rng(0).normal(0, 0.06, (6, 3))
    levels = 128 + 20 * np.sin(user.neutral_mm @ waves.T).sum(axis=1)
    width, height = camera.size_px
    canvas = np.full((height, width), 90, np.uint8)
    points = posed_mm(user, state)
    pixels = np.rint(project(camera, points)).astype(np.int32)
    skin = model.triangles[model.part == PART_NAMES.index("skin")]
    for corners in skin[np.argsort(-points[skin, 2].mean(axis=1))]:
        level = float(np.clip(levels[corners].mean(), 0, 255))
        cv2.fillConvexPoly(canvas, pixels[corners], level)
    return canvas
