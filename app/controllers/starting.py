"""Starts the live window: what is to be seen first, then all that takes a while to load.

Loading numba, the models' code and the panels' takes more than a second. The window does not wait
for it, and answers meanwhile.
"""

import gc
from collections.abc import Generator
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QByteArray, QObject, Signal

from app.views.live_window import LiveWindow
from app.window_file import load_window
from app.workers.job import Job
from core.records import Progress

if TYPE_CHECKING:
    from app.controllers.live import LiveController

STARTING = "Starting…"


class Starting(QObject):
    """Loads the controllers in the background and joins them with the window.

    Attributes:
        controller: Of the window, None while it is being loaded.
    """

    ready = Signal(object)  # LiveController, started

    def __init__(self, window: LiveWindow) -> None:
        """Begin; the window may be shown before or after."""
        super().__init__(window)
        self._window = window
        self.controller: LiveController | None = None
        kept = load_window()
        if kept.geometry:
            window.restoreGeometry(QByteArray.fromBase64(kept.geometry.encode("ascii", "replace")))
        window.source_pane.say(STARTING)
        window.avatar_pane.say("")
        window.closing.connect(self._on_closing)
        self._job = Job(_loading(), self)
        self._job.returned.connect(self._on_loaded)
        self._job.start()

    def _on_loaded(self, modules: tuple[Any, Any]) -> None:
        desk, toolbox = modules
        # Python's collector would look through all that was loaded again and again, for 100 ms.
        gc.freeze()
        self.controller = desk.furnish(self._window, toolbox.Toolbox())
        self.controller.start()
        self.ready.emit(self.controller)

    def _on_closing(self) -> None:
        self._job.cancel()


def _loading() -> Generator[Progress, None, tuple[Any, Any]]:
    """Import what the window needs, in the thread that asks."""
    yield Progress(0, 2, "Loading the tracker")
    from app.controllers import toolbox

    yield Progress(1, 2, "Loading the panels")
    from app.controllers import desk

    return desk, toolbox
