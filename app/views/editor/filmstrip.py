"""The pictures of a profile, the most suspicious first."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QImage, QPainter, QPen
from PySide6.QtWidgets import (
    QAbstractItemView,
    QListWidget,
    QListWidgetItem,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QWidget,
)

from app.views.editor.painting import small

THUMB = QSize(116, 87)
_THUMB, _CELL = Qt.ItemDataRole.UserRole, Qt.ItemDataRole.UserRole + 1
#: Level of suspicion -> bar's colour and the word beside it.
LEVELS = {
    "good": (QColor(0, 158, 115), "good"),
    "look": (QColor(230, 159, 0), "look"),
    "bad": (QColor(213, 94, 0), "check"),
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


class Filmstrip(QListWidget):
    """A column of thumbnails."""

    chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Pictures, the most suspicious first")
        self.setItemDelegate(_CellPainter(self))
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setUniformItemSizes(True)
        self.setFixedWidth(THUMB.width() + 46)
        self.currentItemChanged.connect(self._on_current)
        self._filling = False

    @property
    def names(self) -> list[str]:
        """The pictures' names in the order shown."""
        return [self._cell(row).name for row in range(self.count())]

    def show_cells(self, cells: Sequence[Cell], current: str) -> None:
        """List pictures anew; thumbnails of those that stay are kept."""
        thumbs = {self._cell(row).name: self.item(row).data(_THUMB) for row in range(self.count())}
        self._filling = True
        self.clear()
        for cell in cells:
            item = QListWidgetItem(self)
            item.setData(_THUMB, thumbs.get(cell.name))
            self._fill(item, cell)
        self._filling = False
        self.show_current(current)

    def show_cell(self, cell: Cell) -> None:
        """Change what is said about one picture, in its place."""
        for row in range(self.count()):
            if self._cell(row).name == cell.name:
                self._fill(self.item(row), cell)

    def show_thumb(self, name: str, image: QImage) -> None:
        """Show a picture's thumbnail."""
        for row in range(self.count()):
            if self._cell(row).name == name:
                self.item(row).setData(_THUMB, image)

    def show_current(self, name: str) -> None:
        """Mark the picture that is shown large."""
        self._filling = True
        for row in range(self.count()):
            if self._cell(row).name == name:
                self.setCurrentRow(row)
                self.scrollToItem(self.item(row))
        self._filling = False

    def _fill(self, item: QListWidgetItem, cell: Cell) -> None:
        item.setData(_CELL, cell)
        item.setToolTip(f"{cell.title}: {cell.note}")
        item.setData(Qt.ItemDataRole.AccessibleTextRole, f"{cell.title}, {LEVELS[cell.level][1]}")

    def _cell(self, row: int) -> Cell:
        cell = self.item(row).data(_CELL)
        assert isinstance(cell, Cell)
        return cell

    def _on_current(self, item: QListWidgetItem | None) -> None:
        if item is not None and not self._filling:
            self.chosen.emit(item.data(_CELL).name)


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
        cell, thumb = index.data(_CELL), index.data(_THUMB)
        painter.save()
        chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        if chosen:
            painter.fillRect(option.rect, option.palette.highlight())
        box = QRectF(option.rect.left() + 8, option.rect.top() + 5, THUMB.width(), THUMB.height())
        painter.fillRect(box, QColor(32, 34, 37))
        if thumb is not None:
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(box, thumb)
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
