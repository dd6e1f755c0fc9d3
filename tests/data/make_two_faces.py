"""Make two_faces.jpg and two_faces.npz: a near and a far performer with their true landmarks.

Run as `python -m tests.data.make_two_faces`; it needs an offscreen OpenGL context.
"""

from pathlib import Path

import cv2
import numpy as np

from app.performer.opening import setup_pictures
from core.camera import camera_for, project

FOLDER = Path(__file__).resolve().parent
NEAR, FAR = "pose_yaw+0", "pose_yaw+30"
SIZE_PX = (400, 240)
#: Scale and left top corner of each picture in the whole.
PLACES = {NEAR: (0.6, (-90, -20)), FAR: (0.5, (160, 0))}
#: Columns that show each.
HALVES = {NEAR: (0, 220), FAR: (220, 400)}


def main() -> None:
    """Write both files."""
    whole = np.full((*SIZE_PX[::-1], 3), 110, np.uint8)
    truths = {}
    for name, frame, truth in setup_pictures():
        if name not in PLACES:
            continue
        scale, (x, y) = PLACES[name]
        small = cv2.resize(frame.rgb, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        left, top = max(x, HALVES[name][0], 0), max(y, 0)
        right, low = min(x + small.shape[1], HALVES[name][1]), min(y + small.shape[0], SIZE_PX[1])
        whole[top:low, left:right] = small[top - y : low - y, left - x : right - x]
        camera = camera_for((frame.rgb.shape[1], frame.rgb.shape[0]), 620.0)
        truths[name] = (project(camera, truth.points_mm) + 0.5) * scale - 0.5 + [x, y]
    bgr = cv2.cvtColor(whole, cv2.COLOR_RGB2BGR)
    cv2.imwrite(str(FOLDER / "two_faces.jpg"), bgr, [cv2.IMWRITE_JPEG_QUALITY, 85])
    np.savez_compressed(FOLDER / "two_faces.npz", near=truths[NEAR], far=truths[FAR])


if __name__ == "__main__":
    main()
