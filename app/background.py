"""Makes things in a thread of its own, for a thread that must not wait."""

from collections.abc import Callable, Hashable
from threading import Lock, Thread
from typing import Generic, TypeVar

Key = TypeVar("Key", bound=Hashable)
Made = TypeVar("Made")


class BackgroundMaker(Generic[Key, Made]):
    """Makes what was asked for last; what was asked for meanwhile and is not begun is left out."""

    def __init__(self, make: Callable[[Key], Made]) -> None:
        """Prepare; the thread lives only while there is work.

        Args:
            make: Called in that thread, never twice at the same time.
        """
        self._make, self._lock = make, Lock()
        self._wanted: Key | None = None
        self._busy = False
        self._made: tuple[Key, Made | Exception] | None = None

    def take(self, key: Key) -> Made | None:
        """Return what was made of a key, once; None while that takes time: ask again.

        Raises:
            Exception: What stopped the making.
        """
        with self._lock:
            if self._made is None or self._made[0] != key:
                self._wanted = key
                self._begin()
                return None
            made, self._made = self._made[1], None
        if isinstance(made, Exception):
            raise made
        return made

    def _begin(self) -> None:
        if not self._busy:
            self._busy = True
            Thread(target=self._run, name="making", daemon=True).start()

    def _run(self) -> None:
        while (key := self._next()) is not None:
            made: Made | Exception
            try:
                made = self._make(key)
            except Exception as error:  # noqa: BLE001  # raised where it is asked for
                made = error
            with self._lock:
                self._made = (key, made)
                if self._wanted == key:
                    self._wanted = None

    def _next(self) -> Key | None:
        with self._lock:
            key, self._wanted = self._wanted, None
            self._busy = key is not None
            return key
