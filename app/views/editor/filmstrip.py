"""The pictures of a profile, the most suspicious first."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPen
from PySide6.QtWidgets import (
    QAbstractItemView,
    QListWidgetItem,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QWidget,
)

from app.views.cell_list import CELL_ROLE, THUMB_ROLE, CellList
from app.views.editor.painting import small

THUMB = QSize(116, 87)
#: Level of suspicion -> bar's colour and the word beside it.
LEVELS = {
    "good": (QColor(0, 158, 115), "good"),
    "look": (QColor(230, 159, 0), "look"),
    "bad": (QColor(213, 94, 0), "check"),
    "out": (QColor(120, 124, 130), "left out"),
}


@dataclass(frozen=True, slots=True)
class Cell:
    """What the strip says about a picture.

    Attributes:
        name: Its name.
        title: The name as people read it.
        level: A key of LEVELS.
        note: Why, for the tooltip.
        edited: Whether the user has placed points.
    """

    name: str
    title: str
    level: str
    note: str
    edited: bool


class Filmstrip(CellList):
    """A column of thumbnails."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Pictures, the most suspicious first", parent)
        self.setItemDelegate(_CellPainter(self))
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFixedWidth(THUMB.width() + 46)
        self.currentItemChanged.connect(self._choose)

    def show_cells(self, cells: Sequence[Cell], current: str) -> None:
        """List pictures, one of them as the one shown large."""
        self._filling = True
        self.clear()
        for cell in cells:
            _fill(QListWidgetItem(self), cell)
        self._filling = False
        self.show_current(current)

    def show_cell(self, cell: Cell) -> None:
        """Change what is said about one picture, in its place."""
        item = self.item_of(cell.name)
        if item is not None:
            _fill(item, cell)


def _fill(item: QListWidgetItem, cell: Cell) -> None:
    item.setData(CELL_ROLE, cell)
    item.setToolTip(f"{cell.title}: {cell.note}")
    item.setData(Qt.ItemDataRole.AccessibleTextRole, f"{cell.title}, {LEVELS[cell.level][1]}")


class _CellPainter(QStyledItemDelegate):
    """Paints a thumbnail with its name, its level and a mark of the hand."""

    def sizeHint(
        self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> QSize:
        """Return the size of a cell."""
        line = QFontMetrics(small(option.font)).height()
        return QSize(THUMB.width() + 16, THUMB.height() + line + 14)

    def paint(
        self,
        painter: QPainter,
        option: QStyleOptionViewItem,
        index: QModelIndex | QPersistentModelIndex,
    ) -> None:
        """Paint one cell."""
        cell, thumb = index.data(CELL_ROLE), index.data(THUMB_ROLE)
        painter.save()
        chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        if chosen:
            painter.fillRect(option.rect, option.palette.highlight())
        box = QRectF(option.rect.left() + 8, option.rect.top() + 5, THUMB.width(), THUMB.height())
        painter.fillRect(box, QColor(32, 34, 37))
        if thumb is not None:
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.setOpacity(0.35 if cell.level == "out" else 1.0)
            painter.drawImage(box, thumb)
            painter.setOpacity(1.0)
        color, word = LEVELS[cell.level]
        painter.fillRect(QRectF(box.left(), box.bottom() - 4, box.width(), 4), color)
        painter.setFont(small(option.font))
        role = option.palette.ColorRole
        painter.setPen(option.palette.color(role.HighlightedText if chosen else role.Text))
        line = QRectF(
            box.left(), box.bottom() + 1, box.width(), option.rect.bottom() - box.bottom()
        )
        metrics = painter.fontMetrics()
        room = int(box.width() - metrics.horizontalAdvance(word) - 6)
        title = metrics.elidedText(cell.title, Qt.TextElideMode.ElideMiddle, room)
        painter.drawText(line, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, title)
        painter.drawText(line, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, word)
        if cell.edited:
            painter.setPen(QPen(QColor(10, 20, 30), 1))
            painter.setBrush(QColor(240, 228, 66))
            painter.drawRect(QRectF(box.right() - 14, box.top() + 4, 9, 9))
        painter.restore()
