"""All prompts at a glance: which are still missing, which are weak, and why."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QEvent, QModelIndex, QPersistentModelIndex, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPen
from PySide6.QtWidgets import (
    QListView,
    QListWidgetItem,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QWidget,
)

from app.views.cell_list import CELL_ROLE, THUMB_ROLE, CellList
from app.views.editor.painting import small

CELL = QSize(78, 62)
#: State -> colour of its bar; the mark beside it says the same.
COLORS = {
    "missing": QColor(120, 124, 130), "good": QColor(0, 158, 115), "weak": QColor(230, 159, 0),
}  # fmt: skip
WRAPPED = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap)
MARKS = {"missing": "", "good": "✓", "weak": "!"}


@dataclass(frozen=True, slots=True)
class SheetCell:
    """One prompt.

    Attributes:
        name: The shot's name.
        title: Short, for people.
        state: A key of COLORS.
        note: What is to be known about it, for the tooltip.
        why: Why it is weak, in some words, "" if it is not; the picture stays free of it.
    """

    name: str
    title: str
    state: str
    note: str
    why: str = ""


class ContactSheet(CellList):
    """A grid of prompts; a click retakes one."""

    noted = Signal(str)  # what is to be known of the cell under the hand, or else the current one

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("All prompts", parent)
        self.setViewMode(QListView.ViewMode.IconMode)
        self.setMovement(QListView.Movement.Static)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setSpacing(2)
        self.setItemDelegate(_CellPainter(self))
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.itemClicked.connect(self._choose)
        self.itemActivated.connect(self._choose)
        self.setMouseTracking(True)
        self.itemEntered.connect(self._note)
        self.currentItemChanged.connect(lambda item, _: self._note(item))

    def states(self) -> dict[str, str]:
        """Return the state of every prompt."""
        return {cell.name: cell.state for cell in self.cells()}

    def show_cells(self, cells: Sequence[SheetCell]) -> None:
        """List the prompts."""
        self.clear()
        for cell in cells:
            _fill(QListWidgetItem(self), cell)

    def show_cell(self, cell: SheetCell, thumb: QImage | None) -> None:
        """Change one prompt."""
        item = self.item_of(cell.name)
        if item is not None:
            self.show_thumb(cell.name, thumb)
            _fill(item, cell)
            if item is self.currentItem():
                self._note(item)

    def leaveEvent(self, event: QEvent) -> None:
        """Tell of the current cell again."""
        self._note(self.currentItem())
        super().leaveEvent(event)

    def _note(self, item: QListWidgetItem | None) -> None:
        self.noted.emit("" if item is None else item.toolTip())


def _fill(item: QListWidgetItem, cell: SheetCell) -> None:
    item.setData(CELL_ROLE, cell)
    told = f"{cell.title}: {cell.note}" if cell.note else cell.title
    item.setToolTip(told)
    item.setData(Qt.ItemDataRole.AccessibleTextRole, f"{told}, {cell.state}")


class _CellPainter(QStyledItemDelegate):
    """Paints a thumbnail, or an empty frame with the prompt's name."""

    def sizeHint(
        self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> QSize:
        """Return the size of a cell."""
        return CELL

    def paint(
        self,
        painter: QPainter,
        option: QStyleOptionViewItem,
        index: QModelIndex | QPersistentModelIndex,
    ) -> None:
        """Paint one cell."""
        cell, thumb = index.data(CELL_ROLE), index.data(THUMB_ROLE)
        box = QRectF(option.rect).adjusted(2, 2, -2, -2)
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.fillRect(box, QColor(44, 47, 52))
        painter.setFont(small(option.font))
        if thumb is not None:
            painter.drawImage(box, thumb)
        else:
            painter.setPen(QColor(205, 209, 214))
            painter.drawText(box.adjusted(3, 2, -3, -6), WRAPPED, cell.title)
        painter.fillRect(QRectF(box.left(), box.bottom() - 5, box.width(), 5), COLORS[cell.state])
        if MARKS[cell.state]:
            _paint_mark(painter, box, cell.state)
        if self.parent().currentRow() == index.row():  # type: ignore[union-attr]
            painter.setPen(QPen(QColor(255, 220, 80), 2.5))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(box.adjusted(1, 1, -1, -1))
        painter.restore()


def _paint_mark(painter: QPainter, box: QRectF, state: str) -> None:
    badge = QRectF(box.right() - 17, box.top() + 2, 15, 15)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(COLORS[state])
    painter.drawEllipse(badge)
    painter.setPen(QColor(10, 14, 18))
    painter.drawText(badge, Qt.AlignmentFlag.AlignCenter, MARKS[state])
