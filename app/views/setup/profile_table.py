"""The profiles on this computer: what each holds."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHeaderView, QTreeWidget, QTreeWidgetItem, QWidget

from app.shelf import Shelved, size_text

COLUMNS = ("Profile", "State", "Pictures", "On disk")


class ProfileTable(QTreeWidget):
    """A row for each profile; a double click or Enter opens one."""

    opened = Signal(str)
    current_changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Profiles that there are")
        self.setColumnCount(len(COLUMNS))
        self.setHeaderLabels(COLUMNS)
        self.setRootIsDecorated(False)
        self.setAllColumnsShowFocus(True)
        self.setUniformRowHeights(True)
        # Tab leads to the buttons, not to the next column.
        self.setTabKeyNavigation(False)
        self.itemActivated.connect(lambda item: self.opened.emit(_profile(item).name))
        self.currentItemChanged.connect(lambda *_: self.current_changed.emit())
        head = self.header()
        head.setStretchLastSection(False)
        head.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        for column in range(1, len(COLUMNS)):
            head.setSectionResizeMode(column, QHeaderView.ResizeMode.ResizeToContents)

    @property
    def current(self) -> Shelved | None:
        """The profile that is selected."""
        item = self.currentItem()
        return None if item is None else _profile(item)

    @property
    def names(self) -> list[str]:
        """The profiles in the order shown."""
        return [_profile(self.topLevelItem(row)).name for row in range(self.topLevelItemCount())]

    def show_profiles(self, profiles: Sequence[Shelved]) -> None:
        """List the profiles; the selected one stays so while it is there."""
        before = self.current
        self.clear()
        for profile in profiles:
            self.addTopLevelItem(_row(profile))
        names = self.names
        row = names.index(before.name) if before is not None and before.name in names else 0
        self.setCurrentIndex(self.model().index(row, 0))


def _profile(item: QTreeWidgetItem | None) -> Shelved:
    profile: Shelved = item.data(0, Qt.ItemDataRole.UserRole)  # type: ignore[union-attr]
    return profile


def _row(profile: Shelved) -> QTreeWidgetItem:
    texts = [profile.name, profile.note, str(profile.n_pictures), size_text(profile.size_bytes)]
    item = QTreeWidgetItem(texts)
    item.setData(0, Qt.ItemDataRole.UserRole, profile)
    told = f"{profile.name}: {profile.note}, {profile.n_pictures} pictures, {texts[3]} on disk"
    item.setData(0, Qt.ItemDataRole.AccessibleTextRole, told)
    for column in range(len(texts)):
        item.setToolTip(column, profile.trouble or f"{told}\n{profile.folder}")
        if column > 1:
            right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
            item.setTextAlignment(column, right)
    return item
