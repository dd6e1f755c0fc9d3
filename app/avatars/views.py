"""Where head, body and camera are: a portrait, or exactly over the source's picture."""

from dataclasses import dataclass, replace

import numpy as np

from app.render.avatar import Avatar
from app.render.look import AvatarLook
from app.render.puppet import body_below
from app.render.scene import View, placed
from core.camera import camera_for
from core.geometry import (
    head_angles_from_matrix,
    matrix_from_head_angles,
    matrix_from_quaternion,
    matrix_from_rotation_vector,
    rotation_facing_camera,
    rotation_vector_from_matrix,
)
from core.records import Camera, FloatArray

#: Distance of the portrait's camera from the eyes.
_DISTANCE_MM = 1000.0
#: Framing: height of what is seen at the eyes, and how far below them its middle lies.
_FRAMED_MM = {"shoulders": (350.0, 22.0), "bust": (510.0, 86.0), "close": (272.0, 4.0)}
#: Hair and ears up to here above the eyes fit into the picture; above, more is seen.
_ROOM_MM = 134.0
#: The way round leads about a point so far behind the eyes: the middle of the skull.
_MIDDLE_OF_SKULL_MM = 85.0
#: Share of the head's own movement that a portrait shows, and how far it lets it go.
_MOVES, _FURTHEST_MM = 0.35, 45.0
#: The neck bends at its foot, too: so far below and behind the skull's joint, by this share of
#: the head's turn.
_FOOT_OF_NECK_MM, _AT_FOOT = np.array([0.0, 78.0, 22.0]), 0.3
#: Share of the head's yaw, pitch and roll that the shoulders make.
_SHOULDERS = np.array([0.2, 0.06, 0.12])
#: Who leans aside, forward or back turns about the hips, so far below the skull's joint.
_TO_HIPS_MM = 520.0


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
    look: AvatarLook | None = None,
) -> Framing:
    """Return a head-and-shoulders picture that follows the head's turn and a little of its way.

    A head at the side of the source's picture that looks into the camera is seen from the
    front there; so it is here: its rotation is taken relative to its direction of view.

    Args:
        avatar: Its neck's pivot and its height.
        size_px: (width, height) of the picture.
        rotation_wxyz: (4,) model to the source's camera.
        translation_mm: (3,) in the source's camera.
        rest_mm: (3,) the translation at which the portrait is centred; None keeps it centred.
        look: From where and how near the picture is taken; None as at first.
    """
    turn = rotation_facing_camera(translation_mm).T @ matrix_from_quaternion(rotation_wxyz)
    away = np.zeros(3) if rest_mm is None else np.asarray(translation_mm) - rest_mm
    away = _MOVES * away
    away *= min(1.0, _FURTHEST_MM / max(float(np.linalg.norm(away)), 1e-9))
    return seen(avatar, size_px, *_posture(avatar, turn, away), look or AvatarLook())


def _posture(avatar: Avatar, turn: FloatArray, away: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the places (4, 4) of head and body against eyes at rest.

    The skull turns on the neck, the neck on the chest, and the shoulders follow a little: who
    nods moves the head forward, who tilts it moves it aside.

    Args:
        avatar: Its neck's pivot.
        turn: (3, 3) the head's, the identity for one that looks straight ahead.
        away: (3,) mm that it has moved.
    """
    angles = _SHOULDERS * head_angles_from_matrix(turn)
    lean = np.array([-away[2], 0.0, away[0]]) / _TO_HIPS_MM
    chest = matrix_from_rotation_vector(lean) @ matrix_from_head_angles(*angles)
    bend = matrix_from_rotation_vector(_AT_FOOT * rotation_vector_from_matrix(turn))
    joint = avatar.pivot_mm + away
    top = joint + _FOOT_OF_NECK_MM - bend @ _FOOT_OF_NECK_MM
    return (
        placed(turn, top - turn @ avatar.pivot_mm),
        placed(chest, joint - chest @ avatar.pivot_mm),
    )


def seen(
    avatar: Avatar,
    size_px: tuple[int, int],
    head: FloatArray,
    body: FloatArray,
    look: AvatarLook,
) -> Framing:
    """Return how a figure is seen from where a look says.

    Args:
        avatar: How tall it is.
        size_px: (width, height) of the picture.
        head: (4, 4) place of the head against eyes at rest, x right, y down, z away.
        body: (4, 4) the same of the body.
        look: Orbit, zoom, pan, framing and mirror.
    """
    height_mm, middle_mm = _framed(avatar, look.framing)
    middle = np.array([0.0, middle_mm, _MIDDLE_OF_SKULL_MM])
    # Going to the figure's left, the camera sees it turn to its right.
    side = matrix_from_rotation_vector(np.array([0.0, look.yaw_rad, 0.0]))
    above = matrix_from_rotation_vector(np.array([look.pitch_rad, 0.0, 0.0]))
    orbit = placed(above @ side, np.array([0.0, 0.0, _DISTANCE_MM + _MIDDLE_OF_SKULL_MM]))
    to_camera = orbit @ placed(np.eye(3), -middle)
    camera = camera_for(size_px, look.zoom * size_px[1] * _DISTANCE_MM / height_mm)
    across = -look.pan[0] if look.mirrored else look.pan[0]
    center_px = camera.center_px + size_px[1] * np.array([across, look.pan[1]])
    view = View(replace(camera, center_px=center_px), mirrored=look.mirrored, samples=look.samples)
    return Framing(view, to_camera @ head, to_camera @ body)


def _framed(avatar: Avatar, framing: str) -> tuple[float, float]:
    """Return height and middle of what is seen; tall hair and ears make room for themselves."""
    height_mm, middle_mm = _FRAMED_MM[framing]
    more = max(0.0, -float(avatar.neutral_mm[:, 1].min()) - _ROOM_MM)
    return height_mm + more, middle_mm - more / 2


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
