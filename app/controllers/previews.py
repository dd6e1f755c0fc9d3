"""Keeps several cameras open for their previews, one opened after the other."""

from collections.abc import Callable, Sequence
from functools import partial

from PySide6.QtCore import QObject, Signal

from app.capture.source import FrameSource
from app.errors import AppError
from app.workers.preview_loop import PreviewLoop
from core.errors import CoreError

STOPPED = "the preview stopped by an error of the program; the terminal shows the details"


class Previews(QObject):
    """Opens what is wanted, in that order, and closes the rest.

    Drivers and buses dislike it when two cameras are opened at the same moment, and some cannot
    show two at all: one that fails waits for `retry`.
    """

    shown = Signal(str, object)  # key, Preview
    failed = Signal(str, object)  # key, CoreError or AppError
    answered = Signal(str, object)  # key, what a wish returned

    def __init__(
        self, open_source: Callable[[str], FrameSource], parent: QObject | None = None
    ) -> None:
        """Prepare.

        Args:
            open_source: Opens the source of a key; called in the thread that reads it.
            parent: Of the object.
        """
        super().__init__(parent)
        self._open_source = open_source
        self._wanted: tuple[str, ...] = ()
        self._loops: dict[str, PreviewLoop] = {}
        self._ending: list[PreviewLoop] = []
        self._refused: set[str] = set()
        self._opening = ""

    def loop(self, key: str) -> PreviewLoop | None:
        """Return the thread that reads a source, None if it is not open."""
        return self._loops.get(key)

    def want(self, keys: Sequence[str]) -> None:
        """Have these open from now on, and nothing else."""
        self._wanted = tuple(keys)
        self._refused &= set(keys)
        for key in [key for key in self._loops if key not in keys]:
            self._end(key)
        self._open_next()

    def retry(self) -> None:
        """Try those again that could not be opened or were lost."""
        self._refused.clear()
        self._open_next()

    def stop(self) -> None:
        """Close everything and wait for it."""
        self._wanted = ()
        for loop in (*self._loops.values(), *self._ending):
            loop.requestInterruption()
        for loop in (*self._loops.values(), *self._ending):
            loop.stop()
            loop.deleteLater()
        self._loops.clear()
        self._ending.clear()
        self._refused.clear()
        self._opening = ""

    def _open_next(self) -> None:
        # What ends may hold the device or the bus that the next one needs.
        if self._opening or self._ending:
            return
        for key in self._wanted:
            if key not in self._loops and key not in self._refused:
                self._open(key)
                return

    def _open(self, key: str) -> None:
        loop = PreviewLoop(partial(self._open_source, key), self)
        loop.posted.connect(partial(self._on_posted, key, loop))
        loop.failed.connect(partial(self._on_failed, key, loop))
        loop.answered.connect(partial(self._on_answered, key, loop))
        loop.finished.connect(partial(self._on_finished, key, loop))
        self._loops[key], self._opening = loop, key
        loop.start()

    def _end(self, key: str) -> None:
        loop = self._loops.pop(key)
        self._ending.append(loop)
        loop.requestInterruption()
        self._opened(key)

    def _opened(self, key: str) -> None:
        """Let the next one be opened, if it was this one's turn."""
        if self._opening == key:
            self._opening = ""
            self._open_next()

    def _on_posted(self, key: str, loop: PreviewLoop) -> None:
        preview = loop.previews.take()
        if preview is not None and self._loops.get(key) is loop:
            self.shown.emit(key, preview)
            self._opened(key)

    def _on_answered(self, key: str, loop: PreviewLoop, answer: object) -> None:
        if self._loops.get(key) is loop:
            self.answered.emit(key, answer)

    def _on_failed(self, key: str, loop: PreviewLoop, error: CoreError | AppError) -> None:
        if self._loops.get(key) is loop:
            self._refused.add(key)
            self.failed.emit(key, error)

    def _on_finished(self, key: str, loop: PreviewLoop) -> None:
        if loop in self._ending:
            self._ending.remove(loop)
        elif self._loops.get(key) is loop:
            del self._loops[key]
            if key not in self._refused:
                self._refused.add(key)
                self.failed.emit(key, AppError(STOPPED))
        else:
            # After `stop` the signal of a thread that is gone may still come.
            return
        loop.wait()
        loop.deleteLater()
        self._opened(key)
        self._open_next()
