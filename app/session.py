"""The one place that knows the current record of every stage."""

from typing import Any

from PySide6.QtCore import QObject, Signal

#: In the order in which they are made; each is made from those before it.
STAGES = ("images", "landmarks", "camera", "fit", "user", "shapes", "regressor", "profile")


class Session(QObject):
    """Holds one record per stage.

    A record is valid only for the records it was made from, so replacing one drops
    every later one.
    """

    changed = Signal(str, object)  # stage, its record or None

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._records: dict[str, object | None] = dict.fromkeys(STAGES)

    def get(self, stage: str) -> Any:
        """Return the record of a stage, None if there is none yet.

        Raises:
            KeyError: There is no such stage.
        """
        return self._records[stage]

    def put(self, stage: str, record: object) -> None:
        """Replace the record of a stage and drop those of all later stages.

        Raises:
            ValueError: There is no such stage.
        """
        later = STAGES[STAGES.index(stage) + 1 :]
        self._set(stage, record)
        for name in later:
            if self._records[name] is not None:
                self._set(name, None)

    def _set(self, stage: str, record: object | None) -> None:
        self._records[stage] = record
        self.changed.emit(stage, record)
