"""Loads another profile while the live view goes on with the one before."""

from collections.abc import Generator

from PySide6.QtCore import QObject, Signal

from app.controllers.player import Opener, Performer
from app.errors import AppError
from app.workers.job_slot import JobSlot
from core.errors import CoreError
from core.records import Progress


class ProfileSwitch(QObject):
    """Runs at most one job; of several quick wishes only the last is fulfilled."""

    loaded = Signal(str, object)  # profile, Performer
    failed = Signal(str, object)  # profile, CoreError or AppError

    def __init__(self, opener: Opener, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._opener = opener
        self._job = JobSlot(self, self._load_next)
        self._loading = ""
        self._next: str | None = None
        self._wanted = False

    def load(self, profile: str) -> None:
        """Load a profile, or with an empty name what needs none; the wish before is forgotten."""
        self._next = profile
        self._wanted = False
        if not self._job.busy:
            self._load_next()

    def forget(self) -> None:
        """Drop all wishes; what is being loaded is thrown away."""
        self._next, self._wanted = None, False

    def stop(self) -> None:
        """Drop all wishes and wait for the end."""
        self.forget()
        self._job.stop()

    def _load_next(self) -> None:
        if self._next is None:
            return
        self._loading, self._next = self._next, None
        self._wanted = True
        job = self._job.put(_steps(self._opener, self._loading))
        job.returned.connect(self._on_returned)
        job.failed.connect(self._on_failed)
        job.start()

    def _on_returned(self, performer: Performer) -> None:
        if self._wanted:
            self.loaded.emit(self._loading, performer)

    def _on_failed(self, error: CoreError | AppError) -> None:
        if self._wanted:
            self.failed.emit(self._loading, error)


def _steps(opener: Opener, profile: str) -> Generator[Progress, None, Performer]:
    yield Progress(0, 1, "Loading the profile")
    return opener.open_profile(profile) if profile else opener.open_free()
