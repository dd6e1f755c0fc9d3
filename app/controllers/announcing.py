"""What is heard and flashed while pictures are taken: who turns away does not see the screen."""

from dataclasses import replace
from typing import Protocol

from app.views.setup.guide_view import Guide
from core.shutter import ShutterState

#: Frames for which the picture flashes, and for which it says what came of it.
FLASH_FRAMES, NEWS_FRAMES = 8, 45
#: Between two sounds that say to hold still.
HOLD_AGAIN_S = 1.0


class Speaker(Protocol):
    """What is needed of the speaker."""

    muted: bool

    def play(self, name: str) -> None:
        """Play a sound."""
        ...

    def close(self) -> None:
        """End what is being played."""
        ...


class Announcer:
    """Says that a picture was taken, and how it is, by sound and on the screen."""

    def __init__(self, speaker: Speaker) -> None:
        self._speaker = speaker
        self._flash = self._told = 0
        self._news, self._good = "", True
        self._lost, self._holding, self._held_s = False, False, float("-inf")

    @property
    def heard(self) -> bool:
        """Whether there are sounds."""
        return not self._speaker.muted

    def hear(self, heard: bool) -> None:
        """Have sounds or none."""
        self._speaker.muted = not heard

    def stop(self) -> None:
        """Be silent at once."""
        self._speaker.close()

    def taken(self, why_weak: str, last: bool) -> None:
        """Say that a picture was taken.

        Args:
            why_weak: Why it is weak, "" if it is good.
            last: Whether it was the last one.
        """
        self._flash, self._told, self._good = FLASH_FRAMES, NEWS_FRAMES, not why_weak
        self._news = f"! {why_weak} – Backspace takes it again" if why_weak else "✓ Taken"
        self._speaker.play("done" if last else "weak" if why_weak else "taken")

    def hold(self, shutter: ShutterState, time_s: float) -> None:
        """Say once to hold still when all is right."""
        holding = shutter.phase == "holding"
        if holding and not self._holding and abs(time_s - self._held_s) > HOLD_AGAIN_S:
            self._speaker.play("hold")
            self._held_s = time_s
        self._holding = holding

    def lost(self) -> None:
        """Say once that there is no picture any more."""
        if not self._lost:
            self._speaker.play("trouble")
        self._lost = True

    def back(self) -> None:
        """Know that there are pictures again."""
        self._lost = False

    def with_news(self, guide: Guide) -> Guide:
        """Return what the next frame says, with what came of the last picture."""
        self._flash, self._told = max(self._flash - 1, 0), max(self._told - 1, 0)
        news = self._news if self._told else ""
        return replace(guide, flash=self._flash > 0, news=news, good=self._good)
