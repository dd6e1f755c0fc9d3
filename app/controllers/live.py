"""The live window at work: source and profile chosen, frames solved, avatar painted."""

import time

from PySide6.QtCore import QCoreApplication, QObject, QTimer

from app.controllers.meter import Meter
from app.controllers.player import Opened, Performer, Player, Wanted
from app.controllers.profile_maker import MadeProfile, ProfileMaker
from app.controllers.scene import AvatarScene
from app.controllers.tools import Guided, Tools
from app.errors import AppError
from app.sources import PERFORMER
from app.views.choice import Choice
from app.views.live_window import NO_PROFILE, OPEN_FILE, LiveWindow
from app.views.picture_view import Overlay, image_from_array
from app.views.status_row import LiveNumbers
from app.workers.avatar_loop import Painted
from app.workers.live_loop import LiveResult
from core.errors import CoreError
from core.landmarks import CURVES, N_INTERNAL
from core.records import FaceState, Frame, Progress

NUMBERS_EVERY_MS = 250
#: The last landmarks stand for the outline but lie on the skin: they are dots, not a line.
DRAWN_CURVES = tuple(curve for curve in CURVES if max(curve) < N_INTERNAL)
#: Below this confidence landmarks are drawn in the warning colour.
SURE = 0.5
#: Time without the profile after which the user is told.
LASTING_S = 3.0
#: Below this average confidence the user is told that something is wrong.
DOUBTFUL = 0.25

SETTING_UP = "The guided setup uses the camera."
NO_CAMERA = "No camera was found.\nPlug one in, or try facepuppet without:"
NO_PICTURE = "There is no picture."
INVITATION = (
    "Any face is tracked without a profile. With one of your own the avatar follows more closely: "
    "a minute of video is enough (New profile…)."
)
MAKING = "Tracking without a profile until the new one is made."
STRANGER = "This profile does not fit the face in the picture: tracking without it."
GETTING_READY = "Getting ready…\nThe very first time this takes half a minute."
PREPARING = "Preparing the avatar…"
WAITING = "The avatar comes with the source's picture."
UNUSABLE = "This profile cannot be used: tracking without it. Choose another, or make a new one."
BROKEN = (
    "an error of the program stopped this; the terminal shows the details. Choose the source "
    "again to go on"
)


class LiveController(QObject):
    """Joins the live window with sources, profiles and threads."""

    def __init__(self, window: LiveWindow, tools: Tools) -> None:
        super().__init__(window)
        self._window, self._tools = window, tools
        self._files: list[str] = []
        self._wanted = Wanted("", NO_PROFILE.key)
        self._state: FaceState | None = None
        self._performer: Performer | None = None
        self._trouble, self._free_since_s = False, 0.0
        self._meter = Meter()
        self._scene = AvatarScene(tools, tools.avatars()[0].key, self)
        self._player = Player(tools, self._on_solved, self)
        self._maker = ProfileMaker(self)
        self._guided: Guided | None = None
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look_around)
        self._connect_window(window)
        self._connect_work()

    def start(self) -> None:
        """Fill the choosers and play the first camera, if there is one."""
        application = QCoreApplication.instance()
        if application is not None:
            application.aboutToQuit.connect(self.stop)
        performer = Choice(PERFORMER, "Virtual performer")
        self._window.set_profile_rules(self._tools.name_trouble, performer)
        cameras, names = self._tools.cameras(), self._tools.profiles()
        profile = names[0] if names else NO_PROFILE.key
        self._timer.start(NUMBERS_EVERY_MS)
        self._want(cameras[0].key if cameras else "", profile)

    def stop(self) -> None:
        """End all threads; the source is closed."""
        self._timer.stop()
        if self._guided is not None:
            self._guided.close()
        self._maker.stop()
        self._player.stop()
        self._scene.stop()

    # -- choices -------------------------------------------------------------------------

    def _connect_window(self, window: LiveWindow) -> None:
        window.source_chosen.connect(lambda key: self._want(key, self._wanted.profile))
        window.sources_wanted.connect(self._show_choices)
        window.profile_chosen.connect(lambda key: self._want(self._wanted.source, key))
        window.avatar_chosen.connect(self._on_avatar_chosen)
        window.new_profile_wanted.connect(self._on_new_profile_wanted)
        window.guided_wanted.connect(self._on_guided_wanted)
        window.cancel_wanted.connect(self._maker.cancel)
        window.closing.connect(self.stop)

    def _show_choices(self) -> None:
        known = [*self._tools.cameras(), *self._tools.performances()]
        source = self._wanted.source
        if source and source not in self._files and source not in {one.key for one in known}:
            self._files.append(source)
        files = [Choice(path, path.replace("\\", "/").split("/")[-1], path) for path in self._files]
        self._window.show_sources([*known, *files], source)
        self._window.show_profiles(self._tools.profiles(), self._wanted.profile)
        self._window.show_avatars(self._tools.avatars(), self._scene.avatar)

    def _want(self, source: str, profile: str) -> None:
        """Play a source with a profile from now on; the one before ends in the background."""
        if source != self._wanted.source:
            self._window.show_mirrored(source.startswith("camera"))
        self._wanted = Wanted(source, profile)
        self._show_choices()
        self._forget()
        self._window.message_bar.tell("")
        if source:
            self._window.source_pane.say(self._opening())
            self._player.play(self._wanted)
        else:
            self._window.source_pane.say(NO_CAMERA, self._offers())
            self._player.play(None)
        self._show_numbers()

    def _forget(self) -> None:
        """Leave nothing of the source before on the screen or in the numbers."""
        self._state, self._performer, self._trouble = None, None, False
        self._meter.reset()
        self._scene.leave()
        self._window.avatar_pane.say(PREPARING if self._wanted.source else WAITING)
        self._invite()

    def _invite(self) -> None:
        """Say below the pictures what a profile would bring, or why this one is not used."""
        if self._trouble:
            hint = UNUSABLE
        elif self._wanted.profile:
            hint = STRANGER if self._lastingly_free() else ""
        else:
            hint = MAKING if self._maker.busy else INVITATION
        self._window.show_hint(hint)

    def _lastingly_free(self) -> bool:
        """Whether the profile has not been used for some time although a face is seen."""
        now_s = time.monotonic()
        if self._state is None or self._state.lost or self._state.mode != "free":
            self._free_since_s = now_s
        return now_s - self._free_since_s > LASTING_S

    def _offers(self) -> list[Choice]:
        """Return sources that work everywhere."""
        return [*self._tools.performances()[:1], OPEN_FILE]

    def _on_avatar_chosen(self, key: str) -> None:
        if self._scene.plays:
            self._window.avatar_pane.say(PREPARING)
        self._scene.choose(key)
        self._show_choices()

    # -- playing -------------------------------------------------------------------------

    def _connect_work(self) -> None:
        self._player.preparing.connect(self._on_preparing)
        self._player.opened.connect(self._on_opened)
        self._player.framed.connect(self._on_framed)
        self._player.failed.connect(self._on_source_failed)
        self._player.broken.connect(lambda: self._on_source_failed(AppError(BROKEN)))
        self._scene.painted.connect(self._on_painted)
        self._scene.failed.connect(self._on_avatar_failed)
        self._maker.progressed.connect(self._window.job_row.show_progress)
        self._maker.made.connect(self._on_profile_made)
        self._maker.failed.connect(lambda error: self._window.message_bar.tell(str(error)))
        self._maker.finished.connect(self._on_making_finished)

    def _opening(self) -> str:
        return f"Opening {self._window.sources.currentText()}…"

    def _on_preparing(self, progress: Progress) -> None:
        first = progress.done == 0
        self._window.source_pane.say(GETTING_READY if first else self._opening())

    def _on_opened(self, opened: Opened) -> None:
        if opened.trouble is not None:
            self._trouble = True
            self._window.message_bar.tell(str(opened.trouble))
        self._performer = opened.performer
        self._scene.enter(opened.performer.user)
        self._invite()

    def _on_solved(self, frame: Frame, state: FaceState, delivered_s: float) -> None:
        """Count and hand on what was solved; called in the live thread."""
        self._meter.count(frame, state, 1000 * (time.perf_counter() - delivered_s))
        self._scene.show(state, delivered_s)

    def _get_acquainted(self) -> None:
        """Give the avatar the head of who was seen without a profile, once it is known."""
        user = self._performer.learned() if self._performer is not None else None
        if user is not None:
            self._performer = None
            self._scene.become(user)

    def _on_framed(self, result: LiveResult) -> None:
        self._state = result.state
        image = image_from_array(result.frame.rgb)
        if result.state.lost:
            self._window.source_pane.show_picture(image, badge="Searching for the face…")
        else:
            self._window.source_pane.show_picture(image, self._overlay(result.state))

    def _overlay(self, state: FaceState) -> Overlay | None:
        if not self._window.landmarks_wanted:
            return None
        return Overlay(state.landmarks_px, DRAWN_CURVES, certain=state.confidence > SURE)

    def _on_painted(self, painted: Painted) -> None:
        if painted.wish.delivered_s is not None:
            self._meter.count_latency(1000 * (painted.ready_s - painted.wish.delivered_s))
        self._window.avatar_pane.show_picture(image_from_array(painted.picture))

    def _on_source_failed(self, error: CoreError | AppError) -> None:
        self._forget()
        self._window.message_bar.tell(str(error))
        again = Choice(self._wanted.source, "Try again")
        self._window.source_pane.say(NO_PICTURE, [again, *self._offers()])
        self._window.avatar_pane.say(WAITING)

    def _on_avatar_failed(self, error: AppError) -> None:
        self._window.message_bar.tell(str(error))
        self._window.avatar_pane.say("The avatar cannot be drawn.")

    def _look_around(self) -> None:
        """Do what need not be done with every frame."""
        self._get_acquainted()
        self._invite()
        self._show_numbers()

    def _show_numbers(self) -> None:
        meter = self._meter
        self._window.show_numbers(
            LiveNumbers(
                self._state_name(), meter.confidence, meter.frames_per_second(), meter.solve_ms,
                meter.latency_ms, meter.dropped,
            )
        )  # fmt: skip

    def _state_name(self) -> str:
        if not self._player.busy:
            return "off"
        if not self._window.source_pane.has_picture:
            return "opening"
        if self._state is None or self._state.lost:
            return "searching"
        doubt = "_unsure" if self._meter.confidence < DOUBTFUL else ""
        return self._state.mode + doubt

    # -- making a profile ----------------------------------------------------------------

    def _on_guided_wanted(self) -> None:
        """Leave the camera to the guided setup until its window is closed."""
        if self._guided is not None:
            self._guided.show()
            return
        camera = self._wanted.source if self._wanted.source.startswith("camera") else ""
        self._player.play(None)
        self._forget()
        self._window.source_pane.say(SETTING_UP)
        self._guided = self._tools.guided_setup(camera)
        self._guided.finished.connect(self._on_guided_finished)
        self._guided.show()

    def _on_guided_finished(self, name: str) -> None:
        """Go on, with the profile with which the user wanted to go live."""
        self._guided = None
        self._want(self._wanted.source, name or self._wanted.profile)

    def _on_new_profile_wanted(self, name: str, source: str) -> None:
        if self._maker.busy:
            return
        self._window.message_bar.tell("")
        self._window.new_profile_button.setEnabled(False)
        self._window.job_row.begin(f"Making the profile {name}")
        self._maker.start(self._tools.profile_steps(name, source))
        self._invite()

    def _on_profile_made(self, made: MadeProfile) -> None:
        self._want(self._wanted.source, made.name)
        self._window.message_bar.announce(made.text)

    def _on_making_finished(self) -> None:
        self._window.new_profile_button.setEnabled(True)
        self._window.job_row.end()
        self._invite()
