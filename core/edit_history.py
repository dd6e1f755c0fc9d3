"""Undo and redo without limit, over all pictures of a session."""

from dataclasses import dataclass

from core.records import Landmarks2D


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """One thing that the user did.

    Attributes:
        name: Of the picture.
        label: What was done, for people.
        before: The landmarks.
        after: The landmarks.
    """

    name: str
    label: str
    before: Landmarks2D
    after: Landmarks2D


class EditHistory:
    """The changes of a session in their order; those undone wait to be redone."""

    def __init__(self) -> None:
        self._done: list[Change] = []
        self._undone: list[Change] = []

    @property
    def next_undo(self) -> str:
        """What an undo would take back, "" if there is nothing."""
        return self._done[-1].label if self._done else ""

    @property
    def next_redo(self) -> str:
        """What a redo would do again, "" if there is nothing."""
        return self._undone[-1].label if self._undone else ""

    def add(self, change: Change) -> None:
        """Remember a change; what was undone before it cannot be redone any more."""
        self._done.append(change)
        self._undone.clear()

    def undo(self) -> Change | None:
        """Return the change to take back, None if there is none."""
        if not self._done:
            return None
        self._undone.append(self._done.pop())
        return self._undone[-1]

    def redo(self) -> Change | None:
        """Return the change to do again, None if there is none."""
        if not self._undone:
            return None
        self._done.append(self._undone.pop())
        return self._done[-1]
