"""The camera page at work: all cameras shown, one chosen and examined, its settings held."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from PySide6.QtCore import QObject, QTimer, Signal

from app.capture.choose import camera_number
from app.capture.source import FrameSource
from app.controllers import camera_hold
from app.controllers.camera_hold import CameraHold
from app.controllers.camera_watch import Examiner
from app.controllers.camera_words import GONE, trouble_in_short, trouble_text
from app.controllers.previews import Previews
from app.errors import AppError
from app.views.choice import Choice
from app.views.picture_view import image_from_array
from app.views.setup.camera_list import THUMB, CameraCard
from app.views.setup.camera_page import CameraPage
from app.views.setup.guide_view import Guide
from app.workbook import thumbnail
from app.workers.preview_loop import Preview
from core.capture_judge import Judgement
from core.errors import CoreError
from core.free_live import FreeTracker
from core.records import U8
from core.shot_quality import ADVICE

#: Between two looks at which cameras there are and whether one is free again.
LOOK_EVERY_MS = 2000
#: Thumbnails need not be shown with every frame; so many blank ones in a row are told.
THUMB_EVERY, BLANK_FRAMES = 3, 20
OPENING, CLOSED = "Opening…", "Choose it to see it"
BLANK = "No picture: is its lid or shutter closed?"
FINE = "Light, distance, sharpness and speed are good."
NO_CAMERA = (
    "No camera was found. Plug one in: it appears here by itself. Or choose the virtual performer."
)
PREPARING = "Getting ready to look for your face…"


class Tools(camera_hold.Tools, Protocol):
    """What is needed of the toolbox."""

    def cameras(self) -> list[Choice]:
        """Return the cameras of this machine."""
        ...

    def performances(self) -> list[Choice]:
        """Return what the virtual performer can play."""
        ...

    def open_preview(self, key: str) -> FrameSource:
        """Open a source; one that is lost later tells so."""
        ...

    def capture_tracker(self) -> tuple[FreeTracker, Callable[[U8], int]]:
        """Return a tracker, and what counts rival faces in a picture."""
        ...


class CameraController(QObject):
    """Joins the camera page with the cameras."""

    changed = Signal()  # whether one can go on with the chosen camera

    def __init__(self, page: CameraPage, tools: Tools, parent: QObject | None = None) -> None:
        super().__init__(parent or page)
        self._page, self._tools = page, tools
        self._cards: dict[str, CameraCard] = {}
        self._counts: dict[str, int] = {}
        self._blank: dict[str, int] = {}
        self._chosen, self._by_user, self._live, self._alone = "", False, False, False
        self._examiner = Examiner(tools.capture_tracker)
        self._previews = Previews(tools.open_preview, self)
        self._hold = CameraHold(page, self._previews, tools)
        self._timer = QTimer(self)
        self._connect()

    @property
    def chosen(self) -> str:
        """Key of the chosen source, "" without one."""
        return self._chosen

    @property
    def ready(self) -> bool:
        """Whether the chosen source gives pictures."""
        return self._live

    @property
    def hold_wanted(self) -> bool:
        """Whether cameras are asked to hold their settings."""
        return self._hold.wanted

    def start(self, source: str = "", hold: bool = True) -> None:
        """Show the cameras; begin with a source, or the first camera."""
        self._by_user, self._alone = bool(source), False
        self._cards, self._chosen = {}, ""
        self._hold.want(hold)
        self._list()
        if source:
            self._choose(source)
        self._timer.start(LOOK_EVERY_MS)

    def stop(self) -> None:
        """Close all cameras."""
        self._timer.stop()
        self._previews.stop()
        self._cards, self._chosen = {}, ""
        self._set_live(False)

    def look_again(self) -> None:
        """Look which cameras there are, and try those again that gave nothing."""
        self._list()
        self._previews.retry()

    def _connect(self) -> None:
        self._page.camera_chosen.connect(self._on_chosen)
        self._page.hold_wanted.connect(self._hold.want)
        self._previews.shown.connect(self._on_shown)
        self._previews.failed.connect(self._on_failed)
        self._timer.timeout.connect(self.look_again)

    # -- which cameras -------------------------------------------------------------------

    def _list(self) -> None:
        """Bring the cards up to date with what is plugged in."""
        found = [*self._tools.cameras(), *self._tools.performances()]
        before, self._cards = self._cards, {}
        for choice in found:
            known = before.get(choice.key)
            same = known is not None and known.name == choice.text and known.trouble != GONE
            facts = OPENING if is_camera(choice.key) else choice.details or CLOSED
            self._cards[choice.key] = (
                known if same and known is not None else CameraCard(choice.key, choice.text, facts)
            )
        lost = before.get(self._chosen)
        if lost is not None and lost.key not in self._cards:
            gone = replace(lost, trouble=GONE) if is_camera(lost.key) else lost
            self._cards = {lost.key: gone, **self._cards}
        if self._chosen not in self._cards and not self._by_user:
            cameras = [choice.key for choice in self._tools.cameras()]
            self._choose(cameras[0] if cameras else "")
        self._want()
        self._show_cards()

    def _want(self) -> None:
        """Have the chosen source open, and the other cameras beside it."""
        cameras = [] if self._alone else [choice.key for choice in self._tools.cameras()]
        others = [key for key in cameras if key != self._chosen]
        gone = self._chosen in self._cards and self._cards[self._chosen].trouble == GONE
        first = [self._chosen] if self._chosen and not gone else []
        self._previews.want([*first, *others])

    def _on_chosen(self, key: str) -> None:
        self._by_user = True
        if key == self._chosen and not self._in_trouble(key):
            return
        # One that could not be opened beside the others may be opened alone.
        self._alone = self._in_trouble(key)
        self._choose(key)

    def _choose(self, key: str) -> None:
        before = self._previews.loop(self._chosen)
        if before is not None:
            before.look = None
        if key and key not in self._cards:
            self._cards[key] = CameraCard(key, key.replace("\\", "/").split("/")[-1], OPENING)
        self._chosen = key
        self._hold.choose(key)
        self._set_live(False)
        self._page.live.show_image(None)
        self._page.live.show_guide(Guide(advice=OPENING if key else NO_CAMERA))
        self._page.show_verdict("")
        self._show_cards()
        self._want()
        if key in self._cards and self._cards[key].trouble:
            self._previews.retry()

    def _show_cards(self) -> None:
        self._page.show_cards(list(self._cards.values()), self._chosen)

    def _set_card(self, key: str, facts: str, trouble: str = "") -> None:
        card = self._cards.get(key)
        changed = card is not None and (card.facts, card.trouble) != (facts, trouble)
        if card is not None and changed:
            self._cards[key] = replace(card, facts=facts, trouble=trouble)
            self._show_cards()

    def _set_live(self, live: bool) -> None:
        if live != self._live:
            self._live = live
            self.changed.emit()

    # -- what they show ------------------------------------------------------------------

    def _on_shown(self, key: str, preview: Preview) -> None:
        self._counts[key] = self._counts.get(key, 0) + 1
        self._blank[key] = self._blank.get(key, 0) + 1 if preview.blank else 0
        blank = self._blank[key] >= BLANK_FRAMES
        if self._counts[key] % THUMB_EVERY == 1:
            small = thumbnail(preview.frame.rgb, 2 * THUMB.width())
            self._page.cameras.show_thumb(key, image_from_array(small))
            self._set_card(key, self._facts(key, preview), BLANK if blank else "")
        if key == self._chosen:
            self._show_chosen(key, preview, blank)
        elif not self._by_user and not preview.blank and self._in_trouble(self._chosen):
            # The first one does not work, and the user has not chosen: this one does.
            self._choose(key)

    def _in_trouble(self, key: str) -> bool:
        card = self._cards.get(key)
        return card is not None and bool(card.trouble)

    def _facts(self, key: str, preview: Preview) -> str:
        """Return size and speed; while the speed is measured anew the one before stands."""
        height, width = preview.frame.gray.shape
        size, card = f"{width} × {height}", self._cards.get(key)
        if not math.isnan(preview.fps):
            return f"{size}, {preview.fps:.1f} fps"
        return card.facts if card is not None and card.facts.startswith(size) else size

    def _show_chosen(self, key: str, preview: Preview, blank: bool) -> None:
        loop = self._previews.loop(key)
        if loop is not None and loop.look is None:
            loop.look = lambda frame: self._examiner.look(loop, frame)
        self._page.live.show_image(image_from_array(preview.frame.rgb))
        self._set_live(True)
        if blank:
            self._page.live.show_guide(Guide(advice=BLANK))
            self._page.show_verdict("")
        elif preview.seen is not None:
            self._show_judgement(preview.seen, preview.frame.time_s)
        elif self._page.live.guide.advice == OPENING:
            self._page.live.show_guide(Guide(advice=PREPARING))

    def _show_judgement(self, judged: Judgement, time_s: float) -> None:
        self._page.live.show_guide(Guide(advice=ADVICE.get(judged.advice, "")))
        self._hold.step(judged.advice, time_s)
        self._page.show_verdict(FINE if self._hold.good else "")

    def _on_failed(self, key: str, error: CoreError | AppError) -> None:
        self._page.cameras.show_thumb(key, None)
        card = self._cards.get(key)
        if card is not None and card.trouble != GONE:
            self._set_card(key, card.facts, trouble_in_short(error))
        if key != self._chosen:
            return
        self._page.live.show_image(None)
        self._page.live.show_guide(Guide(advice=trouble_text(error, again=True)))
        self._page.show_verdict("")
        self._hold.forget()
        self._set_live(False)


def is_camera(key: str) -> bool:
    """Return whether a key is one of a camera that is plugged in, rather than of a file."""
    return camera_number(key) is not None
