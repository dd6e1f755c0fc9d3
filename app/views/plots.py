"""Plots of what happened of late; pyqtgraph is loaded when the first one is shown.

pyqtgraph's module is passed in: loading it takes a while, which is done elsewhere.
"""

from collections.abc import Generator, Sequence
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

    def __init__(
        self,
        texts: tuple[str, str],
        n_curves: int,
        y_range: tuple[float, float] | None = None,
        parent: QWidget | None = None,
    ) -> None:
        """Make an empty one.

        Args:
            texts: What runs to the right, and upwards.
            n_curves: At most len(COLORS).
            y_range: Of the vertical axis; None: as the curves need.
            parent: Of the widget.
        """
        super().__init__(parent)
        self._n_curves, self._range = n_curves, y_range
        self._texts = {"bottom": texts[0], "left": texts[1]}
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
        self._names: tuple[str, ...] = ()

    @property
    def built(self) -> bool:
        """Whether curves can be shown."""
        return self._plot is not None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the curves that are shown."""
        return self._names

    def build(self, pyqtgraph: Any) -> Generator[None, None, None]:
        """Make the plot, in steps short enough for the window to answer between them."""
        self._pg = pyqtgraph
        made = pyqtgraph.PlotWidget()
        yield
        made.setMenuEnabled(False)
        made.hideButtons()
        made.showGrid(x=True, y=True, alpha=0.2)
        made.setAccessibleName(f"{self._texts['left']} over {self._texts['bottom']}")
        self._legend = made.addLegend(offset=(8, 4), verSpacing=-6, colCount=2)
        yield
        for color in COLORS[: self._n_curves]:
            # Wider lines are drawn many times slower.
            self._lines.append(made.plot(name=" ", pen=pyqtgraph.mkPen(color, width=1)))
            yield
        self._plot = made
        if self._range is not None:
            made.setYRange(*self._range, padding=0.02)
        self._follow_theme()
        self._notice.hide()
        self._layout.addWidget(made)

    def show_curves(self, curves: Sequence[Curve], *, steps: bool = False) -> None:
        """Show curves in place of those before.

        Args:
            curves: As many as were promised.
            steps: The curves are histograms: x are edges, one more than y.
        """
        names = tuple(curve.name for curve in curves)
        if names != self._names:
            for line, name in zip(self._lines, names, strict=True):
                self._legend.getLabel(line).setText(name)
            self._names = names
        for line, curve in zip(self._lines, curves, strict=True):
            line.setData(curve.x, curve.y, stepMode="center" if steps else None)

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

    def _follow_theme(self) -> None:
        palette = self.palette()
        text = palette.color(QPalette.ColorRole.WindowText)
        self._plot.setBackground(palette.color(QPalette.ColorRole.Base))
        self._legend.setLabelTextColor(text)
        for side, name in self._texts.items():
            axis = self._plot.getAxis(side)
            axis.setPen(text)
            axis.setTextPen(text)
            axis.setLabel(name, color=text.name())
