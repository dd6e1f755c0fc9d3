"""The capture page at work: asks for one prompt after the other and keeps what is taken."""

from queue import Empty

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from app.controllers.announcing import Announcer
from app.controllers.camera_words import trouble_text
from app.controllers.capture_tools import CaptureOpener, Tools
from app.controllers.contact import cell_of
from app.controllers.player import Player, Wanted
from app.controllers.prompts import ORDER, PLANS, QUICK, Prompts, told
from app.controllers.target import Target
from app.errors import AppError
from app.room import check_room
from app.setup_steps import unseen
from app.views.choice import Choice
from app.views.picture_view import image_from_array
from app.views.setup.capture_page import CapturePage
from app.views.setup.contact_sheet import CELL
from app.views.setup.guide_view import Guide
from app.workbook import Workbook, thumbnail
from app.workers.live_loop import LiveResult
from core.capture_judge import CaptureJudge, Judgement, Taken, weakness
from core.errors import CoreError
from core.records import FaceState, Frame
from core.setup_plan import Shot, shot_of
from core.shot_quality import ADVICE

__all__ = ["ORDER", "QUICK", "CaptureController", "told"]

#: A camera that is lost or busy is tried again so often; whether one waits is looked at as often.
RETRY_MS, TROUBLE_MS = 1500, 300
#: Said until the user goes on.
NOT_KEPT = "{why}. No pictures are taken now; make room, then press “Go on” to try again"
NO_CAMERA = "No camera was found: choose a source above"


class CaptureController(QObject):
    """Joins the capture page with a source, the judge and a workbook."""

    changed = Signal()  # a picture was kept or dropped
    troubled = Signal(str)  # why no picture can be kept; "" when one can again

    def __init__(self, page: CapturePage, tools: Tools, parent: QObject | None = None) -> None:
        super().__init__(parent or page)
        self._page, self._tools = page, tools
        self._judge, self._prompts = CaptureJudge(), Prompts()
        self._book: Workbook | None = None
        self._shot: Shot | None = None
        self._last, self._source, self._paused, self._full = "", "", False, False
        self._opener = CaptureOpener(tools, self._judge)
        self._player = Player(self._opener, self._on_solved, self)
        self._target = Target(page.target, tools, self)
        self.announcer = Announcer(tools.make_speaker())
        self._retry, self._watch = QTimer(self), QTimer(self)
        self._retry.setSingleShot(True)
        self._connect()

    # -- begin and end -------------------------------------------------------------------

    def start(self, book: Workbook, source: str = "", sound: bool = True) -> None:
        """Take pictures for a workbook, from a source or the first camera."""
        self._book = book
        self.announcer.hear(sound)
        self._page.show_sound(sound)
        self._target.start()
        self._watch.start(TROUBLE_MS)
        self._page.plans.show_choices(PLANS, self._prompts.key)
        self._show_sheet()
        self._ask_next()
        self._check_room()
        cameras = self._tools.cameras()
        self.play(source or (cameras[0].key if cameras else ""))

    def stop(self) -> None:
        """Close the source and end all threads; what was taken is already kept."""
        self._retry.stop()
        self._watch.stop()
        self._judge.ask(None)
        self._player.stop()
        self._target.stop()
        self.announcer.stop()

    def play(self, source: str) -> None:
        """Look through another camera."""
        self._source = source
        self._show_sources()
        self._page.live.show_image(None)
        text = "Opening the camera…" if source else NO_CAMERA
        self._page.live.show_guide(Guide(advice=text))
        self._retry.stop()
        self._player.play(Wanted(source, "") if source else None)

    def choose(self, plan: str) -> None:
        """Ask for other pictures: a key of PLANS."""
        self._prompts.choose(plan, self._there)
        self._page.plans.show_choices(PLANS, plan)
        self._show_sheet()
        self._ask_next()

    def _connect(self) -> None:
        page, player = self._page, self._player
        page.wished.connect(self._on_wish)
        page.source_chosen.connect(self.play)
        page.sources_wanted.connect(self._show_sources)
        page.plan_chosen.connect(self.choose)
        page.sound_wanted.connect(self.announcer.hear)
        page.sheet.chosen.connect(self._on_cell)
        player.framed.connect(self._on_framed)
        player.failed.connect(self._on_failed)
        self._retry.timeout.connect(lambda: self._player.play(Wanted(self._source, "")))
        self._watch.timeout.connect(self._on_watch)

    # -- prompts -------------------------------------------------------------------------

    @property
    def source(self) -> str:
        """Key of the source that is looked through, "" without one."""
        return self._source

    @property
    def shot(self) -> Shot | None:
        """The prompt that is asked for."""
        return self._shot

    @property
    def missing(self) -> list[str]:
        """The prompts of this session without a picture."""
        return self._prompts.missing(self._there)

    @property
    def _there(self) -> tuple[str, ...]:
        return self._book.names if self._book is not None else ()

    def _ask_next(self) -> None:
        self._ask(self._prompts.next(self._there))

    def _ask(self, name: str | None) -> None:
        self._shot = self._prompts.shot(name)
        self._judge.ask(self._shot)
        self._target.aim(self._shot)
        if self._shot is None:
            self._page.show_prompt(*self._nothing_left())
        else:
            title, instruction = told(self._shot)
            first = self._prompts.request if len(self.missing) == len(self._prompts.wanted) else ""
            self._page.show_prompt(title, f"{first}. {instruction}" if first else instruction)
            self._page.sheet.show_current(self._shot.name)
            base = shot_of(self._shot.name)
            self._tools.prompt(base.name if base is not None else self._shot.name)
        self._show_progress()

    def _nothing_left(self) -> tuple[str, str]:
        if self.missing:
            return "Done, but for those skipped", "Click one below to take it, or go on."
        weak = self._weak()
        if weak:
            return "All pictures are taken", (
                f"{weak} of them are weak: click one below to take it again, or go on."
            )
        return "All pictures are taken", (
            "Go on, or choose more pictures above: another light, with glasses, with a hand."
        )

    def _weak(self) -> int:
        return sum(cell.state == "weak" for cell in self._page.sheet.cells())

    def _show_progress(self) -> None:
        total = len(self._prompts.wanted)
        self._page.show_progress(total - len(self.missing), total, self._weak())

    def _on_wish(self, key: str) -> None:
        if self._shot is not None and key == "shoot":
            self._judge.shoot_now()
        elif self._shot is not None and key == "skip":
            self._prompts.skip(self._shot.name)
            self._ask_next()
        elif key == "retake" and self._last:
            self._ask(self._last)
        elif key == "pause":
            self._pause(not self._paused)
            if not self._paused:
                self._check_room()

    def _pause(self, paused: bool) -> None:
        self._paused = paused
        self._judge.pause(paused)
        self._page.show_paused(paused)

    def _check_room(self) -> None:
        """Pause where no picture can be kept, and say so before one is taken in vain."""
        try:
            if self._book is not None:
                check_room(self._book.folder)
        except CoreError as error:
            self._stop_taking(error)
            return
        if self._full:
            self._full = False
            self.troubled.emit("")

    def _stop_taking(self, error: CoreError) -> None:
        self._full = True
        self._pause(True)
        self.troubled.emit(NOT_KEPT.format(why=str(error).rstrip(".")))

    def _on_cell(self, name: str) -> None:
        self._prompts.skip(name, skipped=False)
        self._ask(name)

    # -- live ----------------------------------------------------------------------------

    def _on_solved(self, frame: Frame, state: FaceState | None, delivered_s: float) -> None:
        """Nothing follows the live face here; what is shown comes by `_on_framed`."""

    def _on_framed(self, result: LiveResult) -> None:
        tracker = self._opener.tracker
        judged = tracker.judged.take() if tracker is not None else None
        self._page.live.show_image(image_from_array(result.frame.rgb))
        self.announcer.back()
        if judged is not None:
            self._show_guide(judged, result.frame.time_s)
        while tracker is not None:
            try:
                self._keep(tracker.taken.get_nowait())
            except Empty:
                break

    def _show_guide(self, judged: Judgement, time_s: float) -> None:
        advice = ADVICE.get(judged.advice, "")
        if self._paused:
            guide = Guide(advice="Paused: no pictures are taken")
        elif judged.match is None or self._shot is None:
            guide = Guide(held=judged.shutter.held, advice=advice)
        else:
            yaw, pitch, roll = (float(x) for x in np.rad2deg(judged.match.turn_rad))
            found = judged.ghost
            ghost = () if found is None else (found.outline_px, *found.curves_px)
            guide = Guide(yaw, pitch, roll, judged.shutter.held, advice, ghost=ghost)
            self.announcer.hold(judged.shutter, time_s)
        self._page.live.show_guide(self.announcer.with_news(guide))

    def _on_failed(self, error: CoreError | AppError) -> None:
        """Say what is wrong; a camera is tried again by itself until it is back."""
        self.announcer.lost()
        again = self._source.startswith("camera")
        self._page.live.show_image(None)
        self._page.live.show_guide(Guide(advice=trouble_text(error, again)))
        self._show_sources()
        if again:
            self._retry.start(RETRY_MS)

    def _on_watch(self) -> None:
        """Tell of a camera that is waited for: it gives no frames and no error."""
        trouble = self._player.trouble
        if trouble:
            self.announcer.lost()
            self._page.live.show_guide(Guide(advice=trouble))

    def _keep(self, taken: Taken) -> None:
        book = self._book
        if book is None:
            return
        marks = taken.landmarks if taken.landmarks is not None else unseen()
        why = weakness(taken)
        try:
            book.put(taken.shot.name, taken.frame.rgb, marks, taken.quality | {"weak": why})
        except CoreError as error:
            self._stop_taking(error)
            if self._shot is not None:
                self._ask(self._shot.name)
            return
        self._last = taken.shot.name
        self._show_cell(taken.shot.name)
        if self._shot is not None and self._shot.name == taken.shot.name:
            self._ask_next()
        self.announcer.taken(why, last=self._shot is None and not self.missing)
        self.changed.emit()

    # -- what is shown -------------------------------------------------------------------

    def _show_sources(self) -> None:
        known = [*self._tools.cameras(), *self._tools.performances()]
        if self._source and self._source not in {one.key for one in known}:
            known.append(Choice(self._source, self._source))
        self._page.sources.show_choices(known, self._source)

    def _show_sheet(self) -> None:
        shots = self._prompts.shots
        self._page.sheet.show_cells([cell_of(self._book, shot.name) for shot in shots])
        for shot in shots:
            self._show_cell(shot.name)

    def _show_cell(self, name: str) -> None:
        thumb = None
        if self._book is not None and name in self._there:
            thumb = image_from_array(thumbnail(self._book.image(name), 2 * CELL.width()))
        self._page.sheet.show_cell(cell_of(self._book, name), thumb)
