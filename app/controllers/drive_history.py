"""States of the drive that can be gone back to."""

from collections import deque

from app.drive_files import Kept

#: Changes of one setting within this time are taken back together.
ONE_CHANGE_S = 2.0
MOST_STATES = 100


class DriveHistory:
    """Remembers what was before each change; a slider on the move is one change."""

    def __init__(self) -> None:
        self._states: deque[tuple[str, Kept]] = deque(maxlen=MOST_STATES)
        self._last, self._last_s = "", 0.0

    @property
    def next(self) -> str:
        """What would be taken back, empty if nothing can be."""
        return self._states[-1][0] if self._states else ""

    def remember(self, what: str, before: Kept, now_s: float) -> None:
        """Remember the state before a change.

        Args:
            what: Is changed.
            before: The state.
            now_s: On any clock that goes on.
        """
        if what != self._last or now_s - self._last_s > ONE_CHANGE_S:
            self._states.append((what, before))
        self._last, self._last_s = what, now_s

    def back(self) -> Kept | None:
        """Return the state before the last change and forget it; None if there is none."""
        self._last = ""
        return self._states.pop()[1] if self._states else None

    def clear(self) -> None:
        """Forget all states: they are another profile's."""
        self._states.clear()
        self._last = ""
