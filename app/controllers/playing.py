"""Plays takes in the live window, in place of the source, which is given back meanwhile."""

import time
from collections.abc import Callable

from PySide6.QtCore import QObject, Signal

from app.controllers.live import LiveController
from app.controllers.take_tools import folder_of
from app.errors import AppError
from app.takes.library import Take, with_trim
from app.views.takes.player_box import PlayerBox
from app.workers.live_loop import LiveResult
from app.workers.playback import Playback, Played
from core.records import UserBlendshapes

#: Wishes of the player's keys that go some frames back or forth.
STEPS = {"back": -1, "forth": 1}


class PlayingDesk(QObject):
    """Runs at most one playback."""

    changed = Signal()  # begun or ended
    trimmed = Signal(object)  # Take
    failed = Signal(object)  # AppError: a take cannot be played, or its trim not be kept

    def __init__(
        self, controller: LiveController, box: PlayerBox,
        user_of: Callable[[str], UserBlendshapes | None], parent: QObject | None = None,
    ) -> None:  # fmt: skip
        """Prepare to play.

        Args:
            controller: Of the live view.
            box: Shows where the take is.
            user_of: Returns whose head a profile has; called in the playback's thread.
            parent: Of the object.
        """
        super().__init__(parent)
        self._controller, self._box, self._user_of = controller, box, user_of
        self._playback: Playback | None = None
        self._take: Take | None = None
        self._now_s = 0.0
        controller.source_changed.connect(lambda _: self._end())
        controller.ending.connect(self._end)
        box.wished.connect(self._on_wished)
        box.seek_wanted.connect(self._on_seek)
        box.trim_wanted.connect(lambda first_s, last_s: self._trim((first_s, last_s)))
        box.loop_wanted.connect(self._on_loop)
        box.live_wanted.connect(self.leave)

    @property
    def take(self) -> Take | None:
        """The take that is played, None without one."""
        return self._take

    @property
    def playing(self) -> bool:
        """Whether the take goes on; else it stays at a frame."""
        return self._playback is not None and self._playback.playing

    def play(self, take: Take) -> None:
        """Play a take from where its trim begins; the source is given back."""
        self._end()
        self._controller.lend()
        self._take, self._now_s = take, take.range_s[0]
        playback = Playback(take, self._show, self._user_of, self)
        playback.ready.connect(self._on_ready)
        playback.posted.connect(self._on_posted)
        playback.failed.connect(self._on_failed)
        playback.repeat(self._box.loop_box.isChecked())
        self._playback = playback
        self._box.show_take(take.name, take.facts.seconds, take.range_s)
        self._box.slider.setFocus()
        playback.start()
        self.changed.emit()

    def leave(self) -> None:
        """Go back to the live source."""
        if self._playback is not None:
            self._end()
            self._controller.window.source_chosen.emit(self._controller.wanted.source)

    def renamed(self, take: Take) -> None:
        """Show the new name of the take that is played."""
        self._take = take
        self._box.show_take(take.name, take.facts.seconds, take.range_s)

    def _end(self) -> None:
        playback, self._playback, self._take = self._playback, None, None
        if playback is not None:
            playback.stop()
            playback.deleteLater()
            self._box.hide()
            self.changed.emit()

    def _on_ready(self, user: UserBlendshapes | None) -> None:
        if self._playback is not None and self._take is not None:
            self._controller.scene.enter(user, folder_of(self._take.facts.profile))
            self._playback.begin()

    def _show(self, played: Played) -> None:
        """Have a moment painted; called in the playback's thread."""
        moment = played.moment
        self._controller.scene.show(moment.driven, time.perf_counter(), played.frame, moment.solved)

    def _on_posted(self) -> None:
        played = self._playback.results.take() if self._playback is not None else None
        if played is None:
            return
        moment = played.moment
        self._now_s = moment.play_s
        self._box.show_position(moment.play_s, self.playing)
        result = LiveResult(played.frame, moment.solved, moment.driven, 0.0)
        # Not `solved`: a take is nothing to learn from, nor a speed to measure.
        self._controller.taken.emit(result)

    def _on_failed(self, error: object) -> None:
        self.leave()
        self.failed.emit(error)

    # -- wishes --------------------------------------------------------------------------

    def _on_wished(self, wish: str) -> None:
        take, playback = self._take, self._playback
        if take is None or playback is None:
            return
        first_s, last_s = take.range_s
        if wish == "toggle":
            playback.play(not playback.playing)
            self._box.show_position(self._now_s, playback.playing)
        elif wish in STEPS:
            playback.step(STEPS[wish])
            self._box.show_position(self._now_s, playing=False)
        elif wish in ("start", "end"):
            self._on_seek(first_s if wish == "start" else last_s)
        elif wish == "in":
            self._trim((self._now_s, max(last_s, self._now_s)))
        elif wish == "out":
            self._trim((min(first_s, self._now_s), self._now_s))
        elif wish == "whole":
            self._trim(None)

    def _on_seek(self, play_s: float) -> None:
        if self._playback is not None:
            self._playback.seek(play_s)

    def _on_loop(self, loop: bool) -> None:
        if self._playback is not None:
            self._playback.repeat(loop)

    def _trim(self, range_s: tuple[float, float] | None) -> None:
        if self._take is None or self._playback is None:
            return
        try:
            self._take = with_trim(self._take, range_s)
        except AppError as error:
            self.failed.emit(error)
            return
        self._playback.use_range(self._take.range_s)
        self._box.show_take(self._take.name, self._take.facts.seconds, self._take.range_s)
        self._box.show_position(self._now_s, self.playing)
        self.trimmed.emit(self._take)
