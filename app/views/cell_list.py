"""A list of pictures, each with a thumbnail and what is said about it."""

from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QListWidget, QListWidgetItem, QWidget

#: What an item holds: its thumbnail, and its cell, which has a name.
THUMB_ROLE, CELL_ROLE = Qt.ItemDataRole.UserRole, Qt.ItemDataRole.UserRole + 1


class CellList(QListWidget):
    """Finds cells by name; says which one the user chose, and nothing of what the program did."""

    chosen = Signal(str)

    def __init__(self, name: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(name)
        self.setUniformItemSizes(True)
        self._filling = False

    @property
    def names(self) -> list[str]:
        """The cells' names in the order shown."""
        return [cell.name for cell in self.cells()]

    def cells(self) -> list[Any]:
        """Return the cells in the order shown."""
        return [self.item(row).data(CELL_ROLE) for row in range(self.count())]

    def item_of(self, name: str) -> QListWidgetItem | None:
        """Return the item of a cell, None if it is not listed."""
        names = self.names
        return self.item(names.index(name)) if name in names else None

    def show_thumb(self, name: str, image: QImage | None) -> None:
        """Show a cell's thumbnail."""
        item = self.item_of(name)
        if item is not None:
            item.setData(THUMB_ROLE, image)

    def show_current(self, name: str) -> None:
        """Mark a cell as the one at work."""
        item = self.item_of(name)
        if item is not None:
            self._filling = True
            self.setCurrentItem(item)
            self.scrollToItem(item)
            self._filling = False

    def _choose(self, item: QListWidgetItem | None) -> None:
        """Tell that the user chose an item."""
        if item is not None and not self._filling:
            self.chosen.emit(item.data(CELL_ROLE).name)
