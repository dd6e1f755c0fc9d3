"""Faces of the shipped model and their 75 landmarks in a picture, as an aligner would find them."""

from functools import cache

import numpy as np

from core.camera import camera_for, project
from core.contour import contour_points
from core.face_model import load_face_model
from core.fit_space import fit_space
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.landmarks import N_INTERNAL
from tests.core.tracked_faces import ASSETS, head_pose

CAMERA = camera_for((640, 480), 620.0)
SURE = np.ones(75)


@cache
def face(seed=None):
    """Return the mean face at the points of a fit, or a random person's."""
    space = fit_space(load_face_model(ASSETS / "face_model.npz"))
    rng = np.random.default_rng(seed)
    size = space.n_identities
    identity = np.zeros(size) if seed is None else rng.standard_normal(size)
    return space.face(identity, np.zeros((N_INTERNAL, 3)))


def landmarks(person, coefficients, pose, camera=CAMERA):
    """Return the landmarks (75, 2) of a face under a pose (4, 3)."""
    posed = person.points_mm(coefficients[None])[0] @ pose[:3].T + pose[3]
    rim = contour_points(person.neutral_mm, posed[None], pose[None, :3], person.strips)[0]
    return project(camera, posed[np.concatenate([np.arange(N_INTERNAL), rim])])


def nodding(k, fps=30.0):
    """Return the pose (4, 3) of a head that looks around, at frame k."""
    t = k / fps
    return head_pose(0.5 * np.sin(2 * t), 0.2 * np.sin(3 * t), 0.1, (15 * np.sin(t), -10, 600))


def turned_deg(solved, pose):
    """Return the largest difference of a solved rotation's head angles from a pose."""
    angles = head_angles_from_matrix(matrix_from_quaternion(solved.rotation_wxyz))
    return float(np.rad2deg(np.abs(angles - head_angles_from_matrix(pose[:3])).max()))
