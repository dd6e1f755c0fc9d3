"""The trained regressor where it fits the face, the training-free tracker where it does not.

Tracking begins without training and goes over to the regressor as soon as the face is known to be
the profile's and the regressor agrees with the landmarks. It comes back when another face takes
the place, or when the regressor fails. Only one of both works on a frame; the generic aligner's
looks, which both need now and then, are where they are compared.
"""

from dataclasses import dataclass, field

import numpy as np

from core.agreement import Look
from core.face_keeper import FaceKeeper
from core.free_live import FreeTracker
from core.geometry import matrix_from_quaternion, rotation_facing_camera
from core.live import LiveSettings, LiveTracker
from core.mode_blend import StateBlend
from core.profile_match import MatchSettings, ProfileMatch
from core.records import Camera, FaceState, Frame, Landmarks2D
from core.region_ease import RegionEase

#: For the trained tracker: with another one at hand it need not get far before it counts as
#: failing. On own faces regressor and aligner are up to 0.04 apart, on turned heads.
STRICT = LiveSettings(disagreement=0.06, eased=False)


@dataclass(frozen=True, slots=True)
class AutoSettings:
    """When to change over, and how.

    Attributes:
        match: Whether the face is the profile's.
        patience: Frames without the regressor, the face being seen, after which it has failed.
        first_tries: Frames after a face was found in which the regressor is tried.
        try_every: Frames between two tries after that; each costs about 10 ms.
        unsure_every: Frames between the aligner's looks while the regressor leads and the match
            is in question.
        blend_s: Time in which the difference between both is let go.
        covered: Mean cover of the landmarks from which on the training-free tracker leads, and
            below which the regressor is tried again: it has seen no hands.
        search_every: Frames between two searches for the profile's person among other faces
            while somebody else is followed; each costs about 40 ms.
    """

    match: MatchSettings = field(default_factory=MatchSettings)
    patience: int = 3
    first_tries: tuple[int, ...] = (1, 3, 6, 10, 15)
    try_every: int = 10
    unsure_every: int = 5
    blend_s: float = 0.2
    covered: tuple[float, float] = (0.1, 0.03)
    search_every: int = 45


class AutoTracker:
    """Turns frames into face states, by whichever tracker does it better."""

    def __init__(
        self, trained: LiveTracker, free: FreeTracker, settings: AutoSettings | None = None,
        keeper: FaceKeeper | None = None,
    ) -> None:  # fmt: skip
        """Join two trackers of one source.

        Args:
            trained: Of the profile, best with the settings STRICT.
            free: With the profile's camera, for both must mean the same by a millimetre. It is
                told whether the face is the profile's.
            settings: When to change over.
            keeper: Through which both see, if they do.
        """
        self._trained, self._free = trained, free
        self._settings = settings or AutoSettings()
        self._keeper, self._ease = keeper, RegionEase()
        self._match = ProfileMatch(self._settings.match)
        self._blend = StateBlend(self._settings.blend_s)
        self._trained_leads = False
        self._failed, self._seen = 0, 0

    @property
    def camera(self) -> Camera:
        """The camera in pixels of the last frame."""
        return self._trained.camera if self._trained_leads else self._free.camera

    def reset(self) -> None:
        """Forget the past, as after a cut."""
        self._trained.reset()
        self._free.reset()
        self._match.reset()
        self._blend.reset()
        self._trained_leads, self._failed, self._seen = False, 0, 0

    def step(self, frame: Frame) -> FaceState:
        """Return the face in a frame; `lost` and the last good state where there is none."""
        state = self._step_trained(frame) if self._trained_leads else self._step_free(frame)
        return self._blend.step(self._ease.step(state), self.camera)

    def _step_trained(self, frame: Frame) -> FaceState:
        state = self._trained.step(frame)
        if state.lost:
            self._match.reset()
            return state
        look = self._trained.look
        self._failed = 0 if self._trained.follows else self._failed + 1
        if look is not None:
            self._weigh(look, state)
        if self._match.is_unsure:
            self._trained.look_within(self._settings.unsure_every)
        if (
            self._failed < self._settings.patience
            and not self._match.is_other
            and self._covered() < self._settings.covered[0]
        ):
            return state
        self._trained_leads, self._seen = False, 0
        self._free.reset()
        self._free.assume(None if self._match.is_other else self._trained.user)
        return self._step_free(frame)

    def _step_free(self, frame: Frame) -> FaceState:
        state = self._free.step(frame)
        if state.lost:
            self._match.reset()
            self._seen = 0
            return state
        self._seen += 1
        landmarks = self._free.looked
        if landmarks is not None and self._is_time_to_try():
            self._try(frame, landmarks, state)
        if self._match.is_other and self._seen % self._settings.search_every == 0:
            self._search(frame)
        return state

    def _search(self, frame: Frame) -> None:
        """Look for the profile's person beside another who is followed."""
        if self._keeper is None:
            return
        for found in self._keeper.others(frame):
            look = self._trained.begin_at(frame, found.landmarks)
            misfits = self._trained.misfits(found.landmarks)
            if look is None or misfits is None or not look.agrees:
                continue
            match = ProfileMatch(self._settings.match)
            match.weigh(look, misfits, 0.0)
            if match.is_own:
                self._keeper.forget()
                self._match, self._trained_leads, self._failed = match, True, 0
                return

    def _covered(self) -> float:
        return 0.0 if self._keeper is None else self._keeper.covered

    def _is_time_to_try(self) -> bool:
        settings = self._settings
        if self._covered() > settings.covered[1]:
            return False
        return self._seen in settings.first_tries or self._seen % settings.try_every == 0

    def _try(self, frame: Frame, landmarks: Landmarks2D, state: FaceState) -> None:
        """Let the regressor try this frame; from the next one on it leads if it does well."""
        look = self._trained.begin_at(frame, landmarks)
        if look is None:
            return
        self._weigh(look, state)
        if self._match.is_other:
            self._free.assume(None)
        elif self._match.is_own and look.agrees:
            self._trained_leads, self._failed = True, 0

    def _weigh(self, look: Look, state: FaceState) -> None:
        """Take a look for evidence; of a regressor that fails only the landmarks count."""
        misfits = self._trained.misfits(look.landmarks)
        if misfits is not None:
            works = look if look.agrees else None
            self._match.weigh(works, misfits, turned_rad(state))


def turned_rad(state: FaceState) -> float:
    """Return the angle between the head's direction and the line to the camera."""
    rotation = matrix_from_quaternion(state.rotation_wxyz)
    facing = rotation_facing_camera(state.translation_mm)
    return float(np.arccos(np.clip(rotation[:, 2] @ facing[:, 2], -1.0, 1.0)))
