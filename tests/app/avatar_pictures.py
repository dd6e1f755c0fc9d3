"""The small pictures of an avatar that tests compare with, and the program that makes them.

Run `python -m tests.app.avatar_pictures` after the face model, textures or shaders were changed
on purpose, and look at the pictures before they are committed.
"""

from pathlib import Path

import cv2
import numpy as np

from app.avatars.gallery import Gallery
from app.avatars.painter import AvatarPainter, AvatarWish
from app.avatars.views import portrait
from app.render.renderer import Renderer
from app.resources import asset
from core.arkit import EXPRESSION_NAMES
from core.face_model import load_face_model
from core.geometry import matrix_from_head_angles, quaternion_from_matrix

FOLDER = Path(__file__).resolve().parents[1] / "data" / "avatar"
SIZE_PX = (160, 160)
#: Name: head angles and gaze in degrees, expression.
POSES = {
    "rest": ((0, 0, 0), (0, 0), {}),
    "smile": ((-20, 5, 0), (10, 0), {"mouthSmileLeft": 1, "mouthSmileRight": 1}),
    "surprise": ((15, -8, 6), (0, 5), {"jawOpen": 0.8, "eyeWideLeft": 1, "eyeWideRight": 1}),
    "blink": ((0, 10, -8), (0, 0), {"eyeBlinkLeft": 1, "eyeBlinkRight": 1}),
}


def expression_of(shapes):
    weights = np.zeros(len(EXPRESSION_NAMES))
    for name, weight in shapes.items():
        weights[EXPRESSION_NAMES.index(name)] = weight
    return weights


def default_gallery():
    return Gallery(asset("avatars").parent, load_face_model(asset("face_model.npz")))


def draw(painter, avatar, angles_deg, gaze_deg, shapes, *, size_px=SIZE_PX):
    rotation = quaternion_from_matrix(matrix_from_head_angles(*np.deg2rad(angles_deg)))
    framing = portrait(avatar, size_px, rotation, np.array([0.0, 0.0, 600.0]))
    gaze = np.deg2rad(np.array([gaze_deg, gaze_deg], float))
    wish = AvatarWish(avatar, framing, expression_of(shapes), gaze, transparent=True)
    return painter.draw(wish)


def stored(name):
    picture = cv2.imread(str(FOLDER / f"{name}.png"), cv2.IMREAD_UNCHANGED)
    return cv2.cvtColor(picture, cv2.COLOR_BGRA2RGBA)


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    gallery = default_gallery()
    avatar = gallery.built_in(gallery.names[0])
    renderer = Renderer()
    painter = AvatarPainter(renderer)
    for name, pose in POSES.items():
        picture = draw(painter, avatar, *pose)
        cv2.imwrite(str(FOLDER / f"{name}.png"), cv2.cvtColor(picture, cv2.COLOR_RGBA2BGRA))
    renderer.release()


if __name__ == "__main__":
    main()
