"""The training page at work."""

from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from app.controllers.profile_maker import ProfileMaker
from app.controllers.report_export import FILTERS, write_report
from app.errors import AppError
from app.report import report_html
from app.views.choice import Choice
from app.views.files import ask_where_to_save
from app.views.setup.train_page import TrainPage
from app.workbook import Workbook
from core.extra_shots import SETS
from core.pipeline import LEAST_PICTURES, stage_shares
from core.records import Progress

#: The steps of a training, which return what to tell the user.
Train = Callable[[Workbook], Generator[Progress, None, object]]


#: Shown before the first training.
EMPTY = (
    "<p>After the training a report stands here: how exact it is on pictures that it did not see, "
    "by head turn and by expression, and what will be weak on your avatar, and why.</p>"
)


class TrainingController(QObject):
    """Joins the training page with a workbook."""

    trained = Signal()
    picture_wanted = Signal(str)
    live_wanted = Signal()
    more_wanted = Signal(str)  # key of a set of more pictures, see core.extra_shots

    def __init__(self, page: TrainPage, train: Train, parent: QObject | None = None) -> None:
        super().__init__(parent or page)
        self._page, self._train = page, train
        self._book: Workbook | None = None
        self._maker = ProfileMaker(self)
        self._focals: list[tuple[float, float]] = []
        self._stages: dict[str, list[float]] = {}
        self._ended = False
        page.show_sets([Choice(one.key, one.title, one.reason) for one in SETS])
        page.train_wanted.connect(self.train)
        page.live_wanted.connect(self.live_wanted)
        page.export_wanted.connect(self._on_export)
        page.picture_wanted.connect(self.picture_wanted)
        page.more_wanted.connect(self.more_wanted)
        page.job_row.cancel_wanted.connect(self._maker.cancel)
        self._maker.progressed.connect(page.job_row.show_progress)
        self._maker.noted.connect(self._on_noted)
        self._maker.made.connect(self._on_made)
        self._maker.failed.connect(self._on_failed)
        self._maker.finished.connect(self._on_finished)

    @property
    def busy(self) -> bool:
        """Whether a training runs."""
        return self._maker.busy

    def show(self, book: Workbook) -> None:
        """Show what can be trained, and the report of what was."""
        if book is not self._book and not self._maker.busy:
            self._page.message_bar.tell("")
        self._book = book
        if not self._maker.busy:
            self._show_report(book)
        self._show_state()

    def train(self) -> None:
        """Begin a training; what there is stays until it is complete."""
        if self._book is None or self._maker.busy:
            return
        self._focals, self._stages, self._ended = [], {}, False
        known = self._book.given_focal_px is not None
        self._page.begin(stage_shares(known))
        self._page.show_focal([], [])
        self._page.show_stage_errors({})
        self._maker.start(self._train(self._book))
        self._show_state()

    def stop(self) -> None:
        """End a training that runs; the profile stays as it was."""
        self._maker.stop()

    def _show_report(self, book: Workbook) -> None:
        report: Any = book.profile.report if book.profile is not None else {}
        curve = report.get("focal_curve") or []
        self._page.show_focal([row[0] for row in curve], [row[1] for row in curve])
        names = report.get("picture_names") or []
        self._page.show_residuals(report.get("picture_rms_px_at_640") or [], names)
        tested = (report.get("held_out") or {}).get("stages") or {}
        self._page.show_stage_errors(tested | (report.get("stages") or {}))
        self._page.show_plots(bool(report))
        self._page.show_report(report_html(book.folder.name, report) if report else EMPTY)

    def _show_state(self) -> None:
        book = self._book
        if book is None:
            return
        trained, enough = book.profile is not None, book.n_usable >= LEAST_PICTURES
        text = self._told(book, trained, enough)
        self._page.show_state(text, enough and not self._maker.busy, trained)

    def _told(self, book: Workbook, trained: bool, enough: bool) -> str:
        """Return what can be done now, for people."""
        n_pictures = len(book.used_names)
        if self._maker.busy:
            return "Training. You can go on looking at landmarks meanwhile."
        if not enough:
            return f"{book.n_usable} pictures show a face, at least {LEAST_PICTURES} are needed."
        if trained and not book.outdated:
            return f"Trained with {n_pictures} pictures."
        if trained:
            return "Pictures or landmarks have changed since the last training: train again."
        return f"{n_pictures} pictures are ready. The training takes one to two minutes."

    def _on_noted(self, progress: Progress) -> None:
        plot = progress.plot
        self._page.stages.show_progress(progress.label, progress.done / max(progress.total, 1))
        if {"focal_px", "error"} <= plot.keys():
            self._focals.append((plot["focal_px"], plot["error"]))
            self._page.show_focal([px for px, _ in self._focals], [e for _, e in self._focals])
        if "stage" in plot:
            for key in plot.keys() - {"stage", "left_mm"}:
                self._stages.setdefault(key, []).append(plot[key])
            self._page.show_stage_errors(self._stages)

    def _on_made(self, text: object) -> None:
        self._ended = True
        self.trained.emit()

    def _on_failed(self, error: Exception) -> None:
        self._ended = True
        kept = " The profile is as it was." if self._book and self._book.profile else ""
        self._page.message_bar.tell(f"The training failed: {error}.{kept}")

    def _on_finished(self) -> None:
        self._page.end()
        if not self._ended:
            self._page.message_bar.tell("The training was stopped. Nothing has changed.")
        if self._book is not None:
            self.show(self._book)

    def _on_export(self) -> None:
        book = self._book
        if book is None or book.profile is None:
            return
        name, page = book.folder.name, self._page
        body = report_html(name, book.profile.report, links=False)

        def write(path: str) -> None:
            try:
                written = write_report(Path(path), name, body, page.plot_images())
            except AppError as error:
                page.message_bar.tell(str(error))
            else:
                page.message_bar.announce(f"The report is in {written}")

        ask_where_to_save(page, "Export the report", f"{name}.html", write, FILTERS)
