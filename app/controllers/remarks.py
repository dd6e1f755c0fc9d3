"""What the live window says about how it goes: texts, and when each holds."""

import time
from collections.abc import Callable

from core.records import FaceState

#: Time without the profile after which the user is told.
LASTING_S = 3.0
#: Below this average confidence the user is told that something is wrong.
DOUBTFUL = 0.25

SETTING_UP = "The guided setup uses the camera."
NO_CAMERA = "No camera was found.\nPlug one in, or try facepuppet without:"
NO_PICTURE = "There is no picture."
MAKING = "Tracking without a profile until the new one is made."
STRANGER = "This profile does not fit the face in the picture: tracking without it."
GETTING_READY = "Getting ready…\nThe very first time this takes half a minute."
PREPARING = "Preparing the avatar…"
NEXT_AVATAR = "Preparing {}…"
WAITING = "The avatar comes with the source's picture."
UNUSABLE = "This profile cannot be used: tracking without it. Choose another, or make a new one."
BROKEN = (
    "an error of the program stopped this; the terminal shows the details. Choose the source "
    "again to go on"
)
NOT_DRAWN = "The avatar cannot be drawn."
SEARCHING = "Searching for the face…"


class FreeSpell:
    """Notices that a profile has not been used for some time although a face is seen."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._since_s = clock()

    def lasts(self, state: FaceState | None) -> bool:
        """Return whether it lasts; to be asked now and then with the newest state."""
        now_s = self._clock()
        if state is None or state.lost or state.mode != "free":
            self._since_s = now_s
        return now_s - self._since_s > LASTING_S


def state_name(
    busy: bool, gone: bool, has_picture: bool, state: FaceState | None, confidence: float
) -> str:
    """Return how tracking goes, one of app.views.status_row.STATES.

    Args:
        busy: Whether a source is played or being opened.
        gone: Whether its camera is waited for.
        has_picture: Whether it has given a picture.
        state: The newest one.
        confidence: Averaged.
    """
    if not busy:
        return "off"
    if gone:
        return "gone"
    if not has_picture:
        return "opening"
    if state is None or state.lost:
        return "searching"
    return state.mode + ("_unsure" if confidence < DOUBTFUL else "")
