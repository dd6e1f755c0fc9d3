"""All prompts at a glance: which are still missing, which are weak, and why."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPen
from PySide6.QtWidgets import (
    QListView,
    QListWidget,
    QListWidgetItem,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QWidget,
)

from app.views.editor.painting import small

CELL = QSize(78, 62)
_CELL, _THUMB = Qt.ItemDataRole.UserRole, Qt.ItemDataRole.UserRole + 1
#: State -> colour of its bar; the mark beside it says the same.
COLORS = {
    "missing": QColor(120, 124, 130), "good": QColor(0, 158, 115), "weak": QColor(230, 159, 0),
}  # fmt: skip
MARKS = {"missing": "", "good": "✓", "weak": "!"}


@dataclass(frozen=True, slots=True)
class SheetCell:
    """One prompt.

    Attributes:
        name: The shot's name.
        title: Short, for people.
        state: A key of COLORS.
        note: What is to be known about it, for the tooltip.
    """

    name: str
    title: str
    state: str
    note: str


class ContactSheet(QListWidget):
    """A grid of prompts; a click retakes one."""

    chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("All prompts")
        self.setViewMode(QListView.ViewMode.IconMode)
        self.setMovement(QListView.Movement.Static)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setUniformItemSizes(True)
        self.setSpacing(2)
        self.setItemDelegate(_CellPainter(self))
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.itemClicked.connect(self._on_taken)
        self.itemActivated.connect(self._on_taken)

    def states(self) -> dict[str, str]:
        """Return the state of every prompt."""
        cells = (self.item(row).data(_CELL) for row in range(self.count()))
        return {cell.name: cell.state for cell in cells}

    def show_cells(self, cells: Sequence[SheetCell]) -> None:
        """List the prompts."""
        self.clear()
        for cell in cells:
            self._fill(QListWidgetItem(self), cell)

    def show_cell(self, cell: SheetCell, thumb: QImage | None) -> None:
        """Change one prompt."""
        for row in range(self.count()):
            if self.item(row).data(_CELL).name == cell.name:
                self.item(row).setData(_THUMB, thumb)
                self._fill(self.item(row), cell)

    def show_current(self, name: str) -> None:
        """Mark the prompt that is asked for."""
        for row in range(self.count()):
            if self.item(row).data(_CELL).name == name:
                self.setCurrentRow(row)
                self.scrollToItem(self.item(row))

    def _fill(self, item: QListWidgetItem, cell: SheetCell) -> None:
        item.setData(_CELL, cell)
        told = f"{cell.title}: {cell.note}" if cell.note else cell.title
        item.setToolTip(told)
        item.setData(Qt.ItemDataRole.AccessibleTextRole, f"{told}, {cell.state}")

    def _on_taken(self, item: QListWidgetItem) -> None:
        self.chosen.emit(item.data(_CELL).name)


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
        cell, thumb = index.data(_CELL), index.data(_THUMB)
        box = QRectF(option.rect).adjusted(2, 2, -2, -2)
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.fillRect(box, QColor(44, 47, 52))
        painter.setFont(small(option.font))
        if thumb is not None:
            painter.drawImage(box, thumb)
        else:
            painter.setPen(QColor(205, 209, 214))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(box.adjusted(3, 2, -3, -6), int(flags), cell.title)
        painter.fillRect(QRectF(box.left(), box.bottom() - 5, box.width(), 5), COLORS[cell.state])
        if MARKS[cell.state]:
            badge = QRectF(box.right() - 17, box.top() + 2, 15, 15)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(COLORS[cell.state])
            painter.drawEllipse(badge)
            painter.setPen(QColor(10, 14, 18))
            painter.drawText(badge, Qt.AlignmentFlag.AlignCenter, MARKS[cell.state])
        if self.parent().currentRow() == index.row():  # type: ignore[union-attr]
            painter.setPen(QPen(QColor(255, 220, 80), 2.5))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(box.adjusted(1, 1, -1, -1))
        painter.restore()
