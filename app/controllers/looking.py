"""How the avatar is seen: what panel, mouse and keys wish, and what was kept for each avatar."""

from collections.abc import Generator
from functools import partial

from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QMenu

from app.controllers.live import LiveController
from app.errors import AppError
from app.look_files import KeptLook, load_looks, save_looks
from app.picture_files import load_picture
from app.render.lights import LIGHTS
from app.render.look import AvatarLook
from app.render.quality import Drawn
from app.views.avatar_mouse import AvatarMouse
from app.views.avatar_panel import FRAMING_CHOICES, AvatarPanel
from app.views.live_window import LiveWindow
from app.workers.avatar_loop import Painted
from app.workers.job import Job
from core.errors import CoreError
from core.records import Progress

#: The mouse tells of its way more often than pictures can be drawn.
SHOWN_EVERY_MS = 16
#: Time without a change after which looks are written to the disk.
KEPT_AFTER_MS = 800
IN_SOFTWARE = "This computer draws without a graphics card: edges are smoothed afterwards."


class Looking(QObject):
    """Joins the panel and the avatar's picture with the scene."""

    def __init__(self, controller: LiveController, window: LiveWindow) -> None:
        """Add the panel and listen to the avatar's picture."""
        super().__init__(controller)
        self._controller, self._window = controller, window
        self._kept = load_looks()
        self._drawn: Drawn | None = None
        self._wanted_picture, self._told = "", ""
        self._avatar = controller.scene.avatar
        self.panel = AvatarPanel(tuple(LIGHTS))
        self.mouse = AvatarMouse(window.avatar_pane.picture)
        self._show_soon, self._keep_soon = QTimer(self), QTimer(self)
        self._connect()
        window.add_panel("avatar_look", "Avatar &view", self.panel, "Ctrl+Shift+V")
        self._fill_menu(window.menu("Avatar"))
        self._enter_avatar()

    @property
    def look(self) -> AvatarLook:
        """How the avatar is seen now."""
        kept = self._current()
        sources = self._window.mirror_box.isChecked()
        mirrored = sources if kept.mirror == "source" else kept.mirror == "yes"
        return kept.look.changed(mirrored=mirrored)

    # -- wishes --------------------------------------------------------------------------

    def see(self, look: AvatarLook) -> None:
        """See the avatar like this from now on, and keep it."""
        if self.look.changed(background=look.background) == look:
            self._take_back()
        self._put(KeptLook(look, self._current().mirror))

    def use_picture(self, path: str) -> None:
        """Put a picture file behind the avatar that plays now, once it has been read."""
        self._wanted_picture = path
        job = Job(_read(self._avatar, path), self)
        job.returned.connect(self._on_picture_read)
        job.failed.connect(self._on_picture_failed)
        job.finished.connect(job.deleteLater)
        job.start()

    def reset_view(self) -> None:
        """See the avatar from the front again."""
        self.see(self.look.seen_as_at_first())

    def reset_all(self) -> None:
        """Forget everything that was chosen for this avatar."""
        self._put(KeptLook())

    # -- construction --------------------------------------------------------------------

    def _connect(self) -> None:
        controller, panel, mouse = self._controller, self.panel, self.mouse
        for timer, wait_ms, call in (
            (self._show_soon, SHOWN_EVERY_MS, self._show),
            (self._keep_soon, KEPT_AFTER_MS, self._keep),
        ):
            timer.setSingleShot(True)
            timer.setInterval(wait_ms)
            timer.timeout.connect(call)
        panel.look_wanted.connect(self.see)
        panel.mirror_wanted.connect(lambda key: self._put(KeptLook(self._current().look, key)))
        panel.picture_wanted.connect(self.use_picture)
        panel.view_reset_wanted.connect(self.reset_view)
        panel.all_reset_wanted.connect(self.reset_all)
        mouse.turned.connect(lambda right, down: self.see(self.look.turned(right, down)))
        mouse.panned.connect(lambda right, down: self.see(self.look.panned(right, down)))
        mouse.zoomed.connect(lambda factor, *at: self.see(self.look.zoomed(factor, *at)))
        mouse.reset_wanted.connect(self.reset_view)
        self._window.mirror_box.toggled.connect(lambda _: self._show())
        controller.avatar_changed.connect(lambda _: self._enter_avatar())
        # The avatar of the last time is chosen when the first source is played.
        controller.source_changed.connect(lambda _: self._enter_avatar())
        controller.scene.painted.connect(self._on_painted)
        controller.ending.connect(self._on_ending)

    def _fill_menu(self, menu: QMenu) -> None:
        """Offer the framings and the way back, for hands that stay on the keyboard."""
        reset = menu.addAction("&Reset view")
        reset.setShortcut("Ctrl+0")
        reset.triggered.connect(lambda: self.reset_view())
        for choice in FRAMING_CHOICES:
            framing = menu.addAction(choice.text)
            framing.triggered.connect(partial(self._frame, choice.key))

    def _frame(self, framing: str) -> None:
        self.see(self.look.seen_as_at_first().changed(framing=framing))

    def _current(self) -> KeptLook:
        return self._kept.get(self._avatar, KeptLook())

    def _put(self, kept: KeptLook) -> None:
        self._kept[self._avatar] = kept
        self.panel.show_look(kept.look, kept.mirror)
        self._keep_soon.start()
        if not self._show_soon.isActive():
            self._show_soon.start()

    def _enter_avatar(self) -> None:
        """See the avatar that plays now as it was seen last."""
        self._avatar = self._controller.scene.avatar
        background = self._current().look.background
        if background.kind == "picture" and background.picture != self._wanted_picture:
            # The file may be gone since the last time.
            self.use_picture(background.picture)
        self._show()

    def _show(self) -> None:
        kept, look = self._current(), self.look
        background = look.background
        self._window.avatar_pane.picture.set_checkered(background.kind == "transparent")
        self.panel.show_look(kept.look, kept.mirror)
        self._controller.scene.look(look)

    def _keep(self) -> None:
        save_looks(self._kept)

    # -- pictures ------------------------------------------------------------------------

    def _on_picture_read(self, found: tuple[str, str]) -> None:
        avatar, path = found
        if path != self._wanted_picture:
            return
        self._take_back()
        kept = self._kept.get(avatar, KeptLook())
        background = kept.look.background.changed(kind="picture", picture=path)
        # Another avatar may have come in meanwhile.
        self._kept[avatar] = KeptLook(kept.look.changed(background=background), kept.mirror)
        self._put(self._current())

    def _on_picture_failed(self, error: CoreError | AppError) -> None:
        """Tell what is wrong with the file; the background before stays."""
        self._window.message_bar.tell(str(error))
        self._told = self._window.message_bar.text
        self.panel.background.show_current()

    def _take_back(self) -> None:
        """Say no more what was wrong with a picture that nobody wants now."""
        if self._told and self._window.message_bar.text == self._told:
            self._window.message_bar.tell("")
        self._told = ""

    # -- drawing -------------------------------------------------------------------------

    def _on_painted(self, painted: Painted) -> None:
        if painted.drawn != self._drawn:
            self._drawn = painted.drawn
            self.panel.show_quality(quality_text(painted.drawn), not painted.drawn.software)

    def _on_ending(self) -> None:
        for job in self.findChildren(Job):
            job.cancel()
        if self._keep_soon.isActive():
            self._keep_soon.stop()
            self._keep()


def quality_text(drawn: Drawn) -> str:
    """Return how well a picture was drawn, for people."""
    if drawn.scale < 1:
        return f"Drawn at {100 * drawn.scale:.0f} % of its size for now, to keep up."
    if drawn.software:
        return IN_SOFTWARE
    return f"Drawn with {drawn.samples} samples per pixel." if drawn.samples else ""


def _read(avatar: str, path: str) -> Generator[Progress, None, tuple[str, str]]:
    """Read a picture file away from the window's thread; return what is given if it can be used.

    Raises:
        PictureFileError: It cannot.
    """
    yield Progress(0, 1, "Reading the picture")
    load_picture(path)
    return avatar, path
