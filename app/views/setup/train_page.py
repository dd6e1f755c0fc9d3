"""The training: what is being done, how good it became, what is weak."""

from collections.abc import Sequence

import pyqtgraph as pg
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QTextBrowser, QVBoxLayout, QWidget

from app.views.job_row import JobRow

CURVE, WORST = (0, 114, 178), (213, 94, 0)


class TrainPage(QWidget):
    """Buttons, progress, two plots and the report."""

    train_wanted = Signal()
    live_wanted = Signal()
    export_wanted = Signal()
    picture_wanted = Signal(str)  # name of a picture to look at

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.train_button = QPushButton("&Train")
        self.live_button = QPushButton("&Go live")
        self.export_button = QPushButton("&Export the report…")
        self.job_row, self.status = JobRow(), QLabel()
        self.status.setWordWrap(True)
        self.report = QTextBrowser()
        self.report.setAccessibleName("Report")
        self.report.setOpenLinks(False)
        self.report.anchorClicked.connect(lambda url: self.picture_wanted.emit(url.toString()))
        self.focal_plot = _plot("Fitting error against focal length", "focal length (px)", "error")
        self.residual_plot = _plot("Landmarks against the fitted face", "picture", "px")
        self._curve = self.focal_plot.plot(pen=pg.mkPen(CURVE, width=2), symbol="o", symbolSize=6,
                                           symbolBrush=CURVE, symbolPen=None)  # fmt: skip
        self._bars = pg.BarGraphItem(x=[], height=[], width=0.8, brush=CURVE, pen=None)
        self.residual_plot.addItem(self._bars)
        self._build()

    def show_focal(self, focals_px: Sequence[float], errors: Sequence[float]) -> None:
        """Plot the search for the focal length as far as it is [Cao13, fig. 5]."""
        order = sorted(range(len(focals_px)), key=lambda n: focals_px[n])
        self._curve.setData([focals_px[n] for n in order], [errors[n] for n in order])

    def show_residuals(self, residuals_px: Sequence[float]) -> None:
        """Plot how far the landmarks of each picture are from the fitted face."""
        self._bars.setOpts(x=list(range(len(residuals_px))), height=list(residuals_px))

    def show_state(self, text: str, can_train: bool, trained: bool) -> None:
        """Say what can be done now."""
        self.status.setText(text)
        self.train_button.setEnabled(can_train)
        self.live_button.setEnabled(trained)
        self.export_button.setEnabled(trained)

    def show_report(self, html: str) -> None:
        """Show the report; links in it are names of pictures."""
        self.report.setHtml(html)

    def _build(self) -> None:
        self.train_button.clicked.connect(self.train_wanted)
        self.live_button.clicked.connect(self.live_wanted)
        self.export_button.clicked.connect(self.export_wanted)
        head = QHBoxLayout()
        head.addWidget(self.status, stretch=1)
        for button in (self.train_button, self.export_button, self.live_button):
            head.addWidget(button)
        plots = QVBoxLayout()
        plots.addWidget(self.focal_plot)
        plots.addWidget(self.residual_plot)
        body = QHBoxLayout()
        body.addWidget(self.report, stretch=3)
        body.addLayout(plots, stretch=2)
        layout = QVBoxLayout(self)
        layout.addLayout(head)
        layout.addWidget(self.job_row)
        layout.addLayout(body, stretch=1)


def _plot(title: str, bottom: str, left: str) -> pg.PlotWidget:
    plot = pg.PlotWidget(title=title, background="w")
    plot.setAccessibleName(title)
    plot.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    plot.setMouseEnabled(False, False)
    plot.hideButtons()
    plot.setMenuEnabled(False)
    for side, text in (("bottom", bottom), ("left", left)):
        plot.setLabel(side, text, color="#222")
        plot.getAxis(side).setPen("#444")
        plot.getAxis(side).setTextPen("#222")
    plot.setTitle(title, color="#222", size="10pt")
    return plot
