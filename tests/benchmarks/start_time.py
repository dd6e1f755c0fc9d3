"""How long after the command the live window is usable.

    python -m tests.benchmarks.start_time [--runs 3] [--source performer:talking]

Starts the window's own code in a process of its own, offscreen, and notes when the window is shown,
when its event loop answers, and when the first pictures of source and avatar are there. Times are
counted from the start of the process; the processor's time is printed beside, since other work on
the machine does not count in it. The first run fills the caches and is not counted.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from statistics import median
from typing import Any

GIVE_UP_S = 120.0
MOMENTS = ("window", "controls", "source", "avatar")


def main() -> None:
    """Run and print the medians."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--source", default="performer:talking", help="as in the window's list")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.inside:
        print(json.dumps(moments(args.source)))
        return
    with tempfile.TemporaryDirectory() as home:
        runs = [started(args.source, home) for _ in range(args.runs + 1)][1:]
    for name in MOMENTS:
        wall_s, cpu_s = (median(run[name][place] for run in runs) for place in (0, 1))
        print(f"{name:10s} {wall_s:6.2f} s after the command, {cpu_s:5.2f} s of processor time")


def started(source: str, home: str) -> dict[str, Any]:
    """Return the moments of one start in a process of its own."""
    command = [sys.executable, "-m", "tests.benchmarks.start_time", "--inside", "--source", source]
    environment = {
        **os.environ, "QT_QPA_PLATFORM": "offscreen", "FACEPUPPET_HOME": home,
        "FACEPUPPET_STARTED": repr(time.time()),
    }  # fmt: skip
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def moments(source: str) -> dict[str, tuple[float, float]]:
    """Open the window; return for each of MOMENTS the time since the command and of the CPU."""
    began_s = float(os.environ["FACEPUPPET_STARTED"])
    found: dict[str, tuple[float, float]] = {}

    def note(name: str) -> None:
        found.setdefault(name, (time.time() - began_s, time.process_time()))

    from PySide6.QtCore import QTimer
    from PySide6.QtWidgets import QApplication

    import app  # noqa: F401  sets what numba and OpenBLAS read at their first import
    from app.controllers.starting import Starting
    from app.views.live_window import LiveWindow

    application = QApplication([])
    window = LiveWindow()
    window.show()
    QTimer.singleShot(0, lambda: note("window"))
    starting = Starting(window)
    starting.ready.connect(lambda _: (note("controls"), window.take(source)))
    timer = QTimer()

    def look() -> None:
        for name, pane in (("source", window.source_pane), ("avatar", window.avatar_pane)):
            if pane.has_picture:
                note(name)
        if len(found) == len(MOMENTS) or time.time() - began_s > GIVE_UP_S:
            window.close()

    timer.timeout.connect(look)
    timer.start(5)
    application.exec()
    return found


if __name__ == "__main__":
    main()
