"""Where head, body and camera are: a portrait, or exactly over the source's picture."""

from dataclasses import dataclass

import numpy as np

from app.render.avatar import Avatar
from app.render.puppet import body_below
from app.render.scene import View, placed
from core.camera import camera_for
from core.geometry import matrix_from_quaternion, rotation_facing_camera
from core.records import Camera, FloatArray

#: Distance of the portrait's camera and the height of what it sees at the head.
_DISTANCE_MM, _SEEN_MM = 1000.0, 350.0
#: The picture's middle lies this far below the eyes.
_MIDDLE_MM = 22.0
#: Share of the head's own movement that a portrait shows, and how far it lets it go.
_MOVES, _FURTHEST_MM = 0.35, 45.0


@dataclass(frozen=True, slots=True, eq=False)
class Framing:
    """The camera and the places of head and body in one picture.

    Attributes:
        view: The camera.
        head_to_camera: (4, 4).
        body_to_camera: (4, 4).
    """

    view: View
    head_to_camera: FloatArray
    body_to_camera: FloatArray


def portrait(
    avatar: Avatar,
    size_px: tuple[int, int],
    rotation_wxyz: FloatArray,
    translation_mm: FloatArray,
    rest_mm: FloatArray | None = None,
) -> Framing:
    """Return a head-and-shoulders picture that follows the head's turn and a little of its way.

    A head at the side of the source's picture that looks into the camera is seen from the
    front there; so it is here: its rotation is taken relative to its direction of view.

    Args:
        avatar: Its neck's pivot.
        size_px: (width, height) of the picture.
        rotation_wxyz: (4,) model to the source's camera.
        translation_mm: (3,) in the source's camera.
        rest_mm: (3,) the translation at which the portrait is centred; None keeps it centred.
    """
    turn = rotation_facing_camera(translation_mm).T @ matrix_from_quaternion(rotation_wxyz)
    away = np.zeros(3) if rest_mm is None else np.asarray(translation_mm) - rest_mm
    away = _MOVES * away
    away *= min(1.0, _FURTHEST_MM / max(float(np.linalg.norm(away)), 1e-9))
    place = np.array([0.0, -_MIDDLE_MM, _DISTANCE_MM])
    # The chest stays; the skull turns about the top of the neck.
    joint = place + avatar.pivot_mm + away
    head = placed(turn, joint - turn @ avatar.pivot_mm)
    focal_px = size_px[1] * _DISTANCE_MM / _SEEN_MM
    body = body_below(avatar, head, np.eye(3))
    return Framing(View(camera_for(size_px, focal_px)), head, body)


def overlay(
    avatar: Avatar, camera: Camera, rotation_wxyz: FloatArray, translation_mm: FloatArray
) -> Framing:
    """Return the avatar exactly where the head is in the source's picture.

    Args:
        avatar: Its neck's pivot.
        camera: The source's calibrated camera; the picture has its size.
        rotation_wxyz: (4,) model to camera.
        translation_mm: (3,) model to camera.
    """
    head = placed(matrix_from_quaternion(rotation_wxyz), np.asarray(translation_mm, float))
    return Framing(
        View(camera), head, body_below(avatar, head, rotation_facing_camera(translation_mm))
    )
