"""Keeps the list of takes: read, and completed after a crash, in the background."""

from collections.abc import Generator
from datetime import datetime

from PySide6.QtCore import QObject, QTimer, Signal

from app.takes.completing import SILENT_S, abandoned, recovered, unfinished
from app.takes.library import Take, TakeError, takes
from app.views.takes.record_row import clock
from app.views.takes.take_list import TakeEntry
from app.workers.job import Job
from core.records import Progress

Found = tuple[list[Take], list[Take | TakeError]]


class TakeShelf(QObject):
    """Knows the takes that there are."""

    changed = Signal()
    mended = Signal(list)  # Take or TakeError: recordings that were broken off

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.takes: list[Take] = []
        self._job: Job | None = None
        self._again, self._stopped = False, False
        # Each trouble is told once, although it is looked for again and again.
        self._told: set[str] = set()

    @property
    def busy(self) -> bool:
        """Whether the list is being read."""
        return self._job is not None

    def named(self, name: str) -> Take | None:
        """Return a take by its name, None if there is none."""
        return next((take for take in self.takes if take.name == name), None)

    def refresh(self) -> None:
        """Read the list anew; `changed` tells when that is done. After `stop` nothing is read."""
        self._again = self._job is not None
        if self._job is None and not self._stopped:
            self._job = Job(read_all(), self)
            self._job.returned.connect(self._on_read)
            self._job.finished.connect(self._on_finished)
            self._job.start()

    def stop(self) -> None:
        """End the reading and wait for that."""
        self._again, self._stopped = False, True
        if self._job is not None:
            self._job.cancel()
            self._on_finished()

    def _on_read(self, found: Found) -> None:
        self.takes, everything = found
        self.changed.emit()
        mended = [one for one in everything if str(one) not in self._told]
        self._told |= {str(one) for one in mended if isinstance(one, TakeError)}
        if mended:
            self.mended.emit(mended)
        if unfinished():
            # The program may have been started anew right after it crashed.
            QTimer.singleShot(round(1000 * SILENT_S), self, self.refresh)

    def _on_finished(self) -> None:
        if self._job is None or not self._job.isFinished():
            return
        self._job.wait()
        self._job.deleteLater()
        self._job = None
        if self._again:
            self.refresh()


def read_all() -> Generator[Progress, None, Found]:
    """Complete what a crash left, then read the list."""
    mended: list[Take | TakeError] = []
    if abandoned():
        yield Progress(0, 1, "Completing a take")
        mended = list(recovered())
    yield Progress(1, 1, "Reading the takes")
    return takes(), mended


def entry_of(take: Take) -> TakeEntry:
    """Return what the list says of a take."""
    facts = take.facts
    parts = [clock(facts.seconds)]
    if facts.trim_s is not None:
        parts[0] += f" ({clock(facts.trim_s[1] - facts.trim_s[0])} kept)"
    parts += [date_of(facts.made), facts.profile or "no profile", size_text(take.n_bytes)]
    if take.film is not None:
        parts.append("with video")
    if facts.solved_from:
        parts.append(f"{facts.mode}, from {facts.solved_from}")
    return TakeEntry(take.name, " · ".join(parts))


def date_of(made: str) -> str:
    """Return a date for people; a text that is none as it is."""
    try:
        return datetime.fromisoformat(made).strftime("%d %b %Y %H:%M")
    except ValueError:
        return made


def size_text(n_bytes: int) -> str:
    """Return a size for people."""
    megabytes = n_bytes / 1e6
    if megabytes < 10:
        return f"{megabytes:.1f} MB"
    return f"{megabytes:.0f} MB" if megabytes < 1000 else f"{megabytes / 1000:.1f} GB"
