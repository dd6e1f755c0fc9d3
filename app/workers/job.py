"""Long work in the background: Qt outside, a plain generator inside."""

from collections.abc import Generator
from typing import Any

from PySide6.QtCore import QObject, QThread, Signal

from app.errors import AppError
from core.errors import CoreError
from core.records import Progress


class Job(QThread):
    """Steps a core generator to its end.

    Ends in one of four ways, all followed by QThread's own `finished`: it returned, it failed
    with an error meant for the user, it was cancelled, or it met a bug, which goes to the
    except hook.
    """

    progressed = Signal(object)  # Progress
    returned = Signal(object)  # the record
    failed = Signal(object)  # CoreError or AppError

    def __init__(
        self, steps: Generator[Progress, None, Any], parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._steps = steps

    def run(self) -> None:
        """Step the generator; called by QThread in the new thread."""
        try:
            while not self.isInterruptionRequested():
                self.progressed.emit(next(self._steps))
            self._steps.close()
        except StopIteration as end:
            self.returned.emit(end.value)
        except (CoreError, AppError) as error:
            self.failed.emit(error)

    def cancel(self) -> None:
        """Ask for no more steps and wait until the one being made is done."""
        self.requestInterruption()
        self.wait()
