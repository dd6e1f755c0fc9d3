"""The live window at work: source and profile chosen, frames solved, avatar painted."""

import time
from collections import deque
from collections.abc import Callable, Generator
from dataclasses import dataclass
from functools import partial

from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QApplication, QFileDialog, QInputDialog

from app.capture.source import FrameSource
from app.controllers.toolbox import Toolbox
from app.errors import AppError
from app.models import live_tracker
from app.profiles import profile_folder, profile_names
from app.views.live_window import Choice, LiveNumbers, LiveWindow
from app.views.picture_view import Overlay, image_from_array
from app.workers.avatar_loop import AvatarLoop
from app.workers.job import Job
from app.workers.live_loop import LiveLoop, LiveResult
from core.errors import CoreError
from core.landmarks import CURVES, N_INTERNAL
from core.live import LiveTracker
from core.records import FaceState, Frame, Progress, UserBlendshapes
from core.store import load

#: Keys of choices that are no source or profile themselves.
OPEN_FILE, NO_PROFILE = "?file", ""
NUMBERS_EVERY_MS = 250
#: The last landmarks stand for the outline but lie on the skin: they are dots, not a line.
DRAWN_CURVES = tuple(curve for curve in CURVES if max(curve) < N_INTERNAL)
REMEMBERED_FRAMES = 64


@dataclass(frozen=True, slots=True, eq=False)
class Opened:
    """A source ready to play, what follows the face in it, and whose face that is."""

    source: FrameSource
    tracker: LiveTracker | None
    user: UserBlendshapes | None


class Stepper:
    """Solves frames in the live thread and hands states straight to the painter."""

    def __init__(self, tracker: LiveTracker | None, show_state: Callable[[FaceState], None]):
        self._tracker, self._show_state = tracker, show_state
        self._delivered: deque[tuple[float, float]] = deque(maxlen=REMEMBERED_FRAMES)

    def step(self, frame: Frame) -> FaceState | None:
        """Solve a frame; None without a tracker."""
        self._delivered.append((frame.time_s, time.perf_counter()))
        if self._tracker is None:
            return None
        state = self._tracker.step(frame)
        self._show_state(state)
        return state

    def delivered_s(self, time_s: float) -> float | None:
        """Return when the frame of this capture time was delivered; None if long ago."""
        return next((when for t, when in tuple(self._delivered) if t == time_s), None)


class Meter:
    """Counts what the status line says."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Begin anew with a new source."""
        self._arrivals: deque[float] = deque(maxlen=30)
        self._last_index: int | None = None
        self.dropped, self.solve_ms, self.latency_ms = 0, 0.0, 0.0

    def count(self, result: LiveResult) -> None:
        """Count a solved frame."""
        self._arrivals.append(time.perf_counter())
        self.solve_ms += 0.1 * (result.step_ms - self.solve_ms)
        if self._last_index is not None:
            self.dropped += max(0, result.frame.index - self._last_index - 1)
        self._last_index = result.frame.index

    def count_latency(self, latency_ms: float) -> None:
        """Count a painted picture."""
        self.latency_ms += 0.1 * (latency_ms - self.latency_ms)

    def frames_per_second(self) -> float:
        """Return the rate over the last second or so, 0 while nothing comes."""
        arrivals = self._arrivals
        if len(arrivals) < 2 or time.perf_counter() - arrivals[-1] > 1.0:
            return 0.0
        return (len(arrivals) - 1) / (arrivals[-1] - arrivals[0])


class LiveController(QObject):
    """Joins the live window with sources, profiles and threads."""

    def __init__(self, window: LiveWindow, toolbox: Toolbox) -> None:
        super().__init__(window)
        self._window, self._toolbox = window, toolbox
        self._source_key, self._profile_key = toolbox.sources()[0].key, NO_PROFILE
        self._avatar_key = toolbox.avatars()[0].key
        self._user: UserBlendshapes | None = None
        self._files: list[str] = []
        self._meter = Meter()
        self._stepper: Stepper | None = None
        self._state: FaceState | None = None
        self._loop: LiveLoop | None = None
        self._opening: Job | None = None
        self._making: Job | None = None
        self._painter: AvatarLoop | None = None
        self._connect(window)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._show_numbers)

    def start(self) -> None:
        """Fill the choosers and play the first source."""
        names = profile_names()
        self._profile_key = names[0] if names else NO_PROFILE
        self._show_choices()
        self._timer.start(NUMBERS_EVERY_MS)
        self._play()

    def stop(self) -> None:
        """End all threads; the source is closed."""
        self._timer.stop()
        for job in (self._making, self._opening):
            if job is not None:
                job.cancel()
        self._stop_loop()
        self._stop_painter()

    # -- choices -------------------------------------------------------------------------

    def _connect(self, window: LiveWindow) -> None:
        window.source_chosen.connect(self._on_source_chosen)
        window.profile_chosen.connect(self._on_profile_chosen)
        window.avatar_chosen.connect(self._on_avatar_chosen)
        window.new_profile_wanted.connect(self._on_new_profile_wanted)
        window.cancel_wanted.connect(self._on_cancel_wanted)
        window.closing.connect(self.stop)

    def _show_choices(self) -> None:
        sources = [*self._toolbox.sources(), *(Choice(path, path) for path in self._files)]
        sources.append(Choice(OPEN_FILE, "Video file…"))
        self._window.show_sources(sources, self._source_key)
        profiles = [Choice(NO_PROFILE, "No profile"), *(Choice(n, n) for n in profile_names())]
        self._window.show_profiles(profiles, self._profile_key)
        self._window.show_avatars(self._toolbox.avatars(), self._avatar_key)

    def _on_source_chosen(self, key: str) -> None:
        if key == OPEN_FILE:
            key = self._ask_for_file("Open a video")
            if not key:
                self._show_choices()
                return
            if key not in self._files:
                self._files.append(key)
        self._source_key = key
        self._show_choices()
        self._play()

    def _on_profile_chosen(self, key: str) -> None:
        self._profile_key = key
        self._play()

    def _on_avatar_chosen(self, key: str) -> None:
        self._avatar_key = key
        if self._painter is not None:
            self._start_painter()

    def _ask_for_file(self, title: str) -> str:
        kinds = "Videos (*.mp4 *.mov *.avi *.mkv *.webm);;All files (*)"
        return QFileDialog.getOpenFileName(self._window, title, "", kinds)[0]

    # -- playing -------------------------------------------------------------------------

    def _play(self) -> None:
        """Open the chosen source and profile in the background, then play."""
        self._stop_loop()
        self._stop_painter()
        if self._opening is not None:
            self._opening.cancel()
        self._meter.reset()
        self._state = None
        self._window.show_message("")
        self._window.source_view.show_image(None)
        self._window.source_view.show_overlay(None)
        self._window.source_view.show_empty_text("Opening…")
        self._opening = Job(self._open(self._source_key, self._profile_key), self)
        self._opening.returned.connect(self._on_opened)
        self._opening.failed.connect(self._on_failed)
        self._opening.start()

    def _open(self, source: str, profile: str) -> Generator[Progress, None, Opened]:
        """Open a source and make the tracker of a profile."""
        yield Progress(0, 1, "Opening")
        if profile == NO_PROFILE:
            return Opened(self._toolbox.open_source(source), None, None)
        known = load(profile_folder(profile))
        tracker = live_tracker(self._toolbox.models(), known)
        return Opened(self._toolbox.open_source(source), tracker, known.user)

    def _on_opened(self, opened: Opened) -> None:
        self._user = opened.user
        if opened.tracker is not None:
            self._start_painter()
        self._stepper = Stepper(opened.tracker, self._paint)
        self._loop = LiveLoop(opened.source, self._stepper.step, self)
        self._loop.posted.connect(self._on_frame)
        self._loop.failed.connect(self._on_failed)
        self._loop.ended.connect(self._on_ended)
        self._loop.start()
        if opened.tracker is None:
            self._window.avatar_view.show_image(None)
            self._window.avatar_view.show_empty_text(
                "Choose a profile above, or make one with “New profile…”: "
                "a minute of video of your face is enough."
            )

    def _paint(self, state: FaceState) -> None:
        """Hand a state to the painter; called in the live thread."""
        painter = self._painter
        if painter is not None:
            painter.show_state(state)

    def _start_painter(self) -> None:
        """Paint the chosen avatar from now on."""
        self._stop_painter()
        self._painter = AvatarLoop(
            partial(self._toolbox.make_painter, self._avatar_key, self._user), self
        )
        self._painter.posted.connect(self._on_painted)
        self._painter.failed.connect(self._on_failed)
        self._painter.start()

    def _stop_painter(self) -> None:
        if self._painter is not None:
            self._painter.stop()
            self._painter.deleteLater()
            self._painter = None

    def _stop_loop(self) -> None:
        if self._loop is not None:
            self._loop.stop()
            self._loop.deleteLater()
            self._loop = None

    def _on_frame(self) -> None:
        result = self._loop.results.take() if self._loop is not None else None
        if result is None:
            return
        self._meter.count(result)
        self._state = result.state
        self._window.source_view.show_image(image_from_array(result.frame.rgb))
        self._window.source_view.show_overlay(self._overlay(result.state))

    def _overlay(self, state: FaceState | None) -> Overlay | None:
        if state is None or state.lost or not self._window.landmarks_wanted:
            return None
        return Overlay(state.landmarks_px, DRAWN_CURVES, certain=state.confidence > 0.5)

    def _on_painted(self) -> None:
        painted = self._painter.pictures.take() if self._painter is not None else None
        if painted is None or self._stepper is None:
            return
        delivered_s = self._stepper.delivered_s(painted.state.time_s)
        if delivered_s is not None:
            self._meter.count_latency(1000 * (painted.ready_s - delivered_s))
        if self._profile_key != NO_PROFILE:
            self._window.avatar_view.show_image(image_from_array(painted.picture))

    def _on_ended(self) -> None:
        self._window.show_message("The video has ended. Choose a source to go on.")

    def _on_failed(self, error: CoreError | AppError) -> None:
        self._window.show_message(str(error))
        self._window.source_view.show_empty_text("No picture. Choose another source above.")

    def _show_numbers(self) -> None:
        meter, state = self._meter, self._state
        name = "idle"
        if self._profile_key != NO_PROFILE:
            name = "searching" if state is None or state.lost else "tracking"
        confidence = 0.0 if state is None else state.confidence
        self._window.show_numbers(
            LiveNumbers(
                name, confidence, meter.frames_per_second(), meter.solve_ms, meter.latency_ms,
                meter.dropped,
            )
        )  # fmt: skip

    # -- making a profile ----------------------------------------------------------------

    def _on_new_profile_wanted(self) -> None:
        if self._making is not None:
            return
        path = self._ask_for_file("Choose a video of your face: all expressions, some head turns")
        if not path:
            return
        name, given = QInputDialog.getText(self._window, "New profile", "Name of the profile:")
        if given:
            self.make_profile(name.strip(), path)

    def make_profile(self, name: str, source: str) -> None:
        """Make a profile from a video or a folder in the background, then use it."""
        self._window.show_message("")
        self._making = Job(self._toolbox.profile_steps(name, source), self)
        self._making.progressed.connect(self._on_progress)
        self._making.returned.connect(self._on_profile_made)
        self._making.failed.connect(self._on_failed)
        self._making.finished.connect(self._on_making_finished)
        self._making.start()

    def _on_progress(self, progress: Progress) -> None:
        percent = round(100 * progress.done / max(progress.total, 1))
        self._window.show_job(progress.label, percent)

    def _on_profile_made(self, name: str) -> None:
        self._profile_key = name
        self._show_choices()
        self._play()

    def _on_making_finished(self) -> None:
        self._making = None
        self._window.show_job("", 0)

    def _on_cancel_wanted(self) -> None:
        if self._making is not None:
            self._making.requestInterruption()


def open_window() -> int:
    """Show the live window until it is closed; return the exit code."""
    application = QApplication.instance() or QApplication(["facepuppet"])
    window = LiveWindow()
    controller = LiveController(window, Toolbox())
    window.show()
    controller.start()
    return int(application.exec())
