"""The page of the 46 coefficients: a table, and buttons for what is full and what is usual."""

from dataclasses import replace

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QComboBox,
    QGridLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from app.views.control.live_bar import BarDelegate, NumberDelegate
from app.views.control.response_model import BAR, NAME, Live, ResponseModel
from app.views.control.words import PARTS, short_name
from core.arkit import EXPRESSION_NAMES
from core.drive_settings import DriveSettings, Response

LEGEND = (
    "Blue: your face; grey: the avatar; black lines: the least and greatest seen. "
    "A dot is the usual number."
)


class ResponsePage(QWidget):
    """Shows gain, range and offset of every coefficient with its live value."""

    changed = Signal(object, str)  # DriveSettings, what was changed
    full_wanted = Signal(object)  # list of indices, or None for all that the face shows
    range_wanted = Signal(object)  # the same, for the greatest value that was seen
    forget_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._settings = DriveSettings()
        self.model, self.table, self.part = ResponseModel(), QTableView(), QComboBox()
        self.face_button = QPushButton("&This face is 100 %")
        self.full_button = QPushButton("S&elected as 100 %")
        self.reset_button = QPushButton("&Reset selected")
        self.reset_all_button = QPushButton("Reset all")
        self.range_button = QPushButton("Greatest &seen is 100 %")
        self.forget_button = QPushButton("For&get what was seen")
        self._build_table()
        self._build()
        self._connect()

    @property
    def selected(self) -> list[int]:
        """The selected coefficients."""
        return sorted(index.row() for index in self.table.selectionModel().selectedRows())

    def show_settings(self, settings: DriveSettings) -> None:
        """Show settings; nothing is emitted."""
        self._settings = settings
        self.model.show_settings(settings)

    def show_live(self, live: Live | None) -> None:
        """Show live values, or none."""
        self.model.show_live(live)

    def _build_table(self) -> None:
        table = self.table
        table.setModel(self.model)
        table.setAccessibleName("Coefficients")
        table.setAccessibleDescription("F2 or a digit changes the number in the current cell")
        table.setItemDelegate(NumberDelegate(table))
        table.setItemDelegateForColumn(BAR, BarDelegate(table))
        table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        table.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
            | QAbstractItemView.EditTrigger.AnyKeyPressed
            | QAbstractItemView.EditTrigger.SelectedClicked
        )
        table.setShowGrid(False)
        table.setAlternatingRowColors(True)
        table.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        # Tab leaves the table; arrows move in it.
        table.setTabKeyNavigation(False)
        table.verticalHeader().hide()
        table.verticalHeader().setDefaultSectionSize(table.fontMetrics().height() + 7)
        head = table.horizontalHeader()
        head.setHighlightSections(False)
        head.setMinimumSectionSize(30)
        number_width = table.fontMetrics().horizontalAdvance("0.00") + 8
        for column in range(self.model.columnCount()):
            head.setSectionResizeMode(column, QHeaderView.ResizeMode.Fixed)
            table.setColumnWidth(column, number_width)
        head.setSectionResizeMode(BAR, QHeaderView.ResizeMode.Stretch)
        names = (table.fontMetrics().horizontalAdvance(short_name(n)) for n in EXPRESSION_NAMES)
        table.setColumnWidth(NAME, max(names) + 8)
        table.setCurrentIndex(self.model.index(0, NAME))
        table.clearSelection()

    def _build(self) -> None:
        for name in PARTS:
            self.part.addItem(name)
        self.part.setAccessibleName("Part of the face")
        label = QLabel("Sh&ow")
        label.setBuddy(self.part)
        for button, tip in (
            (self.face_button, "Make the face you want as 100 % and press this: everything that it "
             "clearly shows becomes full"),
            (self.full_button, "What is tracked now becomes 100 % of the selected coefficients"),
            (self.reset_button, "Gain, range and offset of the selected coefficients as usual"),
            (self.reset_all_button, "Gain, range and offset of all coefficients as usual"),
            (self.range_button, "The right one of the two thin lines in each bar, the greatest "
             "value seen so far, becomes 100 %: of the selected coefficients, or of all if none is "
             "selected. Talk and make faces first"),
            (self.forget_button, "Begin anew with the two thin lines in each bar: the least and "
             "the greatest value seen so far"),
        ):  # fmt: skip
            button.setToolTip(tip)
            button.setAccessibleDescription(tip)
        grid = QGridLayout()
        grid.addWidget(self.face_button, 0, 0)
        grid.addWidget(self.full_button, 0, 1)
        grid.addWidget(self.reset_button, 1, 0)
        grid.addWidget(self.reset_all_button, 1, 1)
        grid.addWidget(self.range_button, 2, 0)
        grid.addWidget(self.forget_button, 2, 1)
        top = QGridLayout()
        top.addWidget(label, 0, 0)
        top.addWidget(self.part, 0, 1)
        top.setColumnStretch(1, 1)
        legend = QLabel(LEGEND)
        legend.setWordWrap(True)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addLayout(top)
        layout.addWidget(self.table, stretch=1)
        layout.addWidget(legend)
        layout.addLayout(grid)

    def _connect(self) -> None:
        self.model.changed.connect(self._on_changed)
        self.part.currentTextChanged.connect(self._show_part)
        self.face_button.clicked.connect(lambda: self.full_wanted.emit(None))
        self.full_button.clicked.connect(lambda: self.full_wanted.emit(self.selected))
        self.reset_button.clicked.connect(lambda: self._reset(self.selected, "selected"))
        self.reset_all_button.clicked.connect(
            lambda: self._reset(list(range(len(EXPRESSION_NAMES))), "all")
        )
        self.range_button.clicked.connect(lambda: self.range_wanted.emit(self.selected or None))
        self.forget_button.clicked.connect(self.forget_wanted)
        self.table.selectionModel().selectionChanged.connect(self._show_selection)
        self._show_selection()

    def _show_selection(self) -> None:
        """Offer what needs a selection only with one."""
        for button in (self.full_button, self.reset_button):
            button.setEnabled(bool(self.selected))

    def _show_part(self, part: str) -> None:
        for row, name in enumerate(EXPRESSION_NAMES):
            self.table.setRowHidden(row, not name.startswith(PARTS[part]))
        self.table.clearSelection()

    def _on_changed(self, settings: DriveSettings, what: str) -> None:
        self._settings = settings
        self.changed.emit(settings, what)

    def _reset(self, rows: list[int], what: str) -> None:
        responses = list(self._settings.responses)
        for row in rows:
            responses[row] = Response()
        if tuple(responses) != self._settings.responses:
            self.show_settings(replace(self._settings, responses=tuple(responses)))
            self.changed.emit(self._settings, f"reset {what}")
