"""Plots of what happened of late; pyqtgraph is loaded when the first one is shown.

pyqtgraph's module is passed in: loading it takes a while, which is done elsewhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, Signal
from PySide6.QtGui import QPalette, QShowEvent
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

LOADING = "Loading the plots…"
#: Told apart on light and dark ground, and by colour-blind people (Okabe and Ito).
COLORS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8f8f1f", "#7f7f7f")


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """One line of a plot.

    Attributes:
        name: For people.
        x: (n,) rising.
        y: (n,).
    """

    name: str
    x: NDArray[np.float64]
    y: NDArray[np.float64]


class Plot(QWidget):
    """Curves over a common axis, in the colours of the theme."""

    wanted = Signal()  # shown for the first time: `build` is to be called

    def __init__(self, x_text: str, y_text: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = {"bottom": x_text, "left": y_text}
        self._notice = QLabel(LOADING)
        self._notice.setMargin(12)
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._layout.addWidget(self._notice)
        self.setMinimumSize(260, 180)
        self._pg: Any = None
        self._plot: Any = None
        self._legend: Any = None
        self._lines: list[Any] = []
        self._names: list[str] = []

    @property
    def built(self) -> bool:
        """Whether curves can be shown."""
        return self._plot is not None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the curves that are shown."""
        return tuple(self._names)

    def build(self, pyqtgraph: Any) -> None:
        """Make the plot."""
        if self.built:
            return
        self._pg = pyqtgraph
        self._plot = pyqtgraph.PlotWidget()
        self._plot.setMenuEnabled(False)
        self._plot.hideButtons()
        self._plot.showGrid(x=True, y=True, alpha=0.2)
        self._plot.setAccessibleName(f"{self._texts['left']} over {self._texts['bottom']}")
        self._legend = self._plot.addLegend(offset=(8, 4), verSpacing=-4)
        self._notice.hide()
        self._layout.addWidget(self._plot)
        self._follow_theme()

    def show_curves(self, curves: Sequence[Curve], *, steps: bool = False) -> None:
        """Show curves in place of those before.

        Args:
            curves: In the order of their colours.
            steps: The curves are histograms: x are edges, one more than y.
        """
        names = [curve.name for curve in curves]
        if names != self._names:
            self._name_lines(names)
        for line, curve in zip(self._lines, curves, strict=True):
            line.setData(curve.x, curve.y, stepMode="center" if steps else None)

    def set_range(self, low: float, high: float) -> None:
        """Fix the vertical axis."""
        self._plot.setYRange(low, high, padding=0.02)

    def showEvent(self, event: QShowEvent) -> None:
        """Ask for what is needed to plot."""
        super().showEvent(event)
        if not self.built:
            self.wanted.emit()

    def changeEvent(self, event: QEvent) -> None:
        """Take on another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and self.built:
            self._follow_theme()

    def _name_lines(self, names: list[str]) -> None:
        for line in self._lines:
            self._plot.removeItem(line)
        self._lines = [
            self._plot.plot(name=name, pen=self._pg.mkPen(COLORS[place % len(COLORS)], width=1.5))
            for place, name in enumerate(names)
        ]
        self._names = names

    def _follow_theme(self) -> None:
        palette = self.palette()
        text = palette.color(QPalette.ColorRole.WindowText)
        self._plot.setBackground(palette.color(QPalette.ColorRole.Base))
        self._legend.setLabelTextColor(text)
        for side, label in self._texts.items():
            axis = self._plot.getAxis(side)
            axis.setPen(text)
            axis.setTextPen(text)
            axis.setLabel(label, color=text.name())
