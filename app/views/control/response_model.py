"""The 46 coefficients as a table: name, live bar, gain, range, offset."""

from dataclasses import fields, replace
from typing import Any, NamedTuple

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, Qt, Signal

from app.views.control.words import plain_name, short_name
from core.arkit import EXPRESSION_NAMES
from core.drive_settings import DriveSettings, Response
from core.records import FloatArray

Index = QModelIndex | QPersistentModelIndex
Role = Qt.ItemDataRole
BAR_ROLE, LIMITS_ROLE = Role.UserRole + 1, Role.UserRole + 2
NAME, BAR = 0, 1


class LiveValue(NamedTuple):
    """What a bar shows, all in [0, 1].

    Attributes:
        tracked: Now.
        shown: What the avatar shows.
        seen: Least and greatest tracked value.
        low: Tracked value that counts as 0.
        high: Tracked value that counts as 1.
    """

    tracked: float
    shown: float
    seen: tuple[float, float]
    low: float
    high: float


class Live(NamedTuple):
    """The live values of all coefficients: (B,), (B,), (B, 2)."""

    tracked: FloatArray
    shown: FloatArray
    seen: FloatArray


class Column(NamedTuple):
    """A column of numbers: field of Response, head, what it means."""

    field: str
    head: str
    tip: str


COLUMNS = (
    Column("gain", "Gain", "Multiplies what is left of the range: more or less of this"),
    Column("low", "From", "The tracked value that counts as 0: raise it where it shows too early"),
    Column(
        "high", "To", "The tracked value that counts as full: lower it where you cannot reach it"
    ),
    Column("offset", "Add", "Added at the end: a little of this at rest, or less of it"),
)
LIVE_TIP = (
    "Thick: as tracked, with marks at the least and greatest seen; thin: as the avatar shows it; "
    "the lighter part is the range that counts"
)
_LIMITS = {
    entry.name: (entry.metadata["low"], entry.metadata["high"]) for entry in fields(Response)
}


class ResponseModel(QAbstractTableModel):
    """Shows settings and live values; emits settings in which a number was changed."""

    changed = Signal(object, str)  # DriveSettings, what was changed

    def __init__(self) -> None:
        super().__init__()
        self._settings = DriveSettings()
        self._live: Live | None = None

    def show_settings(self, settings: DriveSettings) -> None:
        """Show settings; nothing is emitted."""
        self._settings = settings
        last = self.index(self.rowCount() - 1, self.columnCount() - 1)
        self.dataChanged.emit(self.index(0, BAR), last)

    def show_live(self, live: Live | None) -> None:
        """Show live values, or none."""
        self._live = live
        self.dataChanged.emit(self.index(0, BAR), self.index(self.rowCount() - 1, BAR))

    def value(self, row: int) -> LiveValue:
        """Return what the bar of a coefficient shows."""
        response, live = self._settings.responses[row], self._live
        if live is None:
            return LiveValue(0.0, 0.0, (0.0, 0.0), response.low, response.high)
        seen = float(live.seen[row, 0]), float(live.seen[row, 1])
        return LiveValue(
            float(live.tracked[row]), float(live.shown[row]), seen, response.low, response.high
        )

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own default
        """Return the number of coefficients."""
        return 0 if parent.isValid() else len(EXPRESSION_NAMES)

    def columnCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008  Qt's own default
        """Return the number of columns."""
        return 0 if parent.isValid() else 2 + len(COLUMNS)

    def headerData(
        self, section: int, orientation: Qt.Orientation, role: int = Role.DisplayRole
    ) -> Any:
        """Return the head of a column."""
        if orientation != Qt.Orientation.Horizontal:
            return None
        if role == Role.DisplayRole:
            return ("Coefficient", "Live", *(column.head for column in COLUMNS))[section]
        if role == Role.ToolTipRole:
            return ("", LIVE_TIP, *(column.tip for column in COLUMNS))[section] or None
        return None

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Return what can be done with a cell: numbers can be edited."""
        usual = Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsEnabled
        return usual | Qt.ItemFlag.ItemIsEditable if index.column() > BAR else usual

    def data(self, index: Index, role: int = Role.DisplayRole) -> Any:
        """Return what a cell shows."""
        row, column = index.row(), index.column()
        if column == NAME:
            return self._name_data(row, role)
        if column == BAR:
            return self._bar_data(row, role)
        return self._number_data(row, COLUMNS[column - 2], role)

    def setData(self, index: Index, value: Any, role: int = Role.EditRole) -> bool:
        """Change a number within its limits."""
        if role != Role.EditRole or index.column() <= BAR:
            return False
        field = COLUMNS[index.column() - 2].field
        low, high = _LIMITS[field]
        number = round(min(max(float(value), low), high), 4)
        responses = list(self._settings.responses)
        if getattr(responses[index.row()], field) == number:
            return False
        responses[index.row()] = replace(responses[index.row()], **{field: number})
        self.show_settings(replace(self._settings, responses=tuple(responses)))
        self.changed.emit(self._settings, f"{EXPRESSION_NAMES[index.row()]}.{field}")
        return True

    def _name_data(self, row: int, role: int) -> Any:
        if role == Role.DisplayRole:
            return short_name(EXPRESSION_NAMES[row])
        told = (Role.AccessibleTextRole, Role.ToolTipRole)
        return plain_name(EXPRESSION_NAMES[row]) if role in told else None

    def _bar_data(self, row: int, role: int) -> Any:
        value = self.value(row)
        if role == BAR_ROLE:
            return value
        if role in (Role.AccessibleTextRole, Role.ToolTipRole):
            return (
                f"{plain_name(EXPRESSION_NAMES[row])}: tracked {value.tracked:.2f}, shown "
                f"{value.shown:.2f}, seen {value.seen[0]:.2f} to {value.seen[1]:.2f}"
            )
        return None

    def _number_data(self, row: int, column: Column, role: int) -> Any:
        number = getattr(self._settings.responses[row], column.field)
        if role == Role.DisplayRole:
            # What is as usual stays out of the way.
            return "·" if number == getattr(Response(), column.field) else f"{number:.2f}"
        if role == Role.EditRole:
            return number
        if role == LIMITS_ROLE:
            return _LIMITS[column.field]
        if role == Role.AccessibleTextRole:
            return f"{plain_name(EXPRESSION_NAMES[row])}, {column.head.lower()}: {number:.2f}"
        if role == Role.ToolTipRole:
            return column.tip
        return int(Qt.AlignmentFlag.AlignCenter) if role == Role.TextAlignmentRole else None
