"""Starts the live window: what is to be seen first, then all that takes a while to load.

Loading numba, the models' code and the panels' takes more than a second. The window does not wait
for it, and answers meanwhile.
"""

import gc
from collections.abc import Generator
from contextlib import suppress
from threading import Thread
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QByteArray, QObject, Signal

from app.errors import AppError
from app.views.live_window import LiveWindow
from app.window_file import load_window
from app.workers.job import Job
from core.errors import CoreError
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
        self._closed = False
        kept = load_window()
        if kept.geometry:
            window.restoreGeometry(QByteArray.fromBase64(kept.geometry.encode("ascii", "replace")))
        window.source_pane.say(STARTING)
        window.closing.connect(self._on_closing)
        self._loaded = Loaded()
        self._job = Job(self._loaded.steps(), self)
        self._job.returned.connect(self._on_loaded)
        self._job.start()

    def _on_loaded(self) -> None:
        # The signal may have been under way when the window was closed.
        if self._closed:
            return
        # Python's collector would look through all that was loaded again and again, for 100 ms.
        gc.freeze()
        self.controller = self._loaded.furnish(self._window, self._loaded.tools)
        self.controller.start()
        self.ready.emit(self.controller)

    def _on_closing(self) -> None:
        self._closed = True
        self._job.cancel()
        self._loaded.wait()


class Loaded:
    """What the window needs, after the last of `steps`.

    Attributes:
        tools: The toolbox; its models are being loaded or are there.
        furnish: Joins window and tools.
    """

    def __init__(self) -> None:
        self.tools: Any = None
        self.furnish: Any = None
        self._models: Thread | None = None

    def steps(self) -> Generator[Progress, None, None]:
        """Import all; reading the models needs little of Python, and goes on beside it."""
        yield Progress(0, 2, "Loading the tracker")
        from app.controllers.toolbox import Toolbox

        self.tools = Toolbox()
        self._models = Thread(target=self._load_models, name="models", daemon=True)
        self._models.start()
        yield Progress(1, 2, "Loading the panels")
        from app.controllers.desk import furnish

        self.furnish = furnish

    def wait(self) -> None:
        """Wait for the end of what goes on beside."""
        if self._models is not None:
            self._models.join()

    def _load_models(self) -> None:
        # Who opens the first source meets the same error, and tells it.
        with suppress(AppError, CoreError, OSError):
            self.tools.models()
