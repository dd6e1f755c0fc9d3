"""Puts a virtual performer before a camera."""

from app.avatars.wardrobe import load_wardrobe
from app.performer.lights import LIGHTS
from app.performer.people import load_person
from app.performer.performer import Filming, VirtualPerformer
from app.performer.room import paint_room
from app.performer.stage import Setting
from app.performer.takes import Take
from app.resources import asset
from core.camera import camera_for
from core.face_model import FaceModel

SIZE_PX = (640, 480)
#: Of a usual webcam: 54 degrees across.
FOCAL_PX = 620.0


def perform(
    model: FaceModel, take: Take, person: str = "mara", filming: Filming | None = None,
    focal_px: float = FOCAL_PX, lights: str = "window",
) -> VirtualPerformer:  # fmt: skip
    """Return a performer who plays a take.

    Args:
        model: The face model, for its topology.
        take: What to play.
        person: A key of CAST.
        filming: How it is filmed.
        focal_px: Of the webcam, at 640x480.
        lights: A key of LIGHTS.
    """
    setting = Setting(
        model, load_person(asset("people.npz"), model, person), load_wardrobe(asset("."), model),
        camera_for(SIZE_PX, focal_px), LIGHTS[lights], paint_room(SIZE_PX, seed=1),
    )  # fmt: skip
    return VirtualPerformer(take, setting, filming)
