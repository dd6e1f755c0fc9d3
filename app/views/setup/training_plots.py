"""The plots of a training: in the colours of the theme, and on white for print."""

from collections.abc import Mapping, Sequence

import pyqtgraph as pg
from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPalette
from PySide6.QtWidgets import QWidget

from app.picture_names import title_of

#: Colours that the colour-blind can tell apart [Okabe, Ito], on a light and on a dark ground.
LIGHT = {"first": "#0072b2", "second": "#d55e00", "third": "#00795a"}
DARK = {"first": "#56b4e9", "second": "#f0a030", "third": "#2fd0a0"}
PRINT_WIDTH, PRINT_HEIGHT = 480, 300
#: Pictures that are named below the plot of all.
N_WORST = 3


#: Key of a curve of the stages -> its colour, its mark, what it is.
CURVES = {
    "training_px": ("first", "o", "trained on"),
    "held_out_px": ("second", "t", "kept for testing"),
    "all_px": ("third", "s", "final training"),
}


class TrainingPlot(pg.PlotWidget):  # type: ignore[misc]
    """A plot with a title that follows the theme."""

    #: Events come before there is anything to paint.
    _ready = False

    def __init__(self, title: str, bottom: str, left: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.title = title
        self._labels = {"bottom": bottom, "left": left}
        self.setAccessibleName(title)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setMouseEnabled(False, False)
        self.hideButtons()
        self.setMenuEnabled(False)
        self.setMinimumHeight(120)

    def begin(self) -> None:
        """Follow the theme from now on; called when all curves are there."""
        self._ready = True
        self.paint_in(self.palette())

    def changeEvent(self, event: QEvent) -> None:
        """Follow the theme."""
        super().changeEvent(event)
        if self._ready and event.type() == QEvent.Type.PaletteChange:
            self.paint_in(self.palette())

    def paint_in(self, palette: QPalette) -> None:
        """Use the ground and the text colour of a palette."""
        ground = palette.color(QPalette.ColorRole.Base)
        text = palette.color(QPalette.ColorRole.Text)
        self.setBackground(ground)
        for side, words in self._labels.items():
            self.setLabel(side, words, color=text.name())
            self.getAxis(side).setPen(_between(text, ground, 0.35))
            self.getAxis(side).setTextPen(text)
        self.setTitle(self.title, color=text.name(), size="10pt")
        self.paint_curves(DARK if ground.lightnessF() < 0.5 else LIGHT, text)

    def paint_curves(self, colors: Mapping[str, str], text: QColor) -> None:
        """Use colours for what is plotted."""

    def print_image(self) -> QImage:
        """Return the plot on white."""
        paper = QPalette(self.palette())
        paper.setColor(QPalette.ColorRole.Base, Qt.GlobalColor.white)
        paper.setColor(QPalette.ColorRole.Text, Qt.GlobalColor.black)
        size = self.size()
        self.paint_in(paper)
        self.resize(PRINT_WIDTH, PRINT_HEIGHT)
        image = QImage(self.grab().toImage())
        self.resize(size)
        self.paint_in(self.palette())
        return image


class FocalPlot(TrainingPlot):
    """The fitting error against the focal length [Cao13, fig. 5]."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Fitting error against focal length", "focal length (px)", "error", parent)
        self.curve = pg.PlotDataItem(symbol="o", symbolSize=6)
        self.addItem(self.curve)
        self.begin()

    def paint_curves(self, colors: Mapping[str, str], text: QColor) -> None:
        """Use colours for the curve."""
        _color(self.curve, colors["first"])

    def show_focal(self, focals_px: Sequence[float], errors: Sequence[float]) -> None:
        """Plot the search as far as it is."""
        order = sorted(range(len(focals_px)), key=lambda n: focals_px[n])
        self.curve.setData([focals_px[n] for n in order], [errors[n] for n in order])


class StagePlot(TrainingPlot):
    """The landmark error after each stage of the regression."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Landmark error after each stage", "stage", "px", parent)
        self.curves = {
            key: pg.PlotDataItem(symbol=mark, symbolSize=7) for key, (_, mark, _) in CURVES.items()
        }
        self._legend = pg.LegendItem(offset=(-8, 4), verSpacing=-6)
        self._legend.setParentItem(self.getPlotItem().vb)
        for curve in self.curves.values():
            self.addItem(curve)
        self.getAxis("bottom").setTickSpacing(1, 1)
        self.begin()

    def paint_curves(self, colors: Mapping[str, str], text: QColor) -> None:
        """Use colours for the curves and the legend."""
        for key, curve in self.curves.items():
            _color(curve, colors[CURVES[key][0]])
        self._legend.setLabelTextColor(text)
        self._show_legend()

    def show_stages(self, errors_px: Mapping[str, Sequence[float]]) -> None:
        """Plot the errors before the first stage and after each, by the key of the curve."""
        for key, curve in self.curves.items():
            errors = list(errors_px.get(key, ()))
            curve.setData(list(range(len(errors))), errors)
        self._show_legend()

    def _show_legend(self) -> None:
        """Name the curves that there are."""
        self._legend.clear()
        for key, curve in self.curves.items():
            if curve.xData is not None and len(curve.xData):
                self._legend.addItem(curve, CURVES[key][2])


class ResidualPlot(TrainingPlot):
    """How far the landmarks of each picture are from the fitted face; a click opens one."""

    picture_wanted = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Landmarks against the fitted face", "picture", "px", parent)
        self.bars = pg.BarGraphItem(x=[], height=[], width=0.8, pen=None)
        self._names: list[str] = []
        self.addItem(self.bars)
        self.begin()
        self.scene().sigMouseMoved.connect(self._on_moved)
        self.scene().sigMouseClicked.connect(self._on_clicked)

    def paint_curves(self, colors: Mapping[str, str], text: QColor) -> None:
        """Use a colour for the bars."""
        self.bars.setOpts(brush=colors["first"])

    def show_residuals(self, residuals_px: Sequence[float], names: Sequence[str] = ()) -> None:
        """Plot a bar for each picture; names are those of the pictures."""
        self._names = list(names)
        self.bars.setOpts(x=list(range(len(residuals_px))), height=list(residuals_px))
        order = sorted(range(len(residuals_px)), key=lambda row: -residuals_px[row])
        worst = [title_of(names[row]) for row in order[:N_WORST] if row < len(names)]
        self._labels["bottom"] = f"picture (worst: {', '.join(worst)})" if worst else "picture"
        self.paint_in(self.palette())

    def name_at(self, place: float) -> str:
        """Return the name of the picture whose bar is there, "" if there is none."""
        row = round(place)
        return self._names[row] if 0 <= row < len(self._names) else ""

    def _place_of(self, position: object) -> float:
        return float(self.getPlotItem().vb.mapSceneToView(position).x())

    def _on_moved(self, position: object) -> None:
        self.setToolTip(title_of(self.name_at(self._place_of(position))))

    def _on_clicked(self, event: object) -> None:
        name = self.name_at(self._place_of(event.scenePos()))  # type: ignore[attr-defined]
        if name:
            self.picture_wanted.emit(name)


def _color(curve: pg.PlotDataItem, color: str) -> None:
    curve.setPen(pg.mkPen(color, width=2))
    curve.setSymbolBrush(color)
    curve.setSymbolPen(None)


def _between(one: QColor, other: QColor, share: float) -> QColor:
    """Return a colour between two."""

    def part(a: int, b: int) -> int:
        return round(a + share * (b - a))

    return QColor(
        part(one.red(), other.red()), part(one.green(), other.green()),
        part(one.blue(), other.blue()),
    )  # fmt: skip
