"""A mailbox with one place."""

from threading import Lock
from typing import Generic, TypeVar

T = TypeVar("T")


class Latest(Generic[T]):
    """Keeps only the newest value.

    A live picture that is late is worthless, so a new value replaces an unread one and
    a slow reader never makes the writer wait.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._value: T | None = None

    def put(self, value: T) -> bool:
        """Leave a value; return whether the place was empty, so that a reader wants to know."""
        with self._lock:
            was_empty = self._value is None
            self._value = value
            return was_empty

    def take(self) -> T | None:
        """Take the value out; None if nothing came since the last time."""
        with self._lock:
            value, self._value = self._value, None
            return value
