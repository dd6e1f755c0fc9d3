"""Where the eyes look: from the pupils among the shape points to yaw and pitch in the head frame.

The regressed pupil's depth is its weakest coordinate, and it is not needed: the pupil lies where
the line of sight from the camera through it meets the eyeball. The two eyes move together, turned
in towards what they look at: most often the screen, which is about as far away as the camera. What
is measured of this angle is noise of its own size, so it is believed, slowly, only where eyes are
crossed on purpose. An eye that is closed takes the other's direction, and while both are closed the
gaze stays.
"""

from dataclasses import dataclass

import numpy as np

from core.kernels.gaze import join_eyes, move_gaze, pupil_direction
from core.records import FloatArray


@dataclass(frozen=True, slots=True)
class GazeSettings:
    """How gaze is measured and filtered.

    Attributes:
        open_blink: Blink coefficient up to which a pupil counts in full.
        closed_blink: Blink coefficient from which it does not count.
        crossed_rad: Eyes turned in this much more than to the screen begin to count as crossed.
        crossing_s: Time constant with which crossing is believed.
        limit_rad: Largest yaw and pitch.
        cutoff_hz: Low-pass cutoff of a resting eye.
        cutoff_per_speed: Added per rad/s of eye speed: saccades pass at once.
        tremble: Speed in rad/s that the noise of a resting eye makes, which adds nothing.
        longest_step_s: After a longer gap the filter starts anew.
    """

    open_blink: float = 0.3
    closed_blink: float = 0.6
    crossed_rad: float = 0.1
    crossing_s: float = 0.3
    limit_rad: float = 0.7
    cutoff_hz: float = 1.0
    cutoff_per_speed: float = 5.0
    tremble: float = 0.3
    longest_step_s: float = 0.25


def pupil_directions(
    pupils_mm: FloatArray, pose: FloatArray, centers_mm: FloatArray, radii_mm: FloatArray
) -> FloatArray:
    """Return yaw and pitch (2, 2) in rad of each eye from where its pupil is seen.

    Args:
        pupils_mm: (2, 3) camera frame, right eye first; only their direction from the camera
            counts.
        pose: (4, 3) head-to-camera rotation matrix, then the translation in mm.
        centers_mm: (2, 3) eyeball centres in the head frame.
        radii_mm: (2,) distance of each pupil from its eyeball's centre.
    """
    out, work = np.empty((2, 2)), np.empty((2, 3))
    for eye in range(2):
        pupil_direction(pupils_mm[eye], pose, centers_mm[eye], radii_mm[eye], work, out[eye])
    return out


def vergence_rad(centers_mm: FloatArray, distance_mm: float) -> float:
    """Return how far each eye turns in to look at something in the middle before the face.

    Args:
        centers_mm: (2, 3) eyeball centres in the head frame.
        distance_mm: Of what is looked at; that of the camera will do for a screen.
    """
    apart = float(np.linalg.norm(centers_mm[0] - centers_mm[1]))
    return float(np.arctan2(0.5 * apart, max(distance_mm, apart)))


class GazeFilter:
    """Joins and filters the directions of both eyes; remembers where they looked."""

    def __init__(self, settings: GazeSettings | None = None) -> None:
        self._settings = settings or GazeSettings()
        self._gaze_rad, self._speed = np.zeros((2, 2)), np.zeros((2, 2))
        self._wanted_rad = np.zeros((2, 2))
        self._time_s: float | None = None
        self._inward_rad = 0.0

    def reset(self) -> None:
        """Forget the last gaze: the next one passes unfiltered."""
        self._time_s, self._inward_rad = None, 0.0

    def step(
        self, directions_rad: FloatArray, blinks: FloatArray, time_s: float,
        vergence_rad: float = 0.0,
    ) -> FloatArray:  # fmt: skip
        """Return the gaze (2, 2) in rad.

        Args:
            directions_rad: (2, 2) of `pupil_directions`.
            blinks: (2,) blink coefficients of the right, then the left eye.
            time_s: Time of the frame.
            vergence_rad: How far each eye turns in to look at the screen, see `vergence_rad`.
        """
        settings = self._settings
        span = settings.closed_blink - settings.open_blink
        openness = np.minimum(np.maximum((settings.closed_blink - blinks) / span, 0.0), 1.0)
        gap_s = np.inf if self._time_s is None else time_s - self._time_s
        self._time_s = time_s
        if openness.max() > 0:
            wanted = self._wanted_rad
            inward = vergence_rad + self._crossing(directions_rad, openness, gap_s, vergence_rad)
            join_eyes(directions_rad, openness, inward, settings.limit_rad, wanted)
            self._move(gap_s, float(openness.max()))
        return self._gaze_rad.copy()

    def _crossing(
        self, directions_rad: FloatArray, openness: FloatArray, gap_s: float, vergence_rad: float
    ) -> float:
        """Return how much further than to the screen the eyes are turned in on purpose."""
        settings = self._settings
        if openness.min() > 0 and np.isfinite(gap_s):
            inward = 0.5 * float(directions_rad[0, 0] - directions_rad[1, 0]) - vergence_rad
            share = 1.0 - np.exp(-max(gap_s, 0.0) / settings.crossing_s)
            self._inward_rad += share * (inward - self._inward_rad)
        return max(self._inward_rad - settings.crossed_rad, 0.0)

    def _move(self, gap_s: float, openness: float) -> None:
        """Move the filtered gaze towards the wanted one."""
        settings = self._settings
        if not 0 < gap_s <= settings.longest_step_s:
            self._gaze_rad[:], self._speed[:] = self._wanted_rad, 0
            return
        cutoffs = openness * np.array([settings.cutoff_hz, settings.cutoff_per_speed])
        move_gaze(self._wanted_rad, gap_s, cutoffs, settings.tremble, self._gaze_rad, self._speed)
