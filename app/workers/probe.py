"""Measures how long the window's thread works at a stretch: what keeps it makes it stutter."""

import time
from dataclasses import dataclass

from PySide6.QtCore import QAbstractEventDispatcher, QObject, Qt, QTimer

#: How often the clock is looked at for gaps.
BEAT_MS = 8


@dataclass(frozen=True, slots=True)
class Spell:
    """One turn of the event loop: what it did between two waits.

    Attributes:
        cpu_ms: Processor time of the thread; waiting and other programs do not count.
        ended_s: When it ended, on the clock of time.perf_counter.
    """

    cpu_ms: float
    ended_s: float


class GuiProbe(QObject):
    """Listens to the event loop of the thread that it is made in, from `start` to `stop`.

    Attributes:
        spells: All turns of the loop.
        gap_ms: The longest time in which the loop did nothing that was due. Unlike the processor
            time it also tells of waiting for Python's lock, and of other programs.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.spells: list[Spell] = []
        self.gap_ms = 0.0
        self._cpu_s, self._beat_s = 0.0, 0.0
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.setInterval(BEAT_MS)
        self._timer.timeout.connect(self._on_beat)

    def start(self) -> None:
        """Forget what was measured, and measure."""
        self.reset()
        QAbstractEventDispatcher.instance().aboutToBlock.connect(self._on_about_to_block)
        self._timer.start()

    def reset(self) -> None:
        """Forget what was measured."""
        self.spells, self.gap_ms = [], 0.0
        self._cpu_s, self._beat_s = time.thread_time(), time.perf_counter()

    def stop(self) -> None:
        """Measure no more."""
        QAbstractEventDispatcher.instance().aboutToBlock.disconnect(self._on_about_to_block)
        self._timer.stop()

    def worst_cpu_ms(self) -> float:
        """Return the processor time of the busiest turn of the loop, 0 without any."""
        return max((spell.cpu_ms for spell in self.spells), default=0.0)

    def _on_about_to_block(self) -> None:
        # A thread that waits uses no processor: all since the last wait was work.
        cpu_s = time.thread_time()
        self.spells.append(Spell(1000 * (cpu_s - self._cpu_s), time.perf_counter()))
        self._cpu_s = cpu_s

    def _on_beat(self) -> None:
        now_s = time.perf_counter()
        self.gap_ms = max(self.gap_ms, 1000 * (now_s - self._beat_s) - BEAT_MS)
        self._beat_s = now_s
