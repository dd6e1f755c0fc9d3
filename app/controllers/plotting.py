"""Plots on demand: coefficients and head angles over time, and how long frames take."""

from collections import deque
from collections.abc import Generator
from importlib import import_module
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, QTimer

from app.controllers.live import LiveController
from app.views.live_window import LiveWindow
from app.views.plots import Curve, Plot
from app.workers.avatar_loop import Painted
from app.workers.job import Job
from app.workers.live_loop import LiveResult
from core.arkit import EXPRESSION_NAMES
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.records import FaceState, FloatArray, Frame, Progress

SHOW_EVERY_MS = 100
SPAN_S, SPAN_FRAMES = 10.0, 320
#: Of all coefficients those that moved most are plotted.
N_COEFFICIENTS = 8
#: Times are counted in bins of so many ms, the last one of all that took longer.
BIN_MS, LONGEST_MS = 1.0, 50.0
DONE = object()
ANGLES = ("yaw", "pitch", "roll")


class Plotting(QObject):
    """Remembers the last seconds while a plot is open, and shows them ten times a second."""

    def __init__(self, controller: LiveController, window: LiveWindow) -> None:
        super().__init__(controller)
        self._controller = controller
        self._rows: deque[FloatArray] = deque(maxlen=SPAN_FRAMES)
        self._solve_ms: deque[float] = deque(maxlen=SPAN_FRAMES)
        self._latency_ms: deque[float] = deque(maxlen=SPAN_FRAMES)
        self._job: Job | None = None
        self._listens = False
        self.coefficients = Plot(("s", "coefficient"), N_COEFFICIENTS, (0.0, 1.0))
        self.angles = Plot(("s", "degrees"), len(ANGLES))
        self.times = Plot(("ms", "frames"), 2)
        self._building: Generator[None, None, None] | None = None
        self._pyqtgraph: Any = None
        self._plots = (self.coefficients, self.angles, self.times)
        for key, title, plot in (
            ("plot_coefficients", "Plot of coefficients", self.coefficients),
            ("plot_head", "Plot of head angles", self.angles),
            ("plot_times", "Plot of times", self.times),
        ):
            window.add_panel(key, title, plot, area="bottom")
            plot.wanted.connect(self._load)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._show)
        self._timer.start(SHOW_EVERY_MS)
        controller.solved.connect(self._on_solved)
        controller.scene.painted.connect(self._on_painted)
        controller.source_changed.connect(lambda _: self._forget())
        controller.ending.connect(self._on_ending)

    # -- what happens ---------------------------------------------------------------------

    def _listen(self, frame: Frame, solved: FaceState, driven: FaceState, _: float) -> None:
        """Remember a frame; called in the live thread."""
        angles = np.degrees(head_angles_from_matrix(matrix_from_quaternion(driven.rotation_wxyz)))
        self._rows.append(np.concatenate([[driven.time_s], angles, driven.expression]))

    def _on_solved(self, result: LiveResult) -> None:
        self._solve_ms.append(result.step_ms)

    def _on_painted(self, painted: Painted) -> None:
        if painted.wish.delivered_s is not None:
            self._latency_ms.append(1000 * (painted.ready_s - painted.wish.delivered_s))

    def _forget(self) -> None:
        for past in (self._rows, self._solve_ms, self._latency_ms):
            past.clear()

    # -- what is shown --------------------------------------------------------------------

    def _show(self) -> None:
        """Show what is open, and listen only while something is."""
        seen = [plot for plot in self._plots if plot.isVisible()]
        if bool(seen) != self._listens:
            self._listens = bool(seen)
            change = self._controller.add_listener if seen else self._controller.remove_listener
            change(self._listen)
        if any(plot.built for plot in seen):
            self._show_rows()
        if self.times in seen and self.times.built:
            curves = [counted("solve", self._solve_ms), counted("latency", self._latency_ms)]
            self.times.show_curves(curves, steps=True)

    def _show_rows(self) -> None:
        rows = np.array(list(self._rows))
        if len(rows) < 2:
            return
        ago_s = rows[:, 0] - rows[-1, 0]
        kept = ago_s >= -SPAN_S
        ago_s, rows = ago_s[kept], rows[kept]
        if self.angles.isVisible() and self.angles.built:
            self.angles.show_curves(
                [Curve(name, ago_s, rows[:, 1 + place]) for place, name in enumerate(ANGLES)]
            )
        if self.coefficients.isVisible() and self.coefficients.built:
            self.coefficients.show_curves(
                [
                    Curve(EXPRESSION_NAMES[place], ago_s, rows[:, 4 + place])
                    for place in liveliest(rows[:, 4:])
                ]
            )

    # -- loading --------------------------------------------------------------------------

    def _load(self) -> None:
        if self._pyqtgraph is not None and self._building is None:
            self._build()
        if self._job is None:
            self._job = Job(_loading(), self)
            self._job.returned.connect(self._on_loaded)
            self._job.start()

    def _on_loaded(self, pyqtgraph: Any) -> None:
        self._pyqtgraph = pyqtgraph
        self._build()

    def _build(self) -> None:
        """Go a step on with a plot that is open, until all that are open are made."""
        if self._building is None:
            missing = [plot for plot in self._plots if plot.isVisible() and not plot.built]
            if not missing:
                return
            self._building = missing[0].build(self._pyqtgraph)
        if next(self._building, DONE) is DONE:
            self._building = None
        QTimer.singleShot(0, self, self._build)

    def _on_ending(self) -> None:
        self._timer.stop()
        if self._job is not None:
            self._job.cancel()


def liveliest(values: FloatArray) -> list[int]:
    """Return which columns of (n, B) changed most, in their usual order."""
    most = np.argsort(-np.ptp(values, axis=0), kind="stable")[:N_COEFFICIENTS]
    return sorted(most.tolist())


def counted(name: str, times_ms: "deque[float]") -> Curve:
    """Return a histogram of times; longer ones than the axis count in its last bin."""
    edges = np.arange(0.0, LONGEST_MS + BIN_MS, BIN_MS)
    times = np.clip(np.array(list(times_ms)), 0.0, LONGEST_MS - BIN_MS / 2)
    return Curve(name, edges, np.histogram(times, edges)[0].astype(float))


def _loading() -> Generator[Progress, None, Any]:
    yield Progress(0, 1, "Loading the plots")
    return import_module("pyqtgraph")
