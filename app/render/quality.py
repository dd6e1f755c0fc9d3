"""How well pictures are drawn: less where they take too long, more again when there is time."""

from collections import deque
from dataclasses import dataclass
from statistics import median


@dataclass(frozen=True, slots=True)
class Quality:
    """How a picture is drawn.

    Attributes:
        scale: Share of the picture's width and height at which the figure is drawn.
        samples: Most samples per pixel.
    """

    scale: float = 1.0
    samples: int = 8


@dataclass(frozen=True, slots=True)
class Drawn:
    """How a picture was drawn.

    Attributes:
        scale: Share of its width and height at which the figure was drawn.
        samples: Per pixel; 0 where edges were smoothed afterwards.
        software: The processor drew it, not a graphics card.
        making: It shows the avatar before, while the wished one is made.
    """

    scale: float = 1.0
    samples: int = 0
    software: bool = False
    making: bool = False


#: From the best down, where a graphics card averages samples, and where the processor draws.
ON_CARD = (Quality(), Quality(1.0, 2), Quality(1.0, 0), Quality(0.75, 0))
IN_SOFTWARE = (Quality(), Quality(0.8), Quality(0.65))


class Ladder:
    """Steps down soon and up late; one that fell back at once waits longer each time."""

    #: A picture at 30 per second has 33 ms, and the solver needs its part.
    SLOW_MS = 18.0
    #: Below this a better picture is likely to be in time as well: the next step costs at most
    #: 1.6 times as much.
    QUICK_MS = 9.0
    #: Pictures that are looked at, and how many must be quick before a step up is tried.
    LOOKED_AT, PATIENCE, MOST_PATIENCE = 15, 90, 1800

    def __init__(self, steps: tuple[Quality, ...]) -> None:
        """Begin with the best step."""
        self._steps, self._at = steps, 0
        self._times_ms: deque[float] = deque(maxlen=self.LOOKED_AT)
        self._quick, self._patience, self._since_up = 0, self.PATIENCE, self.MOST_PATIENCE

    @property
    def quality(self) -> Quality:
        """How the next picture is to be drawn."""
        return self._steps[self._at]

    def count(self, took_ms: float) -> None:
        """Learn what the last picture took; may change `quality`."""
        self._times_ms.append(took_ms)
        self._since_up += 1
        if len(self._times_ms) < self.LOOKED_AT:
            return
        usual_ms = median(self._times_ms)
        self._quick = self._quick + 1 if usual_ms < self.QUICK_MS else 0
        if usual_ms > self.SLOW_MS:
            self._down()
        elif self._quick >= self._patience and self._at > 0:
            self._move(self._at - 1)
            self._since_up = 0

    def _down(self) -> None:
        if self._at == len(self._steps) - 1:
            return
        fell_back = self._since_up < 2 * self.PATIENCE
        longer = min(2 * self._patience, self.MOST_PATIENCE)
        self._patience = longer if fell_back else self.PATIENCE
        self._move(self._at + 1)

    def _move(self, to: int) -> None:
        self._at, self._quick = to, 0
        self._times_ms.clear()
