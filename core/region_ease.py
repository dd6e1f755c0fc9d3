"""Coefficients of a part of the face that is covered: held first, then let go to rest.

What a tracker says of a covered mouth is guessed. The last values that were seen are shown for a
moment; then they ease to rest, an eye's to those of the other eye. When the part is seen again
the difference to what is solved is let go within a fraction of a second.
"""

from dataclasses import dataclass, replace

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.landmarks import REGION_NAMES
from core.mode_blend import gap_share
from core.records import I32, FaceState, FloatArray


def _region_of(name: str) -> str:
    """Return the region in which an expression is seen."""
    if name.startswith("brow"):
        return "brows"
    if name.startswith(("eye", "cheekSquint")):
        return "eye_right" if name.endswith("Right") else "eye_left"
    return "nose" if name.startswith("nose") else "mouth"


def _other_eye(name: str) -> int:
    """Return the coefficient of the other eye, -1 if it is none of an eye."""
    if not _region_of(name).startswith("eye"):
        return -1
    one, other = ("Right", "Left") if name.endswith("Right") else ("Left", "Right")
    return EXPRESSION_NAMES.index(name.removesuffix(one) + other)


#: (46,) region of each coefficient, and the one of the other eye or -1.
REGIONS: I32 = np.array([REGION_NAMES.index(_region_of(n)) for n in EXPRESSION_NAMES], np.int32)
OTHER_EYE: I32 = np.array([_other_eye(n) for n in EXPRESSION_NAMES], np.int32)
_EYES = np.array([REGION_NAMES.index("eye_right"), REGION_NAMES.index("eye_left")])


@dataclass(frozen=True, slots=True)
class EaseSettings:
    """When a region counts as covered, and what is shown of it.

    Attributes:
        covered: Confidence below which a region is covered.
        seen: Confidence above which it is seen again.
        hold_s: Time for which its last values are held.
        rest_s: Time in which they then fall to a third.
        back_s: Time within which they go over to what is seen again.
        gaze_s: Time in which a covered eye turns two thirds of the way to where the other looks.
    """

    covered: float = 0.4
    seen: float = 0.6
    hold_s: float = 0.4
    rest_s: float = 0.6
    back_s: float = 0.2
    gaze_s: float = 0.1


class RegionEase:
    """Hands states on; what cannot be seen of a face is held, then let go."""

    def __init__(self, settings: EaseSettings | None = None) -> None:
        self._settings = settings or EaseSettings()
        self.reset()

    def reset(self) -> None:
        """Forget the past: the next state is shown as it is."""
        n_regions, n_coefficients = len(REGION_NAMES), len(EXPRESSION_NAMES)
        self._hidden = np.zeros(n_regions, bool)
        self._since_s, self._seen_s = np.full(n_regions, -np.inf), np.full(n_regions, -np.inf)
        self._shown, self._gap = np.zeros(n_coefficients), np.zeros(n_coefficients)
        self._gaze, self._gaze_gap = np.zeros((2, 2)), np.zeros((2, 2))
        self._last_s: float | None = None

    def step(self, state: FaceState) -> FaceState:
        """Return the state to show."""
        if self._last_s is not None and not 0 < state.time_s - self._last_s < 1.0:
            self.reset()
        if state.lost:
            known = self._last_s is not None
            return replace(state, expression=self._shown, gaze_rad=self._gaze) if known else state
        self._change(state)
        expression, gaze = self._eased(state), self._eased_gaze(state)
        self._shown, self._gaze, self._last_s = expression, gaze, state.time_s
        if not self._hidden.any() and not self._gap.any():
            return state
        return replace(state, expression=np.clip(expression, 0.0, 1.0), gaze_rad=gaze)

    def _change(self, state: FaceState) -> None:
        """Note which regions are covered from now on and which are seen again."""
        settings, known = self._settings, self._last_s is not None
        hides = ~self._hidden & (state.regions < settings.covered) & known
        shows = self._hidden & (state.regions > settings.seen)
        self._since_s[hides], self._seen_s[shows] = state.time_s, state.time_s
        self._hidden = (self._hidden | hides) & ~shows
        back = shows[REGIONS]
        self._gap[back] = (self._shown - state.expression)[back]
        eyes = shows[_EYES]
        self._gaze_gap[eyes] = (self._gaze - state.gaze_rad)[eyes]

    def _eased(self, state: FaceState) -> FloatArray:
        """Return the coefficients to show (46,)."""
        settings, time_s = self._settings, state.time_s
        left = np.array([gap_share((time_s - s) / settings.back_s) for s in self._seen_s])
        self._gap[left[REGIONS] == 0.0] = 0.0
        solved = state.expression + left[REGIONS] * self._gap
        if not self._hidden.any():
            return solved
        step_s = time_s - (time_s if self._last_s is None else self._last_s)
        waits = (time_s - self._since_s < settings.hold_s)[REGIONS]
        kept = np.where(waits, 1.0, np.exp(-step_s / settings.rest_s))
        goal = np.where(OTHER_EYE >= 0, solved[OTHER_EYE], 0.0)
        goal[self._hidden[REGIONS[OTHER_EYE]]] = 0.0
        return np.where(self._hidden[REGIONS], goal + kept * (self._shown - goal), solved)

    def _eased_gaze(self, state: FaceState) -> FloatArray:
        """Return the gaze to show (2, 2): a covered eye looks where the other one does."""
        left = [gap_share((state.time_s - self._seen_s[k]) / self._settings.back_s) for k in _EYES]
        gaze = state.gaze_rad + np.array(left)[:, None] * self._gaze_gap
        hidden = self._hidden[_EYES]
        if hidden.all():
            return self._gaze.copy()
        step_s = 0.0 if self._last_s is None else state.time_s - self._last_s
        share = -np.expm1(-step_s / self._settings.gaze_s)
        for eye in np.flatnonzero(hidden):
            # The way over is as smooth as the way back.
            gaze[eye] = self._gaze[eye] + share * (gaze[1 - eye] - self._gaze[eye])
        return np.asarray(gaze)
