"""Everything that the menus of the live window offer by itself, with its key."""

from collections.abc import Mapping
from typing import NamedTuple

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu


class Deed(NamedTuple):
    """An entry of a menu.

    Attributes:
        menu: Its name.
        key: For the program.
        text: For people; empty draws a line above what follows.
        shortcut: Empty without one.
        checked: How it begins, None for what is no switch.
        tip: What it does, where the text does not say all.
    """

    menu: str
    key: str
    text: str = ""
    shortcut: str = ""
    checked: bool | None = None
    tip: str = ""


DEEDS = (
    Deed("File", "open", "&Open video…", "Ctrl+O"),
    Deed("File", "-"),
    Deed("File", "pause", "&Pause", "Space", False, "Hold a video or the virtual performer"),
    Deed("File", "next", "&Next frame", "."),
    Deed("File", "previous", "Pre&vious frame", ","),
    Deed("File", "loop", "&Loop", "", True, "Begin again at the end of a video"),
    Deed("File", "-"),
    Deed("File", "quit", "&Quit", "Ctrl+Q"),
    Deed("View", "source", "Show &webcam", "F7", True),
    Deed("View", "avatar", "Show &avatar", "F8", True),
    Deed("View", "swap", "&Swap views", "F6"),
    Deed(
        "View", "blank", "&Hide webcam picture", "Ctrl+H", False,
        "Show what is tracked without showing you",
    ),
    Deed("View", "mirror", "&Mirror", "Ctrl+M", False, "Show both pictures as a mirror does"),
    Deed("View", "-"),
    Deed("View", "landmarks", "&Landmarks", "L", True),
    Deed("View", "mesh", "Face &mesh", "M", False, "The fitted face as a wire frame"),
    Deed("View", "points", "&Appearance points", "A", False, "What the trained regressor looks at"),
    Deed("View", "axes", "Head a&xes", "X", False),
    Deed("View", "bars", "&Bars of coefficients", "B", False, "Over the avatar's picture"),
    Deed("View", "trace", "&Error trace", "E", False, "How sure the tracker was of late"),
    Deed("View", "-"),
    Deed("View", "full", "&Full screen", "F11", False),
    Deed("View", "alone", "Avatar in its &own window", "F9", False, "Without a frame"),
    Deed("View", "top", "Always on &top", "Ctrl+T", False),
    Deed("View", "-"),
    Deed("Face", "guided", "&Set up my face…", "Ctrl+G", None, "The guided setup: ten minutes"),
    Deed("Face", "new", "&New profile from a video…", "Ctrl+N"),
    Deed("Face", "edit", "&Edit landmarks…", "Ctrl+L", None, "Of the profile's pictures"),
    Deed("Face", "folder", "Open the profile's &folder"),
    Deed("Face", "-"),
    Deed("Help", "keys", "&Keyboard", "F1"),
    Deed("Help", "about", "&About facepuppet"),
)  # fmt: skip
#: What may lie over the pictures.
OVERLAYS = ("landmarks", "mesh", "points", "axes", "bars", "trace")


class LiveActions(QObject):
    """The actions of DEEDS, to be connected by who does them."""

    def __init__(self, window: QMainWindow, menus: Mapping[str, QMenu]) -> None:
        """Fill the menus."""
        super().__init__(window)
        self._actions: dict[str, QAction] = {}
        for deed in DEEDS:
            if deed.text:
                self._actions[deed.key] = _action(window, deed)
                menus[deed.menu].addAction(self._actions[deed.key])
            else:
                menus[deed.menu].addSeparator()

    def __getitem__(self, key: str) -> QAction:
        """Return the action of a key of DEEDS."""
        return self._actions[key]

    @property
    def switches(self) -> tuple[str, ...]:
        """The keys of all that can be on or off."""
        return tuple(key for key, action in self._actions.items() if action.isCheckable())

    def on(self, key: str) -> bool:
        """Return whether a switch is on."""
        return self._actions[key].isChecked()


def _action(window: QMainWindow, deed: Deed) -> QAction:
    action = QAction(deed.text, window)
    action.setShortcut(QKeySequence(deed.shortcut))
    action.setToolTip(deed.tip or deed.text.replace("&", ""))
    if deed.checked is not None:
        action.setCheckable(True)
        action.setChecked(deed.checked)
    return action
