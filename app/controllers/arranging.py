"""How the window is laid out: done as the menu View says, and remembered between starts."""

from functools import partial

from PySide6.QtCore import QByteArray, QObject, Qt

from app.controllers.live import LiveController
from app.views.avatar_window import AvatarWindow
from app.views.live_window import LiveWindow
from app.views.picture_view import image_from_array
from app.window_file import WindowSettings, load_window, save_window
from app.workers.avatar_loop import Painted

#: Switches that are off at every start: nobody wants to be met by them.
FLEETING = ("full", "pause")
#: Switches that say how something is, rather than how the window looks; they are set elsewhere.
SET_ELSEWHERE = ("mirror", "loop", *FLEETING)


class Arranging(QObject):
    """Shows, hides and moves what the user wants; keeps it when the window closes."""

    def __init__(self, controller: LiveController, window: LiveWindow) -> None:
        super().__init__(controller)
        self._controller, self._window = controller, window
        self.avatar_window: AvatarWindow | None = None
        self._avatar_place: list[int] = []
        self._connect()
        controller.ending.connect(self._on_ending)

    def restore(self) -> None:
        """Lay the window out as the user left it; all panels must have been added."""
        kept = load_window()
        self._avatar_place = kept.avatar_place
        if kept.geometry:
            self._window.restoreGeometry(_bytes(kept.geometry))
        if kept.panels:
            self._window.restoreState(_bytes(kept.panels))
            self._window.panels.tidy()
        if kept.swapped:
            self._window.pair.swap()
        for key, on in kept.switches.items():
            if key in self._switches():
                self._window.deeds[key].setChecked(on)

    def settings(self) -> WindowSettings:
        """Return how the window is laid out now."""
        window, wanted = self._window, self._controller.wanted
        return WindowSettings(
            geometry=_text(window.saveGeometry()),
            panels=_text(window.saveState()),
            switches={key: window.deeds.on(key) for key in self._switches()},
            swapped=window.pair.swapped,
            avatar_place=self._place(),
            source=wanted.source if wanted.source.startswith("camera") else "",
            profile=wanted.profile,
            avatar=self._controller.scene.avatar,
            invited=self._controller.inviting.declined,
        )

    def _switches(self) -> list[str]:
        deeds = self._window.deeds
        return [key for key in deeds.switches if key not in SET_ELSEWHERE]

    def _connect(self) -> None:
        deeds, window = self._window.deeds, self._window
        for name in ("source", "avatar"):
            deeds[name].toggled.connect(partial(window.pair.show_pane, name))
        deeds["full"].toggled.connect(window.show_bare)
        deeds["alone"].toggled.connect(self._show_alone)
        deeds["top"].toggled.connect(self._show_on_top)
        deeds["swap"].triggered.connect(lambda _: window.pair.swap())
        window.pair.shown.connect(lambda name, shown: deeds[name].setChecked(shown))
        self._controller.scene.painted.connect(self._on_painted)

    def _on_painted(self, painted: Painted) -> None:
        if self.avatar_window is not None and self.avatar_window.isVisible():
            self.avatar_window.show_picture(image_from_array(painted.picture))

    # -- the avatar's own window ---------------------------------------------------------

    def _show_alone(self, on: bool) -> None:
        if not on:
            if self.avatar_window is not None:
                self.avatar_window.close()
            return
        if self.avatar_window is None:
            self.avatar_window = self._make_avatar_window()
        self.avatar_window.show()

    def _make_avatar_window(self) -> AvatarWindow:
        deeds, made = self._window.deeds, AvatarWindow()
        made.addActions([deeds[key] for key in ("top", "mirror", "bars", "alone")])
        made.show_on_top(deeds.on("top"))
        made.closed.connect(self._on_alone_closed)
        if len(self._avatar_place) == 4:
            made.setGeometry(*self._avatar_place)
        return made

    def _on_alone_closed(self) -> None:
        self._avatar_place = self._place()
        self._window.deeds["alone"].setChecked(False)

    def _place(self) -> list[int]:
        if self.avatar_window is None:
            return self._avatar_place
        place = self.avatar_window.geometry()
        return [place.x(), place.y(), place.width(), place.height()]

    def _show_on_top(self, on: bool) -> None:
        """Keep the window, or while it is shown the avatar's own one, above all others."""
        window = self._window
        if self.avatar_window is not None:
            self.avatar_window.show_on_top(on)
        if on != bool(window.windowFlags() & Qt.WindowType.WindowStaysOnTopHint):
            visible = window.isVisible()
            window.setWindowFlag(Qt.WindowType.WindowStaysOnTopHint, on)
            window.setVisible(visible)

    def _on_ending(self) -> None:
        save_window(self.settings())
        if self.avatar_window is not None:
            self.avatar_window.closed.disconnect(self._on_alone_closed)
            self.avatar_window.close()


def _text(content: QByteArray) -> str:
    return bytes(content.toBase64().data()).decode("ascii")


def _bytes(text: str) -> QByteArray:
    return QByteArray.fromBase64(QByteArray(text.encode("ascii", "replace")))
