"""Where the eyes look: from the pupils among the shape points to yaw and pitch in the head frame.

The regressed pupil's depth is its weakest coordinate, and it is not needed: the pupil lies where
the line of sight from the camera through it meets the eyeball. The two eyes move together but for
a little convergence, so what they have in common is trusted more than what differs, an eye that
is closed takes the other's direction, and while both are closed the gaze stays.
"""

from dataclasses import dataclass

import numpy as np

from core.records import FloatArray


@dataclass(frozen=True, slots=True)
class GazeSettings:
    """How gaze is measured and filtered.

    Attributes:
        open_blink: Blink coefficient up to which a pupil counts in full.
        closed_blink: Blink coefficient from which it does not count.
        own_share: Share of each eye's own deviation from the common yaw that is kept.
        limit_rad: Largest yaw and pitch.
        cutoff_hz: Low-pass cutoff of a resting eye.
        cutoff_per_speed: Added per rad/s of eye speed: saccades pass at once.
        longest_step_s: After a longer gap the filter starts anew.
    """

    open_blink: float = 0.3
    closed_blink: float = 0.6
    own_share: float = 0.3
    limit_rad: float = 0.7
    cutoff_hz: float = 1.0
    cutoff_per_speed: float = 5.0
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
    rays = pupils_mm @ pose[:3]
    rays = rays / np.sqrt((rays * rays).sum(axis=1, keepdims=True))
    to_center = centers_mm + pose[3] @ pose[:3]
    along = (rays * to_center).sum(axis=1)
    miss_squared = (to_center * to_center).sum(axis=1) - along * along
    # A ray beside the eyeball is noise: its nearest point stands in for the rim.
    depth = np.sqrt(np.maximum(radii_mm * radii_mm - miss_squared, 0.0))
    direction = (along - depth)[:, None] * rays - to_center
    forward = np.hypot(direction[:, 0], direction[:, 2])
    yaw = np.arctan2(direction[:, 0], -direction[:, 2])
    return np.stack([yaw, np.arctan2(-direction[:, 1], forward)], axis=1)


class GazeFilter:
    """Joins and filters the directions of both eyes; remembers where they looked."""

    def __init__(self, settings: GazeSettings | None = None) -> None:
        self._settings = settings or GazeSettings()
        self._gaze_rad, self._speed = np.zeros((2, 2)), np.zeros((2, 2))
        self._time_s: float | None = None

    def reset(self) -> None:
        """Forget the last gaze: the next one passes unfiltered."""
        self._time_s = None

    def step(self, directions_rad: FloatArray, blinks: FloatArray, time_s: float) -> FloatArray:
        """Return the gaze (2, 2) in rad.

        Args:
            directions_rad: (2, 2) of `pupil_directions`.
            blinks: (2,) blink coefficients of the right, then the left eye.
            time_s: Time of the frame.
        """
        settings = self._settings
        span = settings.closed_blink - settings.open_blink
        openness = np.clip((settings.closed_blink - blinks) / span, 0.0, 1.0)
        gap_s = np.inf if self._time_s is None else time_s - self._time_s
        self._time_s = time_s
        if openness.max() <= 0:
            return self._gaze_rad.copy()
        wanted = np.clip(
            self._joined(directions_rad, openness), -settings.limit_rad, settings.limit_rad
        )
        if not 0 < gap_s <= settings.longest_step_s:
            self._gaze_rad, self._speed = wanted, np.zeros((2, 2))
        else:
            self._move(wanted, gap_s, float(openness.max()))
        return self._gaze_rad.copy()

    def _joined(self, directions_rad: FloatArray, openness: FloatArray) -> FloatArray:
        """Return both eyes' directions, mostly what they have in common."""
        common = (openness[:, None] * directions_rad).sum(axis=0) / openness.sum()
        own = openness[:, None] * (directions_rad - common) * (self._settings.own_share, 0.0)
        return np.asarray(common + own)

    def _move(self, wanted_rad: FloatArray, gap_s: float, openness: float) -> None:
        """Move the filtered gaze towards the wanted one, faster in a saccade."""
        settings = self._settings
        innovation = wanted_rad - self._gaze_rad
        self._speed = self._speed + 0.5 * (innovation / gap_s - self._speed)
        speed = float(np.sqrt((self._speed**2).sum(axis=1).max()))
        cutoff_hz = openness * (settings.cutoff_hz + settings.cutoff_per_speed * speed)
        share = 1.0 - np.exp(-2.0 * np.pi * cutoff_hz * gap_s)
        self._gaze_rad = self._gaze_rad + share * innovation
