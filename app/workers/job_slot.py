"""A place for one job: it is started, waited for and cleared away, and the next one may come."""

from collections.abc import Callable, Generator
from typing import Any

from PySide6.QtCore import QObject

from app.workers.job import Job
from core.records import Progress


class JobSlot(QObject):
    """Holds at most one running job."""

    def __init__(self, parent: QObject, after: Callable[[], None]) -> None:
        """Prepare.

        Args:
            parent: Of this object.
            after: Called when a job has ended, however it did, and the place is free again.
        """
        super().__init__(parent)
        self._after = after
        self._job: Job | None = None

    @property
    def busy(self) -> bool:
        """Whether a job is there."""
        return self._job is not None

    def put(self, steps: Generator[Progress, None, Any]) -> Job:
        """Return a job for steps, which is not started yet; only while not busy."""
        job = self._job = Job(steps, self)
        job.finished.connect(self._on_finished)
        return job

    def interrupt(self) -> None:
        """Ask for an end, which comes after the step being made."""
        if self._job is not None:
            self._job.requestInterruption()

    def stop(self) -> None:
        """Ask for an end, wait for it and free the place."""
        if self._job is not None:
            self._job.cancel()
            self._on_finished()

    def _on_finished(self) -> None:
        # The signal of a job that was stopped may come when it is gone or another one is there.
        if self._job is None or not self._job.isFinished():
            return
        self._job.wait()
        self._job.deleteLater()
        self._job = None
        self._after()
