"""Keys that drive the avatar: Ctrl+R recentres, Ctrl+1 to Ctrl+9 show faces."""

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QEvent, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QKeyEvent, QKeySequence
from PySide6.QtWidgets import QApplication

from app.views.live_window import LiveWindow
from core.drive_settings import N_KEYS

#: For so long a face that is to be held is shown when it is chosen in the menu.
FROM_MENU_MS = 1500


class ExpressionHotkeys(QObject):
    """Hears keys in all windows of the program, and when they are let go."""

    recentre_wanted = Signal()
    uncentre_wanted = Signal()
    pressed = Signal(int)  # from 1
    released = Signal(int)

    def __init__(self, window: LiveWindow, parent: QObject | None = None) -> None:
        """Add the actions to the window's menu of faces."""
        super().__init__(parent)
        self._held: set[int] = set()
        menu = window.menu("Face")
        self.recentre = _action(window, "&Recentre", "Ctrl+R", self.recentre_wanted.emit)
        self.recentre.setToolTip("Take how you look now for straight ahead and neutral")
        menu.addAction(self.recentre)
        self.uncentre = _action(window, "Forget &centre", "", self.uncentre_wanted.emit)
        self.uncentre.setToolTip("Use head and face as they are tracked")
        menu.addAction(self.uncentre)
        faces = menu.addMenu("&Expression")
        for key in range(1, N_KEYS + 1):
            text, press = f"Expression key &{key}", partial(self._press, key)
            faces.addAction(_action(window, text, f"Ctrl+{key}", press))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Hear that keys are let go; installed only while some are held."""
        if event.type() == QEvent.Type.KeyRelease and isinstance(event, QKeyEvent):
            if not event.isAutoRepeat():
                self._let_go(event.key())
        elif event.type() == QEvent.Type.ApplicationDeactivate:
            self._release(set(self._held))
        return False

    def _press(self, key: int) -> None:
        if key in self._held:
            return
        if not self._application().keyboardModifiers() & Qt.KeyboardModifier.ControlModifier:
            # Chosen in the menu: nothing is held that could be let go.
            self.pressed.emit(key)
            QTimer.singleShot(FROM_MENU_MS, self, lambda: self.released.emit(key))
            return
        if not self._held:
            self._application().installEventFilter(self)
        self._held.add(key)
        self.pressed.emit(key)

    def _let_go(self, key: int) -> None:
        number = key - Qt.Key.Key_0.value
        if key == Qt.Key.Key_Control:
            self._release(set(self._held))
        elif number in self._held:
            self._release({number})

    def _release(self, keys: set[int]) -> None:
        for key in sorted(keys):
            self._held.discard(key)
            self.released.emit(key)
        if not self._held:
            self._application().removeEventFilter(self)

    def _application(self) -> QApplication:
        application = QApplication.instance()
        if not isinstance(application, QApplication):
            raise TypeError("hot keys need a QApplication")
        return application


def _action(window: LiveWindow, text: str, shortcut: str, call: Callable[[], None]) -> QAction:
    action = QAction(text, window)
    action.setShortcut(QKeySequence(shortcut))
    # The avatar's own window has the focus while streaming.
    action.setShortcutContext(Qt.ShortcutContext.ApplicationShortcut)
    action.setAutoRepeat(False)
    action.triggered.connect(lambda: call())
    window.addAction(action)
    return action
