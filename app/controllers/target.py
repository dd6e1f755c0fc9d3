"""The face that shows what is asked for: it goes there from a neutral one, again and again."""

import numpy as np
from PySide6.QtCore import QObject, QTimer

from app.controllers.scene import AvatarScene, Studio
from app.views.picture_view import PictureView, image_from_array
from app.workers.avatar_loop import Painted
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.live import resting_state
from core.records import FaceState
from core.setup_plan import Shot

#: The avatar that shows what is asked for.
MODEL_AVATAR = "nora"
TARGET_EVERY_MS, TURN_S, STAY_S = 40, 0.9, 1.6


class Target(QObject):
    """Lets an avatar perform a prompt in a view."""

    def __init__(self, view: PictureView, studio: Studio, parent: QObject | None = None) -> None:
        super().__init__(parent or view)
        self._view, self._phase_s = view, 0.0
        self._shot: Shot | None = None
        self._scene = AvatarScene(studio, MODEL_AVATAR, self)
        self._timer = QTimer(self)
        self._scene.painted.connect(self._on_painted)
        self._timer.timeout.connect(self._animate)

    def start(self) -> None:
        """Begin to perform."""
        self._scene.enter(None)
        self._timer.start(TARGET_EVERY_MS)

    def stop(self) -> None:
        """End the render thread and wait for that."""
        self._timer.stop()
        self._scene.stop()

    def aim(self, shot: Shot | None) -> None:
        """Perform another prompt from its beginning; None rests."""
        self._shot, self._phase_s = shot, 0.0

    def _animate(self) -> None:
        """Let the avatar go from a neutral face to what is asked for, and stay there a while."""
        self._phase_s = (self._phase_s + TARGET_EVERY_MS / 1000) % (TURN_S + STAY_S)
        share = min(self._phase_s / TURN_S, 1.0)
        self._scene.show(target_state(self._shot, share * share * (3 - 2 * share)), 0.0)

    def _on_painted(self, painted: Painted) -> None:
        self._view.show_image(image_from_array(painted.picture))


def target_state(shot: Shot | None, share: float) -> FaceState:
    """Return a share of what a prompt asks for, as its mirror image: the user copies a mirror."""
    rest = resting_state("free")
    if shot is None:
        return rest
    angles = share * np.array([shot.yaw, shot.pitch, shot.roll])
    return FaceState(
        0.0, quaternion_from_matrix(matrix_from_head_angles(*angles)), np.array([0, 0, 600.0]),
        share * shot.standard, rest.gaze_rad, rest.shape_mm, rest.landmarks_px, 1.0, "free", False,
    )  # fmt: skip
