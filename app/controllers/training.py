"""The training page at work."""

from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from app.controllers.profile_maker import ProfileMaker
from app.report import report_html, report_page
from app.views.files import ask_where_to_save
from app.views.setup.train_page import TrainPage
from app.workbook import Workbook
from core.errors import CoreError
from core.pipeline import LEAST_PICTURES
from core.records import Progress

#: The steps of a training, which return what to tell the user.
Train = Callable[[Workbook], Generator[Progress, None, object]]


class TrainingController(QObject):
    """Joins the training page with a workbook."""

    trained = Signal()
    picture_wanted = Signal(str)
    live_wanted = Signal()

    def __init__(self, page: TrainPage, train: Train, parent: QObject | None = None) -> None:
        super().__init__(parent or page)
        self._page, self._train = page, train
        self._book: Workbook | None = None
        self._maker = ProfileMaker(self)
        self._focals: list[tuple[float, float]] = []
        page.train_wanted.connect(self.train)
        page.live_wanted.connect(self.live_wanted)
        page.export_wanted.connect(self._on_export)
        page.picture_wanted.connect(self.picture_wanted)
        page.job_row.cancel_wanted.connect(self._maker.cancel)
        self._maker.progressed.connect(page.job_row.show_progress)
        self._maker.noted.connect(self._on_noted)
        self._maker.made.connect(lambda _: self.trained.emit())
        self._maker.failed.connect(self._on_failed)
        self._maker.finished.connect(self._on_finished)

    @property
    def busy(self) -> bool:
        """Whether a training runs."""
        return self._maker.busy

    def show(self, book: Workbook) -> None:
        """Show what can be trained, and the report of what was."""
        self._book = book
        profile = book.profile
        if profile is not None:
            report: Any = profile.report
            curve = report.get("focal_curve") or []
            self._page.show_focal([row[0] for row in curve], [row[1] for row in curve])
            self._page.show_residuals(report.get("picture_rms_px_at_640") or [])
            self._page.show_report(report_html(book.folder.name, report))
        self._show_state()

    def train(self) -> None:
        """Begin a training; what there is stays until it is complete."""
        if self._book is None or self._maker.busy:
            return
        self._focals = []
        self._page.job_row.begin("Training")
        self._maker.start(self._train(self._book))
        self._show_state()

    def stop(self) -> None:
        """End a training that runs; the profile stays as it was."""
        self._maker.stop()

    def _show_state(self) -> None:
        book = self._book
        if book is None:
            return
        n_pictures, trained = len(book.names), book.profile is not None
        enough = book.n_usable >= LEAST_PICTURES
        if self._maker.busy:
            text = "Training. You can go on looking at landmarks meanwhile."
        elif not enough:
            text = f"{book.n_usable} pictures show a face, at least {LEAST_PICTURES} are needed."
        elif trained and not book.outdated:
            text = f"Trained with {n_pictures} pictures."
        elif trained:
            text = "Pictures or landmarks have changed since the last training."
        else:
            text = f"{n_pictures} pictures are ready. The training takes one to two minutes."
        self._page.show_state(text, enough and not self._maker.busy, trained)

    def _on_noted(self, progress: Progress) -> None:
        if {"focal_px", "error"} <= progress.plot.keys():
            self._focals.append((progress.plot["focal_px"], progress.plot["error"]))
            self._page.show_focal([px for px, _ in self._focals], [e for _, e in self._focals])

    def _on_failed(self, error: Exception) -> None:
        self._page.show_report(f"<p><b>The training failed.</b> {error}</p>")

    def _on_finished(self) -> None:
        self._page.job_row.end()
        if self._book is not None:
            self.show(self._book)

    def _on_export(self) -> None:
        book = self._book
        if book is None or book.profile is None:
            return
        name = book.folder.name
        html = report_page(name, report_html(name, book.profile.report, links=False))

        def write(path: str) -> None:
            try:
                Path(path).write_text(html, encoding="utf-8")
            except OSError as error:
                self._on_failed(CoreError(f"cannot write {path}: {error.strerror or error}"))

        ask_where_to_save(self._page, "Export the report", f"{book.folder.name}.html", write)
