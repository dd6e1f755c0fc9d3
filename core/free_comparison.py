"""The training-free mode on the pictures that a training is tested on: what the training brings.

Both modes are measured against the same thing, the faces that were fitted to the pictures'
landmarks. The training-free mode gets the landmarks that the aligner found in the very picture, and
those the fit follows wherever the user has not corrected them; so its distance in px is small by
the way it is measured. Its rotation is not.
"""

from collections.abc import Generator, Sequence

import numpy as np

from core.camera import project
from core.error_summary import by_expression, by_yaw, summary
from core.face_model import FaceModel
from core.free_live import FreeSettings, FreeTracker
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.held_out import eye_distance_px, faces_of, yaws_deg
from core.held_out_choice import held_out_rows
from core.held_out_pairs import Measured
from core.landmark_flow import Followed
from core.landmarks import N_LANDMARKS
from core.records import FaceState, FloatArray, Frame, Landmarks2D, Progress

LABEL = "Comparing with the training-free mode"
#: A picture is looked at so many times, as still frames of a video are.
LOOKS, FPS = 2, 30.0


class _Shown:
    """A follower that gives the landmarks it was given."""

    def __init__(self) -> None:
        self.now: Followed | None = None

    def step(self, frame: Frame) -> Followed | None:
        """Return the landmarks of the picture shown."""
        return self.now

    def reset(self) -> None:
        """Forget nothing: there is no past."""


class _Session:
    """Somebody who shows one picture after the other to the training-free tracker."""

    def __init__(self, model: FaceModel, pictures: Measured, learn: bool) -> None:
        self._shown = _Shown()
        self._tracker = FreeTracker(model, self._shown, None, FreeSettings(learn=learn))
        width, height = pictures.camera.size_px
        self._blank = np.zeros((height, width, 3), np.uint8), np.zeros((height, width), np.uint8)
        self._time_s = 0.0

    def show(self, landmarks: Landmarks2D) -> FaceState:
        """Return the face found in a picture, which has nothing to do with the one before."""
        self._tracker.reset()
        seen = bool(landmarks.confidence.any())
        self._shown.now = Followed(landmarks, None, True, 1.0) if seen else None
        for _ in range(LOOKS):
            self._time_s += 1 / FPS
            state = self._tracker.step(Frame(*self._blank, self._time_s, 0))
        return state


def free_report(
    model: FaceModel, pictures: Measured, found: Sequence[Landmarks2D], every: int
) -> Generator[Progress, None, dict[str, object]]:
    """Return the errors of the training-free mode on the held-out pictures.

    Args:
        model: The face model.
        pictures: All that were trained or tested on; their grey levels are not looked at.
        found: N pictures' landmarks as the aligner found them.
        every: As the held-out test was made.

    Yields:
        Progress.

    Returns:
        Figures "at_first" with anybody's face and an unknown camera, and "later", when the
        tracker has seen the other pictures; distances for pictures 640 px wide.
    """
    held = held_out_rows(pictures.names, every)
    told: dict[str, object] = {}
    for done, (key, learn) in enumerate((("at_first", False), ("later", True))):
        yield Progress(done, 2, LABEL)
        session = _Session(model, pictures, learn)
        if learn:
            for row in set(range(len(pictures.names))) - set(held):
                session.show(found[row])
        told[key] = _figures(pictures, held, [session.show(found[row]) for row in held])
    return told


def _figures(
    pictures: Measured, held: Sequence[int], states: Sequence[FaceState]
) -> dict[str, object]:
    seen = [row for row, state in zip(held, states, strict=True) if not state.lost]
    told: dict[str, object] = {"pictures": len(held), "lost": len(held) - len(seen)}
    if not seen:
        return told
    kept = [state for state in states if not state.lost]
    true_px = project(pictures.camera, pictures.shapes.points_mm[seen, :N_LANDMARKS])
    off = np.array([state.landmarks_px for state in kept]) - true_px
    rmse = pictures.px_at_640 * np.sqrt(np.mean(np.sum(off**2, axis=2), axis=1))
    turn = _turns_deg(kept, pictures.shapes.rotations_wxyz[seen])
    return told | {
        **summary(rmse, turn, eye_distance_px(pictures)),
        "by_yaw": by_yaw(yaws_deg(pictures)[seen], rmse, turn),
        "by_expression": by_expression(faces_of(pictures)[seen], rmse, turn),
    }


def _turns_deg(states: Sequence[FaceState], rotations_wxyz: FloatArray) -> FloatArray:
    """Return the size of the rotations (S, 3) between states and fit, as head angles."""
    found = matrix_from_quaternion(np.array([state.rotation_wxyz for state in states]))
    true = matrix_from_quaternion(rotations_wxyz)
    left = found @ np.swapaxes(true, 1, 2)
    return np.abs(np.rad2deg([head_angles_from_matrix(one) for one in left]))
