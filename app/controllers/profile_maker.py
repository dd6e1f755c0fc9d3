"""Makes profiles in the background, one at a time."""

import time
from collections.abc import Callable, Generator
from dataclasses import dataclass

from PySide6.QtCore import QObject, Signal

from app.controllers.progress import remaining_text
from app.workers.job import Job
from core.records import Progress


@dataclass(frozen=True, slots=True)
class MadeProfile:
    """A profile that was made and kept.

    Attributes:
        name: Of the profile.
        text: How good it is and what its maker should know, for people.
    """

    name: str
    text: str


class ProfileMaker(QObject):
    """Runs the steps that make a profile and tells how far they are."""

    progressed = Signal(str, int)  # what is done and how long it takes, percent
    noted = Signal(object)  # Progress, with what may be plotted
    made = Signal(object)  # what the steps return: MadeProfile, or a text for people
    failed = Signal(object)  # CoreError or AppError
    finished = Signal()  # in any case, also after a cancel or an error of the program

    def __init__(
        self, parent: QObject | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__(parent)
        self._clock = clock
        self._job: Job | None = None

    @property
    def busy(self) -> bool:
        """Whether a profile is being made."""
        return self._job is not None

    def start(self, steps: Generator[Progress, None, object]) -> None:
        """Begin; only while not busy."""
        self._started_s = self._clock()
        self._cancelled = False
        self._job = Job(steps, self)
        self._job.progressed.connect(self._on_progressed)
        self._job.returned.connect(self.made)
        self._job.failed.connect(self.failed)
        self._job.finished.connect(self._on_finished)
        self._job.start()

    def cancel(self) -> None:
        """Ask for an end, which comes after the step being made."""
        if self._job is not None:
            self._cancelled = True
            self._job.requestInterruption()

    def stop(self) -> None:
        """Ask for an end and wait for it."""
        if self._job is not None:
            self._cancelled = True
            self._job.cancel()
            self._on_finished()

    def _on_progressed(self, progress: Progress) -> None:
        if self._cancelled:
            return
        share = min(max(progress.done / max(progress.total, 1), 0.0), 1.0)
        left = remaining_text(share, self._clock() - self._started_s)
        text = f"{progress.label}, {left}" if left else progress.label
        self.progressed.emit(text, round(100 * share))
        self.noted.emit(progress)

    def _on_finished(self) -> None:
        if self._job is None or not self._job.isFinished():
            return
        self._job.wait()
        self._job.deleteLater()
        self._job = None
        self.finished.emit()
