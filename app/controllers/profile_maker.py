"""Makes profiles in the background, one at a time."""

import time
from collections.abc import Callable, Generator
from dataclasses import dataclass

from PySide6.QtCore import QObject, Signal

from app.controllers.progress import remaining_text
from app.workers.job_slot import JobSlot
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
        self._clock, self._cancelled = clock, False
        self._job = JobSlot(self, self.finished.emit)

    @property
    def busy(self) -> bool:
        """Whether a profile is being made."""
        return self._job.busy

    def start(self, steps: Generator[Progress, None, object]) -> None:
        """Begin; only while not busy."""
        self._started_s = self._clock()
        self._cancelled = False
        job = self._job.put(steps)
        job.progressed.connect(self._on_progressed)
        job.returned.connect(self.made)
        job.failed.connect(self.failed)
        job.start()

    def cancel(self) -> None:
        """Ask for an end, which comes after the step being made."""
        self._cancelled = True
        self._job.interrupt()

    def stop(self) -> None:
        """Ask for an end and wait for it."""
        self._cancelled = True
        self._job.stop()

    def _on_progressed(self, progress: Progress) -> None:
        if self._cancelled:
            return
        share = min(max(progress.done / max(progress.total, 1), 0.0), 1.0)
        left = remaining_text(share, self._clock() - self._started_s)
        text = f"{progress.label}, {left}" if left else progress.label
        self.progressed.emit(text, round(100 * share))
        self.noted.emit(progress)
