"""The stages of a training, one below the other, with how far each is."""

from collections.abc import Mapping

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QLabel, QProgressBar, QWidget

WAITING, RUNNING, DONE = "·", "▶", "✓"
_WORDS = {WAITING: "waiting", RUNNING: "at work", DONE: "done"}


class StageList(QWidget):
    """Says of every stage whether it is done, at work or still to come."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Stages of the training")
        self._marks: dict[str, QLabel] = {}
        self._bars: dict[str, QProgressBar] = {}
        self._spans: dict[str, tuple[float, float]] = {}
        self._grid = QGridLayout(self)
        self._grid.setColumnStretch(2, 1)
        self._grid.setVerticalSpacing(8)

    def states(self) -> dict[str, str]:
        """Return the mark of every stage."""
        return {label: mark.text() for label, mark in self._marks.items()}

    def percents(self) -> dict[str, int]:
        """Return how far every stage is."""
        return {label: bar.value() for label, bar in self._bars.items()}

    def show_stages(self, shares: Mapping[str, float]) -> None:
        """List stages that are still to come: what they do, and their share of the work."""
        while self._grid.count():
            taken = self._grid.takeAt(0)
            widget = taken.widget() if taken is not None else None
            if widget is not None:
                widget.hide()
                widget.deleteLater()
        self._marks, self._bars, self._spans, before = {}, {}, {}, 0.0
        for row, (label, share) in enumerate(shares.items()):
            self._spans[label] = before, before + share
            before += share
            self._add(row, label)

    def show_progress(self, label: str, share: float) -> None:
        """Say which stage is at work.

        Args:
            label: What is being done; what is no stage comes after all of them.
            share: Of the whole work that is done, in [0, 1].
        """
        order = list(self._spans)
        place = order.index(label) if label in order else len(order)
        for row, stage in enumerate(order):
            first, last = self._spans[stage]
            inside = (share - first) / max(last - first, 1e-9)
            percent = 100 if row < place else round(100 * min(max(inside, 0.0), 1.0))
            mark = DONE if row < place else RUNNING if row == place else WAITING
            self._bars[stage].setValue(percent if row <= place else 0)
            self._marks[stage].setText(mark)
            self._marks[stage].setAccessibleName(f"{stage}: {_WORDS[mark]}")

    def _add(self, row: int, label: str) -> None:
        mark, text, bar = QLabel(WAITING), QLabel(label), QProgressBar()
        mark.setFixedWidth(3 * self.fontMetrics().averageCharWidth())
        mark.setAlignment(Qt.AlignmentFlag.AlignCenter)
        mark.setAccessibleName(f"{label}: {_WORDS[WAITING]}")
        bar.setRange(0, 100)
        bar.setValue(0)
        bar.setAccessibleName(f"Progress of: {label}")
        for column, widget in enumerate((mark, text, bar)):
            self._grid.addWidget(widget, row, column)
        self._marks[label], self._bars[label] = mark, bar
