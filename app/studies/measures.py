"""Errors of a track: angles and places of the head, landmarks, coefficients, jitter."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from core.camera import project
from core.evaluation import Truth, frame_rmse_px, jitter
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.landmarks import N_INTERNAL
from core.records import Camera, FloatArray, freeze

MM_PER_INCH = 25.4
#: Coefficients this large in the truth count as shown.
_SHOWN = 0.3


class Posed(Protocol):
    """A pose of a head: of a FaceState, of what a solver gives, or of a truth."""

    @property
    def rotation_wxyz(self) -> FloatArray:
        """(4,) model to camera."""
        ...

    @property
    def translation_mm(self) -> FloatArray:
        """(3,) model to camera."""
        ...


class Expressive(Protocol):
    """What has coefficients: a FaceState, what a solver gives, or a truth."""

    @property
    def expression(self) -> FloatArray:
        """(B,) coefficients."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class PoseErrors:
    """How far the pose is off in every frame.

    Attributes:
        degrees: (N, 3) roll, pitch, yaw.
        mm: (N, 3) x, y, z.
    """

    degrees: FloatArray
    mm: FloatArray

    def __post_init__(self) -> None:
        freeze(self, degrees=(np.float64, ("N", 3)), mm=(np.float64, ("N", 3)))


def together(errors: Sequence[PoseErrors]) -> PoseErrors:
    """Return the errors of several films as of one."""
    return PoseErrors(
        np.concatenate([e.degrees for e in errors]), np.concatenate([e.mm for e in errors])
    )


def pose_errors(posed: Sequence[Posed], truths: Sequence[Posed]) -> PoseErrors:
    """Return the errors of pose in the camera frame."""
    pairs = list(zip(posed, truths, strict=True))
    angles = [head_angles_deg(p.rotation_wxyz) - head_angles_deg(t.rotation_wxyz) for p, t in pairs]
    shifts = [p.translation_mm - t.translation_mm for p, t in pairs]
    return PoseErrors(
        np.reshape(wrapped_deg(np.array(angles)), (-1, 3)), np.reshape(shifts, (-1, 3))
    )


def head_angles_deg(rotation_wxyz: FloatArray) -> FloatArray:
    """Return (3,) roll, pitch, yaw of a head, degrees."""
    yaw, pitch, roll = head_angles_from_matrix(matrix_from_quaternion(rotation_wxyz))
    return np.rad2deg([roll, pitch, yaw])


def since_first(posed: Sequence[Posed]) -> FloatArray:
    """Return (N, 6) roll, pitch, yaw in degrees and x, y, z in mm since the first pose.

    The Boston University films begin with a face that looks into the camera, and their truth
    counts from there; what a tracker thinks to be straight ahead then cancels. Angles are about
    the camera's x, y, z axes in this order, those that the truth is written in.
    """
    matrices = matrix_from_quaternion(np.array([one.rotation_wxyz for one in posed]))
    places = np.array([one.translation_mm for one in posed])
    turned = matrices[0].T @ matrices
    angles = [
        np.arctan2(-turned[:, 0, 1], turned[:, 0, 0]),
        np.arctan2(turned[:, 1, 2], turned[:, 2, 2]),
        -np.arcsin(np.clip(turned[:, 0, 2], -1, 1)),
    ]
    return np.concatenate([np.rad2deg(angles).T, places - places[0]], axis=1)


def wrapped_deg(angles: FloatArray) -> FloatArray:
    """Return angles in [-180, 180)."""
    return np.asarray((np.asarray(angles) + 180.0) % 360.0 - 180.0)


def errors_since_first(posed: Sequence[Posed], truths: Sequence[Posed]) -> PoseErrors:
    """Return the errors of the movement since the first frame."""
    return errors_between(since_first(posed), since_first(truths))


def errors_between(found: FloatArray, true: FloatArray) -> PoseErrors:
    """Return the errors of a movement (N, 6) as `since_first` gives it."""
    off = found - true
    return PoseErrors(wrapped_deg(off[:, :3]), off[:, 3:])


def landmark_errors_px(
    points_px: Sequence[FloatArray], truths: Sequence[Truth], camera: Camera
) -> FloatArray:
    """Return the root mean square error of the internal landmarks of each frame (N,)."""
    true = np.array([project(camera, t.points_mm[:N_INTERNAL]) for t in truths])
    return frame_rmse_px(np.array([p[:N_INTERNAL] for p in points_px]), true)


def coefficient_errors(
    found: Sequence[Expressive], truths: Sequence[Expressive]
) -> tuple[float, float]:
    """Return the mean error of all coefficients, and of those that are clearly shown."""
    off = np.abs([f.expression - t.expression for f, t in zip(found, truths, strict=True)])
    shown = np.array([t.expression for t in truths]) > _SHOWN
    return float(off.mean()), float(off[shown].mean()) if shown.any() else float("nan")


def shake(values: FloatArray) -> FloatArray:
    """Return the noise (D,) of a track (N, D) from frame to frame; slow movement cancels."""
    still = np.ones(len(values), bool)
    return np.array([jitter(column, still) for column in np.asarray(values).T])
