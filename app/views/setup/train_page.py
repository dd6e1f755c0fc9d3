"""The training: what is being done, how good it became, what is weak."""

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Signal
from PySide6.QtGui import QImage
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QMenu,
    QPushButton,
    QStackedWidget,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from app.views.choice import Choice
from app.views.job_row import JobRow
from app.views.message_bar import MessageBar
from app.views.setup.stage_list import StageList
from app.views.setup.training_plots import FocalPlot, ResidualPlot, StagePlot, TrainingPlot


class TrainPage(QWidget):
    """Buttons, the stages while they are at work, three plots and the report."""

    train_wanted = Signal()
    live_wanted = Signal()
    export_wanted = Signal()
    picture_wanted = Signal(str)  # name of a picture to look at
    more_wanted = Signal(str)  # key of a set of more pictures

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.train_button = QPushButton("&Train")
        self.more_button = QPushButton("&Add pictures")
        self.live_button = QPushButton("&Go live")
        self.export_button = QPushButton("&Export the report…")
        self.job_row, self.status, self.message_bar = JobRow(), QLabel(), MessageBar()
        self.stages, self.left = StageList(), QStackedWidget()
        self.report = QTextBrowser()
        self.focal_plot, self.residual_plot = FocalPlot(), ResidualPlot()
        self.stage_plot, self.plot_column = StagePlot(), QWidget()
        self._build()
        self._connect()

    @property
    def plots(self) -> tuple[TrainingPlot, ...]:
        """The plots, from above."""
        return self.stage_plot, self.focal_plot, self.residual_plot

    def plot_images(self) -> dict[str, QImage]:
        """Return the plots on white, by their titles."""
        return {plot.title: plot.print_image() for plot in self.plots}

    def show_sets(self, sets: Sequence[Choice]) -> None:
        """Offer sets of more pictures."""
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        for one in sets:
            action = menu.addAction(one.text)
            action.setToolTip(one.details)
            action.triggered.connect(lambda _=False, key=one.key: self.more_wanted.emit(key))
        self.more_button.setMenu(menu)

    def show_focal(self, focals_px: Sequence[float], errors: Sequence[float]) -> None:
        """Plot the search for the focal length as far as it is [Cao13, fig. 5]."""
        self.focal_plot.show_focal(focals_px, errors)

    def show_residuals(self, residuals_px: Sequence[float], names: Sequence[str] = ()) -> None:
        """Plot how far the landmarks of each picture are from the fitted face."""
        self.residual_plot.show_residuals(residuals_px, names)

    def show_stage_errors(self, errors_px: Mapping[str, Sequence[float]]) -> None:
        """Plot the landmark error after each stage; see CURVES for the keys."""
        self.stage_plot.show_stages(errors_px)

    def show_plots(self, shown: bool) -> None:
        """Show the plots, or leave their room to the text while there is nothing to plot."""
        self.plot_column.setVisible(shown)

    def begin(self, stages: Mapping[str, float]) -> None:
        """Show that a training begins, with its stages and their shares of the work."""
        self.message_bar.tell("")
        self.show_plots(True)
        self.stages.show_stages(stages)
        self.left.setCurrentIndex(0)
        self.job_row.begin("Training")

    def end(self) -> None:
        """Show the report again."""
        self.job_row.end()
        self.left.setCurrentIndex(1)

    def show_state(self, text: str, can_train: bool, trained: bool) -> None:
        """Say what can be done now."""
        self.status.setText(text)
        self.train_button.setText("&Train again" if trained else "&Train")
        self.train_button.setEnabled(can_train)
        self.live_button.setEnabled(trained)
        self.export_button.setEnabled(trained)

    def show_report(self, html: str) -> None:
        """Show the report; links in it are names of pictures."""
        self.report.setHtml(html)

    def _connect(self) -> None:
        self.train_button.clicked.connect(self.train_wanted)
        self.live_button.clicked.connect(self.live_wanted)
        self.export_button.clicked.connect(self.export_wanted)
        self.residual_plot.picture_wanted.connect(self.picture_wanted)
        self.report.anchorClicked.connect(lambda url: self.picture_wanted.emit(url.toString()))

    def _build(self) -> None:
        self.status.setWordWrap(True)
        self.report.setAccessibleName("Report")
        self.report.setOpenLinks(False)
        head = QHBoxLayout()
        head.addWidget(self.status, stretch=1)
        for button in (self.train_button, self.more_button, self.export_button, self.live_button):
            head.addWidget(button)
        working = QWidget()
        column = QVBoxLayout(working)
        column.addWidget(self.stages)
        column.addStretch(1)
        self.left.addWidget(working)
        self.left.addWidget(self.report)
        self.left.setCurrentIndex(1)
        plots = QVBoxLayout(self.plot_column)
        plots.setContentsMargins(0, 0, 0, 0)
        for plot in self.plots:
            plots.addWidget(plot, stretch=1)
        body = QHBoxLayout()
        body.addWidget(self.left, stretch=3)
        body.addWidget(self.plot_column, stretch=2)
        layout = QVBoxLayout(self)
        layout.addWidget(self.message_bar)
        layout.addLayout(head)
        layout.addWidget(self.job_row)
        layout.addLayout(body, stretch=1)
