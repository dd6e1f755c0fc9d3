"""A performer who does what the guided setup asks for: a camera for those who have none."""

from dataclasses import replace
from threading import Lock

from app.capture.source import ClosedOnExit
from app.performer.opening import SETUP, Scenario, open_performer
from app.performer.pacing import Pacer
from app.performer.performer import FPS
from app.performer.prompts import HOLD_S, MOVE_S, setup_take
from core.records import Camera, Frame

#: The performer needs a moment to read a prompt.
READ_S = 0.3


class PromptedPerformer(ClosedOnExit):
    """Plays the piece of a setup session that belongs to a prompt, and stays in its last pose.

    A live FrameSource; `follow` may be called from any thread.
    """

    fps = FPS
    live = True

    def __init__(self, scenario: Scenario | None = None, stride: int = 0) -> None:
        """Prepare to perform.

        Args:
            scenario: Who and where; its take does not matter.
            stride: 0 lets frames come by the clock. Else they come as fast as they are read, this
                many of 30 in a second from one to the next.
        """
        scenario = replace(scenario or Scenario(), take=SETUP)
        session = setup_take(scenario.seed)
        self._film = open_performer(scenario)
        self._holds = {
            name: round(float(time_s) * FPS)
            for name, time_s in zip(session.names, session.times_s, strict=True)
        }
        self.name = f"virtual performer ({scenario.person}, follows the prompts)"
        self.size_px = self._film.size_px
        self._pacer, self._stride = None if stride else Pacer(FPS), stride
        self._lock = Lock()
        self._index, self._wanted = 0, 0
        self._asked_index, self._from = 0, 0

    @property
    def camera(self) -> Camera:
        """The true camera of the pictures."""
        return self._film.camera

    def follow(self, name: str) -> None:
        """Do what a shot's prompt asks for."""
        with self._lock:
            hold = self._holds[name]
            if hold != self._wanted:
                self._asked_index, self._wanted = self._index, hold
                # The move into this pose begins where the pose before is held.
                self._from = max(hold - round((MOVE_S + HOLD_S) * FPS), 0)

    def read(self) -> Frame | None:
        """Return the next frame."""
        index = self._index if self._pacer is None else self._pacer.next_index()
        with self._lock:
            self._index = index + max(self._stride, 1)
            shown = self._shown(index)
        frame = self._film.picture(shown)
        return Frame(frame.rgb, frame.gray, index / FPS, index)

    def close(self) -> None:
        """Free the renderer."""
        self._film.close()

    def _shown(self, index: int) -> int:
        """Return which frame of the session is to be seen."""
        passed = index - self._asked_index - round(READ_S * FPS)
        return min(self._from + max(passed, 0), self._wanted)
