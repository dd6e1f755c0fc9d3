"""Shows what the live view makes: the two pictures, what lies over them, and the numbers."""

import time
from collections.abc import Sequence

from PySide6.QtCore import QObject

from app.controllers.cpu_share import CpuShare
from app.controllers.matching import DelayMatch
from app.controllers.meter import Meter
from app.controllers.overlays import MeshMaker, Overlays
from app.controllers.remarks import NEXT_AVATAR, SEARCHING, state_name
from app.render.quality import Drawn
from app.views.choice import Choice
from app.views.live_window import LiveWindow
from app.views.picture_view import blank_image, image_from_array
from app.views.status_row import LiveNumbers
from app.workers.avatar_loop import Painted
from app.workers.live_loop import LiveResult
from core.records import FaceState, Frame


class Showing(QObject):
    """The screen's side of the live view; remembers the newest state.

    Attributes:
        state: The newest one.
        lent: Whether what is shown is a take, not the source.
    """

    def __init__(self, window: LiveWindow, maker: MeshMaker, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._window = window
        self.overlays = Overlays(window.deeds, maker, self)
        self._meter, self._match = Meter(), DelayMatch()
        self._avatar_seen = True
        window.pair.shown.connect(lambda *_: self._look_for_avatar())
        window.deeds["alone"].toggled.connect(lambda _: self._look_for_avatar())
        self._cpu, self._trouble, self._drawn = CpuShare(), "", Drawn()
        self.state: FaceState | None = None
        self.lent = False

    @property
    def avatar_seen(self) -> bool:
        """Whether anybody sees the avatar, here or in its own window; from any thread."""
        return self._avatar_seen

    def reset(self) -> None:
        """Begin anew with another source."""
        self.lent = False
        self.state, self._trouble = None, ""
        self._meter.reset()
        self._match.reset()

    def count(self, frame: Frame, state: FaceState, delivered_s: float) -> None:
        """Count a solved frame; called in the live thread."""
        self._meter.count(frame, state, 1000 * (time.perf_counter() - delivered_s))
        self.overlays.note(frame, state)

    def show_solved(self, result: LiveResult) -> None:
        """Show a frame, unless its avatar picture is about to come."""
        self.state = result.state
        if self._match.on_solved(result.frame):
            self._show_frame(result.frame, result.state)

    def show_painted(self, painted: Painted) -> None:
        """Show the avatar and the frame that its pose was solved from."""
        wish = painted.wish
        if wish.delivered_s is not None:
            self._meter.count_latency(1000 * (painted.ready_s - wish.delivered_s))
        self._drawn = painted.drawn
        layers = self.overlays.over_avatar(wish.state)
        badge = NEXT_AVATAR.format(self._window.avatars.currentText()) if self._drawn.making else ""
        self._window.avatar_pane.show_picture(image_from_array(painted.picture), layers, badge)
        if wish.frame is None or wish.solved is None:
            return
        if self._match.on_painted(wish.frame):
            self._show_frame(wish.frame, wish.solved)

    def _look_for_avatar(self) -> None:
        """Let frames wait for the avatar's pictures only where these are seen."""
        window = self._window
        self._avatar_seen = window.pair.shows("avatar") or window.deeds.on("alone")
        self._match.waits = window.pair.shows("avatar")

    def show_trouble(self, trouble: str, offers: Sequence[Choice]) -> None:
        """Say why no pictures come, or nothing; they come again by themselves.

        Args:
            trouble: Such as a camera that is gone.
            offers: Sources to choose instead.
        """
        if trouble and trouble != self._trouble:
            self._window.source_pane.say(trouble, offers)
        self._trouble = trouble

    def show_numbers(self, busy: bool) -> None:
        """Show the state of tracking and the speeds.

        Args:
            busy: Whether a source is played or being opened.
        """
        meter = self._meter
        has_picture = self._window.source_pane.has_picture
        name = state_name(busy, bool(self._trouble), has_picture, self.state, meter.confidence)
        name = "take" if self.lent else name
        self._window.show_numbers(
            LiveNumbers(
                name, meter.confidence, meter.frames_per_second(), meter.solve_ms,
                meter.latency_ms, meter.dropped, self._cpu.look(), self._drawn.scale,
            )
        )  # fmt: skip

    def _show_frame(self, frame: Frame, state: FaceState) -> None:
        """Show a frame, or if that is not wished for only what was found in it."""
        height, width = frame.gray.shape
        hidden = self._window.deeds.on("blank")
        image = blank_image(width, height) if hidden else image_from_array(frame.rgb)
        badge = SEARCHING if state.lost else ""
        layers = self.overlays.over_source(state)
        self._window.source_pane.show_picture(image, layers, badge)
