"""The takes, each with a line of what is to be known about it."""

from collections.abc import Sequence
from typing import NamedTuple

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QSize, Qt, Signal
from PySide6.QtGui import QPainter, QPalette
from PySide6.QtWidgets import (
    QListWidget,
    QListWidgetItem,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QWidget,
)

DETAILS_ROLE = Qt.ItemDataRole.UserRole
PAD = 5

Index = QModelIndex | QPersistentModelIndex


class TakeEntry(NamedTuple):
    """A take in the list: its name, and the rest in a line."""

    name: str
    details: str


class TakeList(QListWidget):
    """Shows takes; says which one is chosen and which is to be played."""

    selected = Signal(str)  # empty: none
    opened = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Takes")
        self.setItemDelegate(_TwoLines(self))
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setMinimumHeight(4 * self.fontMetrics().lineSpacing())
        self.currentItemChanged.connect(lambda *_: self.selected.emit(self.current))
        self.itemActivated.connect(lambda item: self.opened.emit(item.text()))

    @property
    def current(self) -> str:
        """Name of the chosen take, "" without one."""
        item = self.currentItem()
        return "" if item is None else item.text()

    @property
    def entries(self) -> list[TakeEntry]:
        """What is listed."""
        items = [self.item(row) for row in range(self.count())]
        return [TakeEntry(item.text(), item.data(DETAILS_ROLE)) for item in items]

    def sizeHint(self) -> QSize:
        """Return room for a few takes."""
        return QSize(280, 9 * self.fontMetrics().lineSpacing())

    def show_entries(self, entries: Sequence[TakeEntry], current: str = "") -> None:
        """List takes; one is chosen, if it is there."""
        blocked = self.blockSignals(True)
        self.clear()
        for entry in entries:
            item = QListWidgetItem(entry.name, self)
            item.setData(DETAILS_ROLE, entry.details)
            item.setData(Qt.ItemDataRole.AccessibleTextRole, f"{entry.name}, {entry.details}")
            item.setToolTip(f"{entry.name}\n{entry.details}")
            if entry.name == current:
                self.setCurrentItem(item)
        self.blockSignals(blocked)
        self.selected.emit(self.current)


class _TwoLines(QStyledItemDelegate):
    """Draws the name above the rest."""

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:
        """Return room for two lines."""
        return QSize(100, 2 * option.fontMetrics.lineSpacing() + 2 * PAD)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Draw the ground, then both lines."""
        self.initStyleOption(option, index)
        option.text = ""
        widget = option.widget
        widget.style().drawControl(QStyle.ControlElement.CE_ItemViewItem, option, painter, widget)
        chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        role = QPalette.ColorRole.HighlightedText if chosen else QPalette.ColorRole.Text
        painter.save()
        painter.setPen(option.palette.color(role))
        font = painter.font()
        font.setBold(True)
        painter.setFont(font)
        box: QRect = option.rect.adjusted(PAD, PAD, -PAD, -PAD)
        self._line(painter, box, index.data(Qt.ItemDataRole.DisplayRole))
        font.setBold(False)
        painter.setFont(font)
        self._line(painter, box.adjusted(0, box.height() // 2, 0, 0), index.data(DETAILS_ROLE))
        painter.restore()

    def _line(self, painter: QPainter, box: QRect, text: str) -> None:
        shown = painter.fontMetrics().elidedText(text, Qt.TextElideMode.ElideRight, box.width())
        top = QRect(box.left(), box.top(), box.width(), painter.fontMetrics().lineSpacing())
        painter.drawText(top, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, shown)
