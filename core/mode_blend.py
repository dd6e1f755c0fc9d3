"""From one tracker's faces to another's without a jump.

Two trackers see one head slightly differently. At the change the difference between what was shown
and what the new tracker says is kept, and let go within a fraction of a second: the motion of the
new tracker passes at once, and only the difference is late.
"""

from dataclasses import dataclass, replace

import numpy as np

from core.camera import project
from core.geometry import multiply_quaternions
from core.records import Camera, FaceState, FloatArray

#: Mean distance of the landmarks, in parts of the face's size, that no two good trackers have.
_WRONG = 0.08


@dataclass(frozen=True, slots=True, eq=False)
class _Gap:
    """What was shown less what the new tracker said of about the same moment.

    Attributes:
        rotation_wxyz: (4,) from the new head to the shown one, in the camera frame.
        translation_mm: (3,).
        expression: (B,).
        gaze_rad: (2, 2).
        shape_mm: (L, 3).
    """

    rotation_wxyz: FloatArray
    translation_mm: FloatArray
    expression: FloatArray
    gaze_rad: FloatArray
    shape_mm: FloatArray


class StateBlend:
    """Hands states on, and bends the first ones after a change towards those before it."""

    def __init__(self, duration_s: float = 0.2, wrong_s: float = 0.07) -> None:
        """Prepare to hand on states.

        Args:
            duration_s: Time within which the difference is let go.
            wrong_s: The same where it is so large that what was shown was wrong.
        """
        self._usual_s, self._wrong_s = duration_s, wrong_s
        self._duration_s = duration_s
        self._shown: FaceState | None = None
        self._gap: _Gap | None = None
        self._began_s = 0.0

    def reset(self) -> None:
        """Forget the past: the next state is shown as it is."""
        self._shown, self._gap = None, None

    def step(self, state: FaceState, camera: Camera) -> FaceState:
        """Return the state to show; another mode than before means another tracker.

        After a loss nothing is blended: where the face was does not bear on where it is now.

        Args:
            state: Of the tracker that leads now.
            camera: Of the frame.
        """
        shown = self._shown
        if shown is None or shown.lost or state.lost or state.time_s < shown.time_s:
            self._gap = None
        elif state.mode != shown.mode:
            self._begin(shown, state)
        self._shown = self._bent(state, camera)
        return self._shown

    def _begin(self, shown: FaceState, state: FaceState) -> None:
        self._began_s = shown.time_s
        way_px = np.linalg.norm(shown.landmarks_px - state.landmarks_px, axis=1).mean()
        wrong = way_px > _WRONG * np.ptp(state.landmarks_px, axis=0).max()
        self._duration_s = self._wrong_s if wrong else self._usual_s
        back = state.rotation_wxyz * [1, -1, -1, -1]
        self._gap = _Gap(
            multiply_quaternions(shown.rotation_wxyz, back),
            shown.translation_mm - state.translation_mm,
            shown.expression - state.expression,
            shown.gaze_rad - state.gaze_rad,
            shown.shape_mm - state.shape_mm,
        )

    def _bent(self, state: FaceState, camera: Camera) -> FaceState:
        """Return the state with what is left of the gap added."""
        if self._gap is None:
            return state
        share = gap_share((state.time_s - self._began_s) / self._duration_s)
        if share == 0.0:
            self._gap = None
            return state
        gap = self._gap
        shape_mm = state.shape_mm + share * gap.shape_mm
        turn = part_of_rotation(gap.rotation_wxyz, share)
        return replace(
            state,
            rotation_wxyz=multiply_quaternions(turn, state.rotation_wxyz),
            translation_mm=state.translation_mm + share * gap.translation_mm,
            expression=np.clip(state.expression + share * gap.expression, 0.0, 1.0),
            gaze_rad=state.gaze_rad + share * gap.gaze_rad,
            shape_mm=shape_mm,
            landmarks_px=project(camera, shape_mm),
        )


def gap_share(progress: float) -> float:
    """Return how much of the gap is left: 1 falling to 0, smooth at both ends."""
    if not 0 <= progress < 1:
        return 0.0
    return 1.0 - progress * progress * (3.0 - 2.0 * progress)


def part_of_rotation(rotation_wxyz: FloatArray, share: float) -> FloatArray:
    """Return the rotation (4,) about the same axis by a share of the shorter angle.

    Args:
        rotation_wxyz: (4,) unit quaternion.
        share: In [0, 1].
    """
    turn = rotation_wxyz if rotation_wxyz[0] >= 0 else -rotation_wxyz
    sine = float(np.linalg.norm(turn[1:]))
    if sine < 1e-12:
        return np.array([1.0, 0.0, 0.0, 0.0])
    half = share * np.arctan2(sine, turn[0])
    return np.concatenate([[np.cos(half)], np.sin(half) / sine * turn[1:]])
