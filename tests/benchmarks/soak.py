"""Hours in short: the live window plays on and on; memory, threads and frames are watched.

    python -m tests.benchmarks.soak [--minutes 10] [--source performer:talking] [--profile NAME]

Every minute another avatar is chosen, and the profile let go and taken up again. Printed every
half minute: memory, threads, frames. In the end: how memory grows once every avatar was seen and
the first third is over, in which caches fill (so play five minutes at least), whether a thread was
lost or left over, and the rate. The exit code is 1 if memory grew by more than 1 MB a minute, or a
thread was missing or is left.
"""

import argparse
import os
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import numpy as np
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication

import app  # noqa: F401  sets what numba and OpenBLAS read at their first import
from app.controllers.desk import open_desk
from app.controllers.live import LiveController
from app.controllers.toolbox import Toolbox
from app.views.live_actions import OVERLAYS
from app.views.live_window import LiveWindow

LOOK_EVERY_S, SWITCH_EVERY_S = 5.0, 60.0
PRINT_EVERY = 6
AVATARS = ("nora", "leo")
MOST_MB_PER_MINUTE = 1.0
#: Threads that must be there in every look: they solve and draw.
NEEDED = ("LiveLoop", "render")


@dataclass(frozen=True, slots=True)
class Look:
    """What was seen at one moment.

    Attributes:
        at_s: Since the beginning.
        memory_mb: Resident.
        frames: Solved so far.
        threads: Of the process.
        missing: Needed ones that are not there.
    """

    at_s: float
    memory_mb: float
    frames: int
    threads: int
    missing: tuple[str, ...]


class Soak:
    """Plays, switches and looks, by timers of the window's thread."""

    def __init__(self, source: str, profile: str, minutes: float) -> None:
        self.window, self.controller = open_desk(Toolbox())
        self.source, self.profile, self.looks, self.n_frames = source, profile, list[Look](), 0
        self._switches, self._began_s = 0, 0.0
        self.controller.add_listener(self._count)
        self._looking, self._switching = QTimer(), QTimer()
        self._looking.timeout.connect(self._look)
        self._switching.timeout.connect(self._switch)
        begin(self.window, self.controller, source, profile)
        self.window.closing.connect(self._looking.stop)
        self._wait = QTimer()
        self._wait.timeout.connect(lambda: self._begin(minutes))
        self._wait.start(100)

    def _begin(self, minutes: float) -> None:
        if not self.window.avatar_pane.has_picture:
            return
        self._wait.stop()
        self._began_s = time.perf_counter()
        self._looking.start(round(1000 * LOOK_EVERY_S))
        self._switching.start(round(1000 * SWITCH_EVERY_S))
        QTimer.singleShot(round(60_000 * minutes), self.window.close)

    def _count(self, *_: object) -> None:
        self.n_frames += 1

    def _look(self) -> None:
        names = " ".join(thread_names())
        missing = tuple(name for name in NEEDED if name not in names)
        at_s = time.perf_counter() - self._began_s
        look = Look(at_s, memory_mb(), self.n_frames, len(thread_names()), missing)
        self.looks.append(look)
        if len(self.looks) % PRINT_EVERY == 0:
            row = self.window.status
            print(f"{at_s / 60:5.1f} min  {look.memory_mb:7.1f} MB  {look.threads} threads  "
                  f"{look.frames} frames  {row.field('rate')}  {row.field('latency')}  "
                  f"{row.field('dropped')}  {row.state}", flush=True)  # fmt: skip

    def _switch(self) -> None:
        self._switches += 1
        self.window.avatar_chosen.emit(AVATARS[self._switches % len(AVATARS)])
        if self.profile:
            self.window.profile_chosen.emit(self.profile if self._switches % 2 == 0 else "")


def main() -> int:
    """Play; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--source", default="performer:talking")
    parser.add_argument("--profile", default="", help="default: training-free")
    args = parser.parse_args()
    application = QApplication(sys.argv[:1])
    soak = Soak(args.source, args.profile, args.minutes)
    application.exec()
    return report(soak.looks)


def begin(window: LiveWindow, controller: LiveController, source: str, profile: str) -> None:
    """Show the window and let it play, with all overlays."""
    window.resize(1280, 720)
    window.show()
    for key in OVERLAYS:
        window.deeds[key].setChecked(True)
    controller.start()
    window.avatar_chosen.emit(AVATARS[0])
    window.take(source)
    window.profile_chosen.emit(profile)


def report(looks: list[Look]) -> int:
    """Print what became of memory and threads; return 1 if one is not as it should be."""
    # Each avatar that is seen for the first time takes its 50 MB.
    settled_s = max(looks[-1].at_s / 3, (len(AVATARS) + 0.2) * SWITCH_EVERY_S)
    settled = [look for look in looks if look.at_s >= settled_s] or looks[-1:]
    minutes = np.array([look.at_s for look in settled]) / 60
    memory = np.array([look.memory_mb for look in settled])
    slope = float(np.polyfit(minutes, memory, 1)[0]) if len(settled) > 1 else 0.0
    missing = sorted({name for look in looks for name in look.missing})
    left = [thread.name for thread in threading.enumerate() if lives_on(thread)]
    print(f"memory: {memory[0]:.1f} -> {memory[-1]:.1f} MB, {slope:+.2f} MB a minute")
    print(f"frames: {looks[-1].frames / looks[-1].at_s:.1f} a second")
    print(f"threads missing: {missing or 'none'}; left after closing: {left or 'none'}")
    return int(slope > MOST_MB_PER_MINUTE or bool(missing) or bool(left))


def lives_on(thread: threading.Thread) -> bool:
    """Return whether it is a thread of ours that should have ended."""
    ours = not isinstance(thread, threading._DummyThread)
    return ours and thread is not threading.main_thread() and thread.is_alive()


def memory_mb() -> float:
    """Return the resident memory of this process; on Linux only."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def thread_names() -> list[str]:
    """Return the names of all threads, Qt's and Python's."""
    names = [path.read_text().strip() for path in Path("/proc/self/task").glob("*/comm")]
    return names + [thread.name for thread in threading.enumerate()]


if __name__ == "__main__":
    sys.exit(main())
