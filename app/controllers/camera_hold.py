"""When the chosen camera is asked to hold its settings, and what becomes of it."""

import math
from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from app.capture.holding import Held, told
from app.controllers.previews import Previews
from app.views.setup.camera_page import CameraPage

#: So long all must be well before the camera is told to stay as it is.
GOOD_S = 2.0
#: Troubles that say that the light is not the one that the camera was held at.
LIGHT = frozenset({"dark", "clipped", "backlit", "slow_dark"})
HOLDING, NOT_HELD = "Asking the camera…", "The camera chooses by itself until all is well."
CHANGED = "The light has changed: the camera chooses by itself until all is well again."
NEEDS_NONE = "This source has nothing to hold."


@runtime_checkable
class Holdable(Protocol):
    """A source that can be asked to choose nothing by itself."""

    def hold(self) -> tuple[Held, ...]:
        """Hold exposure, focus and white balance, as far as it goes."""
        ...

    def let_go(self) -> None:
        """Let the camera choose by itself again."""
        ...


class Tools(Protocol):
    """What is needed of the toolbox."""

    def keep_held(self, key: str, held: Sequence[Held]) -> None:
        """Hold a camera so whenever it is opened again for the setup."""
        ...


class Patience:
    """Says when to hold a camera, and when to let go of it because the light has changed."""

    def __init__(self) -> None:
        self.forget()

    @property
    def good(self) -> bool:
        """Whether all has been well for some time."""
        return self._now_s - self._good_since_s >= GOOD_S

    def forget(self) -> None:
        """Begin anew: nothing is held."""
        self._good_since_s, self._now_s, self._held = math.nan, math.nan, False

    def step(self, advice: str, time_s: float) -> str:
        """Return "hold", "let go" or "".

        Args:
            advice: What the user is told now, a key of core.shot_quality.ADVICE or "".
            time_s: Time of the frame.
        """
        if self._held and advice in LIGHT:
            self.forget()
            return "let go"
        self._now_s = time_s
        if advice:
            self._good_since_s = math.nan
        elif math.isnan(self._good_since_s):
            self._good_since_s = time_s
        if self._held or not self.good:
            return ""
        self._held = True
        return "hold"


class CameraHold:
    """Asks the camera of a page, in the thread that reads it, and tells what it answered."""

    def __init__(self, page: CameraPage, previews: Previews, tools: Tools) -> None:
        self._page, self._previews, self._tools = page, previews, tools
        self._patience, self._key, self._wanted = Patience(), "", True
        previews.answered.connect(self._on_answered)

    @property
    def wanted(self) -> bool:
        """Whether cameras are asked at all."""
        return self._wanted

    @property
    def good(self) -> bool:
        """Whether all has been well for some time."""
        return self._patience.good

    def choose(self, key: str) -> None:
        """Let go of the camera before and look after another one; "" after none."""
        if self._key:
            self._let_go()
        self._key = key
        self._patience.forget()
        self._page.show_held(NOT_HELD if self._wanted and key else "")

    def forget(self) -> None:
        """Begin anew with a camera that was lost."""
        self._patience.forget()
        self._page.show_held(NOT_HELD if self._wanted else "")

    def want(self, wanted: bool) -> None:
        """Say whether cameras are to be asked."""
        self._wanted = wanted
        self._page.show_hold(wanted)
        self.choose(self._key)

    def step(self, advice: str, time_s: float) -> None:
        """Take what the user is told now into account."""
        wish = self._patience.step(advice, time_s)
        loop = self._previews.loop(self._key)
        if not self._wanted or not wish or loop is None:
            return
        if wish == "hold":
            self._page.show_held(HOLDING)
            loop.ask(lambda source: source.hold() if isinstance(source, Holdable) else ())
        else:
            self._let_go()
            self._page.show_held(CHANGED)

    def _let_go(self) -> None:
        self._tools.keep_held(self._key, ())
        loop = self._previews.loop(self._key)
        if loop is not None:
            loop.ask(lambda source: source.let_go() if isinstance(source, Holdable) else None)

    def _on_answered(self, key: str, held: tuple[Held, ...] | None) -> None:
        """Tell what the camera made of the wish; None answers that it was let go."""
        if held is not None and key == self._key and self._wanted:
            self._tools.keep_held(key, held)
            self._page.show_held(told(held) if held else NEEDS_NONE)
