"""Panels beside the pictures: hidden at first, in the menu, moved and closed as the user likes."""

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QDockWidget, QMainWindow, QMenu, QTabBar, QWidget

FIRST_HEIGHT_PX = 190
AREAS = {
    "right": Qt.DockWidgetArea.RightDockWidgetArea,
    "bottom": Qt.DockWidgetArea.BottomDockWidgetArea,
}


class Panels(QObject):
    """Keeps the panels of a window; each is known by a key, under which it is remembered."""

    def __init__(self, window: QMainWindow, menu: QMenu) -> None:
        """Prepare to add panels to a window and their entries to a menu."""
        super().__init__(window)
        self._window, self._menu = window, menu
        self._docks: dict[str, QDockWidget] = {}
        window.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Look after the tabs when the window is shown, or has got new ones."""
        if event.type() in (QEvent.Type.Show, QEvent.Type.ChildPolished):
            self.tidy()
        return False

    def tidy(self) -> None:
        """Name the rows of tabs, and put those of hidden panels and of single ones out of sight.

        Qt shows a row of tabs that it has not laid out yet over the menus.
        """
        seen = {dock.windowTitle() for dock in self._docks.values() if not dock.isHidden()}
        direct = Qt.FindChildOption.FindDirectChildrenOnly
        for bar in self._window.findChildren(QTabBar, options=direct):
            bar.setAccessibleName("Panels at this place")
            titles = {bar.tabText(place) for place in range(bar.count())}
            if len(titles) < 2 or seen.isdisjoint(titles):
                bar.move(-2 * bar.width(), -2 * bar.height())

    def add(
        self, key: str, title: str, widget: QWidget, shortcut: str = "", area: str = "right"
    ) -> QAction:
        """Add a panel; return the entry that shows and hides it.

        Args:
            key: Of the panel, without spaces; never change it, positions are kept under it.
            title: For people.
            widget: The content.
            shortcut: Such as "Ctrl+K".
            area: One of AREAS.
        """
        dock = QDockWidget(title, self._window)
        dock.setObjectName(f"panel.{key}")
        dock.setAllowedAreas(
            AREAS["right"] | AREAS["bottom"] | Qt.DockWidgetArea.LeftDockWidgetArea
        )
        dock.setWidget(widget)
        widget.setAccessibleName(widget.accessibleName() or title)
        self._window.addDockWidget(AREAS[area], dock)
        self._stack(dock, area)
        dock.hide()
        self._docks[key] = dock
        if area == "bottom":
            # Else it would take half of the window from the pictures.
            self._window.resizeDocks([dock], [FIRST_HEIGHT_PX], Qt.Orientation.Vertical)
        action = dock.toggleViewAction()
        action.setShortcut(QKeySequence(shortcut))
        self._menu.addAction(action)
        action.triggered.connect(lambda shown: self.show(key) if shown else None)
        return action

    def dock(self, key: str) -> QDockWidget:
        """Return the panel of a key."""
        return self._docks[key]

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of all panels, in the order in which they were added."""
        return tuple(self._docks)

    def show(self, key: str) -> None:
        """Show a panel, in front of those at its place."""
        self._docks[key].show()
        self._docks[key].raise_()

    def _stack(self, dock: QDockWidget, area: str) -> None:
        """Put a panel behind those of its side, as tabs: side by side they leave no picture."""
        for other in self._docks.values():
            if self._window.dockWidgetArea(other) == AREAS[area]:
                self._window.tabifyDockWidget(other, dock)
                return
