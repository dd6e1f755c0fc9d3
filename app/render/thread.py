"""Draws in a thread of its own, always the newest wish."""

import logging
from collections.abc import Callable
from threading import Condition, Thread
from typing import Generic, TypeVar

from app.errors import AppError
from app.render.renderer import Renderer

Wish = TypeVar("Wish")
Result = TypeVar("Result")

_LOG = logging.getLogger(__name__)


class RenderThread(Thread, Generic[Wish, Result]):
    """Owns a renderer; takes wishes from any thread and hands back what was made of them.

    The mailbox has one place: a picture that is late is worthless, so a new wish replaces one
    that is still waiting. `done` and `failed` are called in this thread; a Qt program emits a
    queued signal there.
    """

    def __init__(
        self,
        make: Callable[[Renderer], Callable[[Wish], Result]],
        done: Callable[[Result], None],
        failed: Callable[[AppError], None],
    ) -> None:
        """Prepare the thread; `start` starts it.

        Args:
            make: Called once with the renderer; returns what draws a wish.
            done: Gets each result.
            failed: Gets the error, after which the thread ends, if this machine cannot draw or
                a wish's files cannot be used.
        """
        super().__init__(name="render", daemon=True)
        self._make, self._done, self._failed = make, done, failed
        self._changed = Condition()
        self._wish: Wish | None = None
        self._stopping = False

    def ask(self, wish: Wish) -> None:
        """Wish for a picture; an older wish that has not been drawn is forgotten."""
        with self._changed:
            self._wish = wish
            self._changed.notify()

    def stop(self) -> None:
        """End the thread after the picture it is drawing, and wait for that."""
        with self._changed:
            self._stopping = True
            self._changed.notify()
        self.join()

    def run(self) -> None:
        """Draw until stopped; called by Thread."""
        try:
            renderer = Renderer()
        except AppError as error:
            self._failed(error)
            return
        try:
            draw = self._make(renderer)
            while (wish := self._next()) is not None:
                self._done(draw(wish))
        except AppError as error:
            self._failed(error)
        finally:
            renderer.release()
            _LOG.debug("render thread ends")

    def _next(self) -> Wish | None:
        """Return the newest wish, waiting for one; None when stopped."""
        with self._changed:
            while self._wish is None and not self._stopping:
                self._changed.wait()
            wish, self._wish = self._wish, None
            return None if self._stopping else wish
