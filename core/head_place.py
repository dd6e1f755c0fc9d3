"""The head's movement from its centre, made larger or smaller and put where the avatar rests."""

import numpy as np

from core.centring import Centre
from core.kernels.drive import deviation, placed_head
from core.kernels.pose import rotate_by, rotation_between
from core.records import FloatArray

#: Furthest a head is turned: yaw, pitch, roll.
_MOST_RAD = np.array([1.7, 1.2, 1.2])
_IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
#: Where a head is before any was seen, mm.
_USUAL_MM = np.array([0.0, 0.0, 600.0])


class HeadPlace:
    """Knows the centre of the tracked head, and where the avatar's head is at the centre.

    Rotations count against the line of sight: a head at the side of the picture that looks into
    the camera is not turned. Until the centre is set it is where the avatar rests, so that nothing
    is moved by being passed on.
    """

    def __init__(self) -> None:
        self._usual = _IDENTITY.copy()
        self._centre, self._rest = np.empty(7), np.empty(7)
        self._work, self._away = np.zeros((3, 4)), np.zeros(6)
        self._turn = np.zeros(3)
        self.is_set = False
        self._has_place = False
        self.forget()

    def forget(self) -> None:
        """Take the next head that is seen for the centre's place; a centre that was set stays."""
        self._has_place = self.is_set
        if not self.is_set:
            self._centre[:4], self._centre[4:] = self._usual, _USUAL_MM
        self._rest[:4], self._rest[4:] = self._usual, self._centre[4:]

    def usually(self, rotation_wxyz: FloatArray) -> None:
        """Say how the user usually holds the head (4,); the avatar's view takes that off."""
        self._usual = np.array(rotation_wxyz, float)
        self._rest[:4] = self._usual
        if not self.is_set:
            self._centre[:4] = self._usual

    @property
    def centre(self) -> tuple[FloatArray, FloatArray]:
        """Rotation (4,) against the line of sight and place (3,) of the centre."""
        return self._centre[:4].copy(), self._centre[4:].copy()

    def put(self, centre: Centre | None) -> None:
        """Use a centre from now on, None: the one before any was set."""
        self.is_set = centre is not None
        if centre is not None:
            self._centre[:4], self._centre[4:] = centre.rotation_wxyz, centre.translation_mm
        self.forget()

    def away(self, rotation_wxyz: FloatArray, place_mm: FloatArray) -> FloatArray:
        """Return the deviation (6,) of a head from the centre: yaw, pitch, roll, x, y, z."""
        if not self._has_place:
            self._has_place = True
            self._centre[4:] = self._rest[4:] = place_mm
        deviation(rotation_wxyz, place_mm, self._centre, self._work, self._away)
        return self._away.copy()

    def move_centre(self, place_mm: FloatArray, share: float) -> None:
        """Move the centre a share of the way to the head that was last asked about."""
        seen = self._work[1]
        rotation_between(self._centre[:4], seen, self._turn)
        rotate_by(self._centre[:4], share * self._turn)
        self._centre[4:] += share * (place_mm - self._centre[4:])
        self.is_set = True

    def placed(self, away: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return rotation (4,) and place (3,) of the avatar's head for a deviation (6,)."""
        rotation, place = np.empty(4), np.empty(3)
        placed_head(away, self._rest, self._work, rotation, place)
        return rotation, place


def with_gains(away: FloatArray, gains: FloatArray) -> FloatArray:
    """Return a deviation (6,) times the gains (6,), turned no further than a neck can."""
    out = away * gains
    limit = np.maximum(_MOST_RAD, np.abs(away[:3]))
    out[:3] = np.minimum(np.maximum(out[:3], -limit), limit)
    return np.asarray(out)
