"""Asks, in the background, who was seen without a profile."""

from collections.abc import Generator

from PySide6.QtCore import QObject, Signal

from app.controllers.player import Performer
from app.workers.job import Job
from core.records import Progress, UserBlendshapes


class Acquainting(QObject):
    """The answer takes some 20 ms of arithmetic, too much for the window's thread."""

    known = Signal(object, object)  # Performer, UserBlendshapes

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._job: Job | None = None
        self._done: Performer | None = None

    def ask(self, performer: Performer | None) -> None:
        """Ask for a performer until it is known; to be called now and then."""
        if performer is None or performer is self._done or self._job is not None:
            return
        self._job = Job(_steps(performer), self)
        self._job.returned.connect(lambda user: self._on_returned(performer, user))
        self._job.finished.connect(self._on_finished)
        self._job.start()

    def stop(self) -> None:
        """Wait for the end of a question."""
        if self._job is not None:
            self._job.cancel()

    def _on_returned(self, performer: Performer, user: UserBlendshapes | None) -> None:
        if user is not None:
            self._done = performer
            self.known.emit(performer, user)

    def _on_finished(self) -> None:
        if self._job is not None and self._job.isFinished():
            self._job.wait()
            self._job.deleteLater()
            self._job = None


def _steps(performer: Performer) -> Generator[Progress, None, UserBlendshapes | None]:
    yield Progress(0, 1, "Getting acquainted")
    return performer.learned()
