"""The drive: from the face that was solved to what the avatar does.

    solved -> filter -> blink levels -> rest -> response -> linked eyes -> gains of the head
           -> idle when lost, and back without a jump -> breathing, blinking, expression keys

Time comes with the states. Everything may be called from any thread and takes effect with the next
step.
"""

from collections import deque
from dataclasses import astuple, dataclass, replace
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

from core.arkit import EXPRESSION_NAMES
from core.blink_levels import BlinkLevels, LearnedLevels
from core.centring import CALM_S, Calm, Centre, learned_rest, rest_of, without_rest
from core.drive_filter import FilterSettings, GroupFilter
from core.drive_settings import DriveSettings
from core.expression_keys import KeyFaces, KeyFades
from core.eye_link import link_lids, turned_gaze
from core.head_place import HeadPlace, with_gains
from core.idle import Breathing, SelfBlink, close_lids
from core.presence import Face, Presence, resting_face
from core.records import FaceState, FloatArray
from core.response import ResponseTable, Seen
from core.tracker import BLINKS

if TYPE_CHECKING:
    from collections.abc import Callable

#: Longest step of time that fades count: a pause is no time in which anything was to be seen.
_LONGEST_STEP_S = 0.25
#: Faces less certain than this teach nothing.
_CERTAIN = 0.3
#: Blink levels are learned from heads turned less than this.
_FRONTAL_RAD = 0.45
_JAW_OPEN = EXPRESSION_NAMES.index("jawOpen")
_MOUTH_CLOSE = EXPRESSION_NAMES.index("mouthClose")


@dataclass(frozen=True, slots=True, eq=False)
class _Tables:
    """Settings made ready for the live thread."""

    settings: DriveSettings
    filters: FloatArray
    responses: ResponseTable
    gains: FloatArray
    keys: KeyFaces


class Drive:
    """Turns solved faces into driven ones; remembers the last one."""

    def __init__(
        self, settings: DriveSettings | None = None, filters: FilterSettings | None = None
    ) -> None:
        """Prepare to drive.

        Args:
            settings: The user's.
            filters: How groups are filtered at taste 0.5.
        """
        self._filter = GroupFilter(filters)
        self._head, self._calm = HeadPlace(), Calm()
        self._rest = np.zeros(len(EXPRESSION_NAMES))
        self._levels: BlinkLevels | None = None
        self._learned = LearnedLevels()
        self._seen, self._fades = Seen(), KeyFades()
        self._presence, self._breathing, self._blink = Presence(), Breathing(), SelfBlink()
        self._stepping = Lock()
        self._requests: deque[Callable[[], None]] = deque()
        self._recentre = False
        self._wanted_centres: deque[Centre | None] = deque()
        self._now = np.zeros(len(EXPRESSION_NAMES))
        self._time_s, self._shown = -np.inf, resting_face()
        self.use(settings or DriveSettings())
        self._forget()

    # -- from any thread -----------------------------------------------------------------

    @property
    def settings(self) -> DriveSettings:
        """The settings in use."""
        return self._tables.settings

    def use(self, settings: DriveSettings) -> None:
        """Drive by other settings from the next step on."""
        self._tables = _Tables(
            settings,
            self._filter.table(settings.steadiness),
            ResponseTable(settings.responses, settings.steadiness.mouth),
            np.array(astuple(settings.head)),
            KeyFaces(settings.keys),
        )

    @property
    def centre(self) -> Centre | None:
        """The centre as it was set or learned, None as long as it was not."""
        wanted = tuple(self._wanted_centres)
        if wanted:
            return wanted[-1]
        if not self._head.is_set:
            return None
        rotation, place = self._head.centre
        return Centre(rotation, place, self._rest)

    def put_centre(self, centre: Centre | None) -> None:
        """Use a centre from an earlier time, None: as tracked."""
        self._wanted_centres.append(centre)

    def recentre(self) -> None:
        """Take the next face that is seen for a head at its centre and a face at rest."""
        self._recentre = True

    @property
    def recentring(self) -> bool:
        """Whether `recentre` still waits for a face."""
        return self._recentre

    @property
    def sees_face(self) -> bool:
        """Whether the last state was of a face."""
        return not self._presence.was_lost

    def know_levels(self, levels: BlinkLevels | None) -> None:
        """Use the blink levels of a profile; None: learn them."""
        self._levels = levels

    @property
    def levels(self) -> BlinkLevels:
        """The blink levels in use."""
        return self._levels or self._learned.levels

    def know_usual_rotation(self, rotation_wxyz: FloatArray) -> None:
        """Say how the user usually holds the head (4,), which the avatar's view takes off."""
        self._requests.append(lambda: self._head.usually(rotation_wxyz))

    def press(self, key: int) -> None:
        """Show the face of a key, from 1; of one that is not to be held, or take it off."""
        keys = self.settings.keys
        if 1 <= key <= len(keys):
            self._fades.press(key, keys[key - 1].hold)

    def release(self, key: int) -> None:
        """End the face of a key that is shown while it is held."""
        keys = self.settings.keys
        if 1 <= key <= len(keys):
            self._fades.release(key, keys[key - 1].hold)

    @property
    def keys_shown(self) -> tuple[bool, ...]:
        """Which keys' faces are wanted."""
        return self._fades.shown

    @property
    def now(self) -> FloatArray:
        """The last tracked expression (B,), filtered and counted from rest: what responses get."""
        return self._now

    @property
    def shown(self) -> FloatArray:
        """The last driven expression (B,)."""
        return self._shown.expression

    @property
    def seen(self) -> FloatArray:
        """Least and greatest of `now` since it was forgotten, (B, 2)."""
        return self._seen.range()

    def forget_seen(self) -> None:
        """Begin anew with the least and greatest."""
        self._requests.append(self._seen.forget)

    def reset(self) -> None:
        """Forget the past: another source or another person. Settings and a set centre stay."""
        self._requests.append(self._forget)

    # -- frame by frame -----------------------------------------------------------------

    def step(self, state: FaceState) -> FaceState:
        """Return the face that the avatar is to show.

        Landmarks and shape stay those that were solved. A lost face is held, then eased to rest;
        `lost` stays set.
        """
        with self._stepping:
            return self._step(state)

    def _step(self, state: FaceState) -> FaceState:
        while self._requests:
            self._requests.popleft()()
        while self._wanted_centres:
            # It stays the wanted one until it is used; one that comes meanwhile waits behind it.
            self._put_centre(self._wanted_centres[0])
            self._wanted_centres.popleft()
        tables = self._tables
        step_s = state.time_s - self._time_s
        self._time_s = state.time_s
        elapsed_s = min(max(step_s, 0.0), _LONGEST_STEP_S) if np.isfinite(step_s) else 0.0
        if state.lost:
            face = self._presence.unseen(tables.settings.idle, elapsed_s)
        else:
            face = self._seen_face(state, tables, step_s, elapsed_s)
            # A centre of another day is where the avatar is seen first, for its view to be centred.
            face = self._presence.seen(face, tables.settings.idle, elapsed_s, self._head.is_set)
        self._shown = self._alive(face, tables, state.lost, elapsed_s)
        rotation, place = self._head.placed(self._shown.away)
        return replace(
            state,
            rotation_wxyz=rotation,
            translation_mm=place,
            expression=self._shown.expression,
            gaze_rad=self._shown.gaze_rad,
        )

    def _forget(self) -> None:
        self._time_s, self._shown = -np.inf, resting_face()
        self._presence.reset()
        self._filter.reset()
        self._head.forget()
        self._calm.reset()
        self._learned.forget()
        self._seen.forget()

    def _put_centre(self, centre: Centre | None) -> None:
        self._head.put(centre)
        self._rest = np.zeros(len(EXPRESSION_NAMES)) if centre is None else centre.expression.copy()
        self._presence.bridge(self.settings.idle.back_s)

    def _seen_face(
        self, state: FaceState, tables: _Tables, step_s: float, elapsed_s: float
    ) -> Face:
        """Return a tracked face as the settings make it."""
        settings = tables.settings
        if self._presence.was_lost:
            self._filter.reset()
            self._calm.reset()
        self._filter.use(tables.filters)
        rotation, place, expression, gaze = self._filter.step(
            state.rotation_wxyz, state.translation_mm, state.expression, state.gaze_rad, step_s
        )
        away = self._head.away(rotation, place)
        certain = state.confidence > _CERTAIN and elapsed_s > 0
        self._level(expression, away, settings, elapsed_s if certain else 0.0)
        if self._recentre:
            self._recentre = False
            away = self._set_centre(rotation, place, expression)
        elif certain and (settings.centring.head or settings.centring.face):
            self._follow_rest(away, place, expression, elapsed_s)
        self._now = without_rest(expression, self._rest)
        if certain:
            self._seen.add(self._now)
        shown = tables.responses.applied(self._now)
        # Lips that are closed over a jaw that is not open would go through each other.
        shown[_MOUTH_CLOSE] = min(shown[_MOUTH_CLOSE], shown[_JAW_OPEN])
        link_lids(shown, float(away[0]), settings.eyes.link_lids)
        return Face(with_gains(away, tables.gains), shown, turned_gaze(gaze, settings.eyes))

    def _level(
        self, expression: FloatArray, away: FloatArray, settings: DriveSettings, step_s: float
    ) -> None:
        """Let open lids count as 0 and closed ones as 1, in place."""
        blinks = expression[BLINKS]
        if self._levels is None and step_s and float(np.abs(away[:2]).max()) < _FRONTAL_RAD:
            self._learned.add(blinks, step_s)
        if settings.eyes.own_levels:
            expression[BLINKS] = self.levels.applied(blinks)

    def _set_centre(
        self, rotation: FloatArray, place: FloatArray, expression: FloatArray
    ) -> FloatArray:
        """Take a face for the centre; return the head's deviation from it."""
        self._head.move_centre(place, 1.0)
        self._rest = rest_of(expression)
        self._presence.bridge(self.settings.idle.back_s)
        return self._head.away(rotation, place)

    def _follow_rest(
        self, away: FloatArray, place: FloatArray, expression: FloatArray, step_s: float
    ) -> None:
        """Let the centre follow while nothing is meant."""
        centring = self.settings.centring
        if self._calm.add(away, expression, self._rest, step_s) < CALM_S:
            return
        share = float(-np.expm1(-step_s / centring.time_s))
        if centring.head:
            self._head.move_centre(place, share)
        if centring.face:
            self._rest = learned_rest(self._rest, expression, share)

    def _alive(self, face: Face, tables: _Tables, lost: bool, step_s: float) -> Face:
        """Return a face that also does what nobody asked for: breathes, blinks, obeys keys."""
        idle = tables.settings.idle
        resting = lost and self._presence.lost_s > idle.hold_s
        breathes = idle.breathing == "always" or (idle.breathing == "lost" and resting)
        blinks = idle.blinking == "always" or (idle.blinking == "lost" and resting)
        away = face.away + self._breathing.step(breathes, idle.breath, step_s)
        expression = close_lids(face.expression, self._blink.step(blinks, step_s))
        if not self._fades.idle:
            levels = self._fades.step(tables.settings.keys, step_s)
            expression = tables.keys.applied(expression, levels)
        return Face(away, expression, face.gaze_rad)
