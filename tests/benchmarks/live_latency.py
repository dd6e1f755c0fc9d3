"""Added latency of the live window: from a frame's delivery to the avatar's picture of it.

    python -m tests.benchmarks.live_latency [--source PATH] [--profile NAME] [--seconds 20]
        [--avatar nora]

Plays a source in the real window, offscreen, drawn by whatever OpenGL there is. A camera delivers
frames without work of ours, but the virtual performer has to be drawn as well: so by default ten
seconds of it are filmed first and played as a video. All else that runs on the machine adds to the
times on the clock.
"""

import argparse
import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import cv2
import numpy as np
from PySide6.QtCore import QEventLoop, QTimer
from PySide6.QtWidgets import QApplication

import app  # noqa: F401  sets what numba and OpenBLAS read at their first import
from app.controllers.desk import open_desk
from app.controllers.toolbox import Toolbox
from app.performer.opening import Scenario, open_performer
from app.views.live_actions import OVERLAYS
from app.views.live_window import LiveWindow
from app.workers.avatar_loop import Painted
from app.workers.live_loop import LiveResult
from app.workers.probe import GuiProbe
from core.records import Frame

#: Seconds after the first avatar picture that do not count.
WARM_UP_S = 3.0
FILM_S = 10.0


def main() -> None:
    """Play and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--source", default="", help="default: a film of the performer, made first")
    parser.add_argument("--profile", default="", help="default: training-free")
    parser.add_argument("--avatar", default="nora")
    parser.add_argument("--seconds", type=float, default=20.0)
    args = parser.parse_args()
    application = QApplication(sys.argv[:1])
    with tempfile.TemporaryDirectory() as folder:
        source = args.source or film(Path(folder) / "talking.mp4")
        result = measured(source, args.profile, args.avatar, args.seconds)
    del application
    report(result)


def film(path: Path) -> str:
    """Write some seconds of the talking performer as a video; return its path."""
    with open_performer(Scenario(take="talking")) as performer:
        code = cv2.VideoWriter.fourcc(*"mp4v")
        writer = cv2.VideoWriter(str(path), code, performer.fps, performer.size_px)
        for _ in range(int(FILM_S * performer.fps)):
            frame = performer.read()
            if frame is not None:
                writer.write(np.ascontiguousarray(frame.rgb[..., ::-1]))
        writer.release()
    return str(path)


class Samples:
    """What one stretch of playing gave."""

    def __init__(self) -> None:
        self.latency_ms: list[float] = []
        self.solve_ms: list[float] = []
        self.indices: list[int] = []
        self.counts = False

    def note_painted(self, painted: Painted) -> None:
        """Note a picture of the avatar."""
        if self.counts and painted.wish.delivered_s is not None:
            self.latency_ms.append(1000 * (painted.ready_s - painted.wish.delivered_s))

    def note_solved(self, frame: Frame, *_: Any) -> None:
        """Note a frame; called in the live thread."""
        if self.counts:
            self.indices.append(frame.index)

    def note_result(self, result: LiveResult) -> None:
        """Note how long solving took."""
        if self.counts:
            self.solve_ms.append(result.step_ms)


def measured(source: str, profile: str, avatar: str, seconds: float) -> dict[str, Any]:
    """Return what playing a source for some seconds gave."""
    window, controller = open_desk(Toolbox())
    samples, probe = Samples(), GuiProbe()
    controller.scene.painted.connect(samples.note_painted)
    controller.add_listener(samples.note_solved)
    controller.solved.connect(samples.note_result)
    as_at_first(window)
    window.show()
    controller.start()
    window.avatar_chosen.emit(avatar)
    window.take(source)
    window.profile_chosen.emit(profile)
    wait(120.0, lambda: window.avatar_pane.has_picture)
    wait(WARM_UP_S)
    samples.counts = True
    began_s, used_s = time.perf_counter(), time.process_time()
    probe.start()
    wait(seconds)
    probe.stop()
    samples.counts = False
    passed_s, used_s = time.perf_counter() - began_s, time.process_time() - used_s
    state = window.status.state
    window.close()
    return {
        "samples": samples, "passed_s": passed_s, "used_s": used_s, "state": state,
        "quality": controller.scene.drawn, "turn_ms": probe.worst_cpu_ms(),
    }  # fmt: skip


def as_at_first(window: LiveWindow) -> None:
    """Lay the window out as for somebody who has changed nothing."""
    window.resize(1280, 720)
    for key in window.panels.keys:
        window.panels.dock(key).hide()
    for key in OVERLAYS:
        window.deeds[key].setChecked(key == "landmarks")


def wait(seconds: float, until: Callable[[], bool] = lambda: False) -> None:
    """Let the window work for some seconds, or until something is so."""
    loop, timer = QEventLoop(), QTimer()
    QTimer.singleShot(round(1000 * seconds), loop.quit)
    timer.timeout.connect(lambda: loop.quit() if until() else None)
    timer.start(20)
    loop.exec()
    timer.stop()


def report(result: dict[str, Any]) -> None:
    """Print the numbers."""
    samples: Samples = result["samples"]
    latency = np.array(samples.latency_ms)
    solved = len(samples.indices)
    dropped = samples.indices[-1] - samples.indices[0] + 1 - solved if solved else 0
    print(f"{result['state']}; avatar drawn at {100 * result['quality'].scale:.0f} % of its size")
    print(f"frame delivered -> avatar picture: median {np.median(latency):.1f} ms, "
          f"95 % below {np.percentile(latency, 95):.1f} ms, least {latency.min():.1f} ms "
          f"({len(latency)} pictures)")  # fmt: skip
    print(f"solving a frame: median {np.median(samples.solve_ms):.1f} ms")
    print(f"{solved / result['passed_s']:.1f} frames per second, {dropped} left out")
    print(f"processor: {result['used_s'] / result['passed_s']:.2f} of one core")
    print(f"longest turn of the window's thread: {result['turn_ms']:.1f} ms of its own time")


if __name__ == "__main__":
    main()
