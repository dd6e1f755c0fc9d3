"""Draws assets/avatars/thumbnails: a small picture of every built-in avatar, for lists.

`python -m assets.build.avatar_thumbnails`; to be run again when avatars change.
"""

from pathlib import Path

import cv2
import numpy as np

from app.avatars.gallery import Gallery
from app.avatars.painter import AvatarPainter, AvatarWish
from app.avatars.views import Framing, portrait
from app.render.renderer import Renderer
from app.render.scene import View
from core.camera import camera_for
from core.face_model import load_face_model
from core.geometry import matrix_from_head_angles, quaternion_from_matrix

ASSETS = Path(__file__).resolve().parents[1]
OUT = ASSETS / "avatars" / "thumbnails"
SIZE, DRAWN = 96, 480
#: Yaw and pitch of the heads.
ANGLES_DEG = (14.0, 3.0)


def main() -> None:
    """Draw all pictures."""
    gallery = Gallery(ASSETS, load_face_model(ASSETS / "face_model.npz"))
    painter = AvatarPainter(Renderer())
    OUT.mkdir(exist_ok=True)
    for name in gallery.names:
        picture = thumbnail(painter, gallery, name)
        path = OUT / f"{name}.jpg"
        cv2.imwrite(str(path), picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 88])
        print(f"{path.name}: {path.stat().st_size} bytes")


def thumbnail(painter: AvatarPainter, gallery: Gallery, name: str) -> np.ndarray:
    """Return the picture (S, S, 3) of an avatar."""
    avatar = gallery.built_in(name)
    turn = quaternion_from_matrix(matrix_from_head_angles(*np.deg2rad(ANGLES_DEG), 0.0))
    framing = portrait(avatar, (DRAWN, DRAWN), turn, np.array([0.0, 0, 600]))
    # Nearer than the live view: a face must be known at the size of a line of text.
    camera = camera_for((DRAWN, DRAWN), framing.view.camera.focal_px * 1.22)
    near = Framing(View(camera), framing.head_to_camera, framing.body_to_camera)
    wish = AvatarWish(avatar, near, np.zeros(46), np.zeros((2, 2)))
    picture = painter.draw(wish)[..., :3]
    return cv2.resize(picture, (SIZE, SIZE), interpolation=cv2.INTER_AREA)


if __name__ == "__main__":
    main()
