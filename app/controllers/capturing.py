"""The capture page at work: asks for one prompt after the other and keeps what is taken."""

from queue import Empty

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QApplication

from app.controllers.capture_tools import CaptureOpener, Tools
from app.controllers.editing import title_of
from app.controllers.player import Player, Wanted
from app.controllers.scene import AvatarScene
from app.errors import AppError
from app.setup_steps import unseen
from app.views.choice import Choice
from app.views.picture_view import image_from_array
from app.views.setup.capture_page import CapturePage
from app.views.setup.contact_sheet import CELL, SheetCell
from app.views.setup.guide_view import Guide
from app.workbook import Workbook, thumbnail
from app.workers.avatar_loop import Painted
from app.workers.live_loop import LiveResult
from core.capture_judge import CaptureJudge, Judgement, Taken, weakness
from core.errors import CoreError
from core.geometry import matrix_from_head_angles, quaternion_from_matrix
from core.live import resting_state
from core.records import FaceState, Frame
from core.setup_plan import SHOTS, Shot
from core.shot_quality import ADVICE


def _rank(shot: Shot) -> tuple[int, float]:
    if shot.expression_name != "neutral":
        return 5, 0.0
    if shot.yaw:
        return (1 if shot.yaw < 0 else 2), abs(shot.yaw)
    return (3 if shot.pitch else 4 if shot.roll else 0), 0.0


#: All prompts, head turns from the front outwards: a face that was seen once is found again.
ORDER: tuple[Shot, ...] = tuple(sorted(SHOTS, key=_rank))
#: The quick subset: small head turns, and each expression from the front.
QUICK: tuple[str, ...] = (
    "pose_yaw+0", "pose_yaw-30", "pose_yaw+30", "pose_pitch-15", "pose_pitch+15",
    *(shot.name for shot in SHOTS if shot.expression_name != "neutral" and shot.yaw == 0.0),
)  # fmt: skip
#: The avatar that shows what is asked for.
MODEL_AVATAR = "nora"
TARGET_EVERY_MS, TURN_S, STAY_S = 40, 0.9, 1.6
FLASH_FRAMES = 8


class CaptureController(QObject):
    """Joins the capture page with a source, the judge and a workbook."""

    changed = Signal()  # a picture was kept or dropped

    def __init__(self, page: CapturePage, tools: Tools, parent: QObject | None = None) -> None:
        super().__init__(parent or page)
        self._page, self._tools = page, tools
        self._judge = CaptureJudge()
        self._book: Workbook | None = None
        self._shot: Shot | None = None
        self._last, self._source, self._files = "", "", list[str]()
        self._quick, self._paused, self._flash = False, False, 0
        self._skipped: set[str] = set()
        self._opener = CaptureOpener(tools, self._judge)
        self._player = Player(self._opener, self._on_solved, self)
        self._scene = AvatarScene(tools, MODEL_AVATAR, self)
        self._timer, self._phase_s = QTimer(self), 0.0
        self._connect()

    # -- begin and end -------------------------------------------------------------------

    def start(self, book: Workbook, source: str = "") -> None:
        """Take pictures for a workbook, from a source or the first camera."""
        self._book = book
        self._page.sheet.show_cells([self._cell(shot.name) for shot in ORDER])
        for shot in ORDER:
            self._show_cell(shot.name)
        self._scene.enter(None)
        self._timer.start(TARGET_EVERY_MS)
        self._ask_next()
        cameras = self._tools.cameras()
        self.play(source or (cameras[0].key if cameras else ""))

    def stop(self) -> None:
        """Close the source and end all threads; what was taken is already kept."""
        self._timer.stop()
        self._judge.ask(None)
        self._player.stop()
        self._scene.stop()

    def play(self, source: str) -> None:
        """Look through another camera."""
        self._source = source
        self._show_sources()
        self._page.live.show_image(None)
        text = "Opening the camera…" if source else "No camera was found: choose a source above"
        self._page.live.show_guide(Guide(advice=text))
        self._player.play(Wanted(source, "") if source else None)

    def _connect(self) -> None:
        page, player = self._page, self._player
        page.wished.connect(self._on_wish)
        page.source_chosen.connect(self.play)
        page.sources_wanted.connect(self._show_sources)
        page.quick_wanted.connect(self._on_quick)
        page.sheet.chosen.connect(self._on_cell)
        player.framed.connect(self._on_framed)
        player.failed.connect(self._on_failed)
        self._scene.painted.connect(self._on_painted)
        self._timer.timeout.connect(self._animate)

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
    def wanted(self) -> tuple[str, ...]:
        """The prompts of this session."""
        return QUICK if self._quick else tuple(shot.name for shot in ORDER)

    @property
    def missing(self) -> list[str]:
        """Those without a picture."""
        there = self._book.names if self._book is not None else ()
        return [name for name in self.wanted if name not in there]

    def _ask_next(self) -> None:
        missing = self.missing
        left = [name for name in missing if name not in self._skipped]
        self._ask(left[0] if left else None)

    def _ask(self, name: str | None) -> None:
        self._shot = next((shot for shot in SHOTS if shot.name == name), None)
        self._judge.ask(self._shot)
        self._phase_s = 0.0
        if self._shot is None:
            self._page.show_prompt(*self._nothing_left())
        else:
            self._page.show_prompt(*told(self._shot))
            self._page.sheet.show_current(self._shot.name)
            self._tools.prompt(self._shot.name)
        self._show_progress()

    def _nothing_left(self) -> tuple[str, str]:
        if self.missing:
            return "Done, but for those skipped", "Click one below to take it, or go on."
        return "All pictures are taken", "Click one below to take it again, or go on."

    def _show_progress(self) -> None:
        total = len(self.wanted)
        self._page.show_progress(total - len(self.missing), total)

    def _on_wish(self, key: str) -> None:
        if self._shot is not None and key == "shoot":
            self._judge.shoot_now()
        elif self._shot is not None and key == "skip":
            self._skipped.add(self._shot.name)
            self._ask_next()
        elif key == "retake" and self._last:
            self._ask(self._last)
        elif key == "pause":
            self._paused = not self._paused
            self._judge.pause(self._paused)
            self._page.show_paused(self._paused)

    def _on_quick(self, quick: bool) -> None:
        self._quick = quick
        self._ask_next()

    def _on_cell(self, name: str) -> None:
        self._skipped.discard(name)
        self._ask(name)

    # -- live ----------------------------------------------------------------------------

    def _on_solved(self, frame: Frame, state: FaceState | None, delivered_s: float) -> None:
        """Nothing follows the live face here; what is shown comes by `_on_framed`."""

    def _on_framed(self, result: LiveResult) -> None:
        tracker = self._opener.tracker
        judged = tracker.judged.take() if tracker is not None else None
        self._page.live.show_image(image_from_array(result.frame.rgb))
        if judged is not None:
            self._show_guide(judged)
        while tracker is not None:
            try:
                self._keep(tracker.taken.get_nowait())
            except Empty:
                break

    def _show_guide(self, judged: Judgement) -> None:
        self._flash = max(self._flash - 1, 0)
        flash, advice = self._flash > 0, ADVICE.get(judged.advice, "")
        if self._paused:
            guide = Guide(advice="Paused: no pictures are taken", flash=flash)
        elif judged.match is None or self._shot is None:
            guide = Guide(held=judged.shutter.held, advice=advice, flash=flash)
        else:
            yaw, pitch, roll = (float(x) for x in np.rad2deg(judged.match.turn_rad))
            guide = Guide(yaw, pitch, roll, judged.shutter.held, advice, flash)
        self._page.live.show_guide(guide)

    def _on_failed(self, error: CoreError | AppError) -> None:
        self._page.live.show_image(None)
        self._page.live.show_guide(Guide(advice=f"{error}. Choose the camera again to go on."))
        self._show_sources()

    def _keep(self, taken: Taken) -> None:
        book = self._book
        if book is None:
            return
        marks = taken.landmarks if taken.landmarks is not None else unseen()
        why = weakness(taken)
        try:
            book.put(taken.shot.name, taken.frame.rgb, marks, taken.quality | {"weak": why})
        except CoreError as error:
            self._page.live.show_guide(Guide(advice=str(error)))
            return
        self._last, self._flash = taken.shot.name, FLASH_FRAMES
        QApplication.beep()
        self._show_cell(taken.shot.name)
        if self._shot is not None and self._shot.name == taken.shot.name:
            self._ask_next()
        self.changed.emit()

    # -- what is shown -------------------------------------------------------------------

    def _show_sources(self) -> None:
        known = [*self._tools.cameras(), *self._tools.performances()]
        if self._source and self._source not in {one.key for one in known}:
            known.append(Choice(self._source, self._source))
        self._page.sources.show_choices(known, self._source)

    def _cell(self, name: str) -> SheetCell:
        book = self._book
        if book is None or name not in book.names:
            return SheetCell(name, title_of(name), "missing", "not taken yet; click to take it")
        weak = str(book.quality(name).get("weak", ""))
        note = f"{weak}; click to take it again" if weak else "good; click to take it again"
        return SheetCell(name, title_of(name), "weak" if weak else "good", note)

    def _show_cell(self, name: str) -> None:
        thumb = None
        if self._book is not None and name in self._book.names:
            thumb = image_from_array(thumbnail(self._book.image(name), 2 * CELL.width()))
        self._page.sheet.show_cell(self._cell(name), thumb)

    def _animate(self) -> None:
        """Let the avatar go from a neutral face to what is asked for, and stay there a while."""
        self._phase_s = (self._phase_s + TARGET_EVERY_MS / 1000) % (TURN_S + STAY_S)
        share = min(self._phase_s / TURN_S, 1.0)
        self._scene.show(target_state(self._shot, share * share * (3 - 2 * share)), 0.0)

    def _on_painted(self, painted: Painted) -> None:
        self._page.target.show_image(image_from_array(painted.picture))


def told(shot: Shot) -> tuple[str, str]:
    """Return what a prompt asks for, in short and in full."""
    face, _, turn = shot.instruction.rstrip(".").rpartition(", and ")
    if shot.expression_name == "neutral":
        return turn[:1].upper() + turn[1:], f"{face}."
    return face, f"Meanwhile, {turn}."


def target_state(shot: Shot | None, share: float) -> FaceState:
    """Return a share of what a prompt asks for, as its mirror image: the user copies a mirror."""
    rest = resting_state("free")
    if shot is None:
        return rest
    angles = share * np.array([shot.yaw, shot.pitch, shot.roll])
    return FaceState(
        0.0, quaternion_from_matrix(matrix_from_head_angles(*angles)), np.array([0, 0, 600.0]),
        share * shot.standard, rest.gaze_rad, rest.shape_mm, rest.landmarks_px, 1.0, "free", False,
    )  # fmt: skip
