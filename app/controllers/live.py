"""The live window at work: source and profile chosen, frames solved, avatar painted.

What other features build on:

- `add_listener(call)`: `call(frame, solved, driven, delivered_s)` for every frame, in the live
  thread. It must return within a millisecond and touch no widget.
- `solved`: the newest `LiveResult` (`frame`, `state`, `driven`) in the window's thread; frames may
  be left out.
- `drive`: from the solved face to what the avatar does; `scene`: the avatar; `player`: the source.
- `use_profile(name)` changes over while the picture goes on; `swap_performer(performer)` puts
  another tracker of the same person in place between two frames.
- `profile_changed`, `avatar_changed`, `source_changed` after each choice; `ending` before all
  threads end, when panels have to end theirs.
"""

from collections.abc import Sequence

from PySide6.QtCore import QCoreApplication, QObject, QThread, QTimer, Signal

from app.controllers.choosing import ChoiceLists
from app.controllers.face_desk import FaceDesk
from app.controllers.inviting import Inviting
from app.controllers.live_chain import Listener, LiveChain, SwappingOpener
from app.controllers.performing import Performing
from app.controllers.player import Opened, Performer, Player, Wanted
from app.controllers.profile_maker import MadeProfile
from app.controllers.remarks import (
    BROKEN,
    GETTING_READY,
    NO_CAMERA,
    NO_PICTURE,
    NOT_DRAWN,
    PREPARING,
    SETTING_UP,
    WAITING,
)
from app.controllers.scene import AvatarScene
from app.controllers.showing import Showing
from app.controllers.tools import Tools
from app.errors import AppError
from app.painting import OWN
from app.sources import PERFORMER
from app.views.choice import Choice
from app.views.live_window import NO_PROFILE, LiveWindow
from app.window_file import load_window
from core.drive import Drive
from core.errors import CoreError
from core.records import FaceState, Frame, Progress

NUMBERS_EVERY_MS = 250


class LiveController(QObject):
    """Joins the live window with sources, profiles and threads."""

    source_changed = Signal(str)
    profile_changed = Signal(str)
    swapped = Signal()  # another tracker of the same person took over
    avatar_changed = Signal(str)
    solved = Signal(object)  # LiveResult
    taken = Signal(object)  # LiveResult of a take that others play in place of the source
    ending = Signal()

    def __init__(self, window: LiveWindow, tools: Tools) -> None:
        super().__init__(window)
        self.window, self._tools = window, tools
        self._lists = ChoiceLists(window, tools)
        self._wanted = Wanted("", NO_PROFILE.key)
        self.inviting = Inviting(window, self._is_newcomer)
        self._showing = Showing(window, tools, self)
        self.scene = AvatarScene(tools, tools.avatars()[0].key, self)
        self._chain = LiveChain(Drive(), self._on_solved)
        self.player = Player(SwappingOpener(tools), self._chain.solved, self)
        self._performing = Performing(
            tools, self._chain.drive, self.scene, self._showing.overlays, self
        )
        self._desk = FaceDesk(window, tools, self)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look_around)
        self._connect_window(window)
        self._connect_work()

    @property
    def wanted(self) -> Wanted:
        """The chosen source and profile."""
        return self._wanted

    @property
    def drive(self) -> Drive:
        """From the solved face to what the avatar does."""
        return self._chain.drive

    @property
    def lent(self) -> bool:
        """Whether others show what they play in place of the source."""
        return self._showing.lent

    def start(self) -> None:
        """Fill the choosers and play the first camera, if there is one."""
        application = QCoreApplication.instance()
        if application is not None:
            application.aboutToQuit.connect(self.stop)
        performer = Choice(PERFORMER, "Virtual performer")
        self.window.set_profile_rules(self._tools.name_trouble, performer)
        kept, names = load_window(), self._tools.profiles()
        cameras = [camera.key for camera in self._tools.cameras()]
        self.inviting.declined = kept.invited
        self._timer.start(NUMBERS_EVERY_MS)
        if kept.avatar in {avatar.key for avatar in self._tools.avatars()}:
            self.scene.choose(kept.avatar)
        profile = _kept_or_first(kept.profile, names)
        if not (profile and self.scene.avatar == OWN):
            self.scene.prepare()
        self._play(_kept_or_first(kept.source, cameras), profile)

    def stop(self) -> None:
        """End all threads; the source is closed."""
        self._timer.stop()
        # All are asked before one is waited for.
        for thread in self.findChildren(QThread):
            thread.requestInterruption()
        self.ending.emit()
        self._desk.stop()
        self._performing.stop()
        self._showing.overlays.stop()
        self.player.stop()
        self.scene.stop()

    # -- for other features ---------------------------------------------------------------

    def add_listener(self, listener: Listener) -> None:
        """Call somebody with every frame from the next one on, in the live thread."""
        self._chain.add(listener)

    def remove_listener(self, listener: Listener) -> None:
        """Call somebody no more; a frame under way may still come."""
        self._chain.remove(listener)

    def use_profile(self, profile: str) -> None:
        """Change over to a profile; the picture goes on with the one before meanwhile.

        What others play in place of the source keeps its own head until the source is back.
        """
        if not self._performing.plays and not self.lent:
            self._play(self._wanted.source, profile)
            return
        self._wanted = Wanted(self._wanted.source, profile)
        self._show_choices()
        self.window.message_bar.tell("")
        if not self.lent:
            self._performing.load(profile)

    def swap_performer(self, performer: Performer) -> None:
        """Let another tracker solve from the next frame on, for another head or a better one."""
        self._performing.swap(performer)
        self.swapped.emit()

    def add_pictures(self, key: str) -> None:
        """Leave the camera to the guided setup, which asks for a set of core.extra_shots."""
        self._desk.add_pictures(self._wanted.source, self._wanted.profile, key)

    def lend(self) -> None:
        """Give the source back: until the next one is chosen, others show what they play."""
        self.player.play(None)
        self._performing.lend()
        self._showing.lent = True
        self.window.transport.hide()

    # -- choices -------------------------------------------------------------------------

    def _connect_window(self, window: LiveWindow) -> None:
        window.source_chosen.connect(lambda key: self._play(key, self._wanted.profile))
        window.sources_wanted.connect(self._show_choices)
        window.profile_chosen.connect(self.use_profile)
        window.avatar_chosen.connect(self._on_avatar_chosen)
        window.guided_wanted.connect(lambda: self._desk.show_guided(self._wanted.source))
        deeds = window.deeds
        deeds["edit"].triggered.connect(lambda: self._desk.show_editor(self._wanted.profile))
        deeds["folder"].triggered.connect(lambda: self._desk.show_folder(self._wanted.profile))
        window.closing.connect(self.stop)

    def _show_choices(self) -> None:
        self._lists.show(self._wanted, self.scene.avatar)

    def _play(self, source: str, profile: str) -> None:
        """Play a source with a profile from now on; the one before ends in the background."""
        if source != self._wanted.source:
            self.window.show_mirrored(source.startswith("camera"))
        self._wanted = Wanted(source, profile)
        self._show_choices()
        self._forget()
        self.window.message_bar.tell("")
        if source:
            self.window.source_pane.say(self._opening())
            self.player.play(self._wanted)
        else:
            self.window.source_pane.say(NO_CAMERA, self._lists.offers())
            self.player.play(None)
        self._showing.show_numbers(self.player.busy)
        self.source_changed.emit(source)
        self.profile_changed.emit(profile)

    def _forget(self) -> None:
        """Leave nothing of the source before on the screen or in the numbers."""
        self._performing.forget()
        self._showing.reset()
        self.window.avatar_pane.say(PREPARING if self._wanted.source else WAITING)
        self._invite()

    def _invite(self) -> None:
        profile, unusable = self._wanted.profile, self._performing.unusable
        self.inviting.look(profile, unusable, self._desk.busy, self._showing.state)

    def _is_newcomer(self) -> bool:
        return not self._lists.profiles and self._performing.plays

    def _on_avatar_chosen(self, key: str) -> None:
        self.scene.choose(key)
        self._show_choices()
        self.avatar_changed.emit(key)

    # -- playing -------------------------------------------------------------------------

    def _connect_work(self) -> None:
        self.player.preparing.connect(self._on_preparing)
        self.player.opened.connect(self._on_opened)
        self.player.framed.connect(self._showing.show_solved)
        self.player.framed.connect(self.solved)
        self.taken.connect(self._showing.show_solved)
        self.player.failed.connect(self._on_source_failed)
        self.player.broken.connect(lambda: self._on_source_failed(AppError(BROKEN)))
        self.scene.painted.connect(self._showing.show_painted)
        self.scene.failed.connect(self._on_avatar_failed)
        self._performing.changed.connect(self._on_performer_changed)
        self._performing.failed.connect(lambda error: self.window.message_bar.tell(str(error)))
        self._desk.changed.connect(self._invite)
        self._desk.camera_needed.connect(self._on_camera_needed)
        self._desk.camera_free.connect(self._on_camera_free)
        self._desk.made.connect(self._on_profile_made)
        self._desk.retrained.connect(self._on_retrained)

    def _opening(self) -> str:
        return f"Opening {self.window.sources.currentText()}…"

    def _on_preparing(self, progress: Progress) -> None:
        first = progress.done == 0
        self.window.source_pane.say(GETTING_READY if first else self._opening())

    def _on_opened(self, opened: Opened) -> None:
        if opened.trouble is not None:
            self.window.message_bar.tell(str(opened.trouble))
        self._performing.begin(opened)
        self._invite()

    def _on_performer_changed(self) -> None:
        self._invite()
        self.profile_changed.emit(self._wanted.profile)

    def _on_solved(
        self, frame: Frame, state: FaceState, driven: FaceState, delivered_s: float
    ) -> None:
        """Count and have painted what was solved; called in the live thread."""
        self._showing.count(frame, state, delivered_s)
        if self._showing.avatar_seen:
            self.scene.show(driven, delivered_s, frame, state)

    def _on_source_failed(self, error: CoreError | AppError) -> None:
        self._forget()
        self.window.message_bar.tell(str(error))
        again = Choice(self._wanted.source, "Try again")
        self.window.source_pane.say(NO_PICTURE, [again, *self._lists.offers()])
        self.window.avatar_pane.say(WAITING)

    def _on_avatar_failed(self, error: AppError) -> None:
        self.window.message_bar.tell(str(error))
        self.window.avatar_pane.say(NOT_DRAWN)

    def _look_around(self) -> None:
        """Do what need not be done with every frame."""
        self._performing.look_around()
        self._invite()
        self._showing.show_trouble(self.player.trouble, self._lists.offers())
        self._showing.show_numbers(self.player.busy)

    # -- making a profile ----------------------------------------------------------------

    def _on_camera_needed(self) -> None:
        self.player.play(None)
        self._forget()
        self.window.source_pane.say(SETTING_UP)

    def _on_camera_free(self, profile: str) -> None:
        """Go on, with the profile with which the user wanted to go live."""
        self._play(self._wanted.source, profile or self._wanted.profile)

    def _on_retrained(self, profile: str) -> None:
        if profile == self._wanted.profile:
            self.use_profile(profile)

    def _on_profile_made(self, made: MadeProfile) -> None:
        self.use_profile(made.name)
        self.window.message_bar.announce(made.text)


def _kept_or_first(kept: str, there: Sequence[str]) -> str:
    """Return what was used last if it is still there, else the first, else nothing."""
    return kept if kept in there else next(iter(there), "")
