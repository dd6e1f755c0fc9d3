"""A drop-down list of choices."""

from collections.abc import Sequence

from PySide6.QtCore import QEvent, QObject, QSize, Qt, Signal
from PySide6.QtGui import QIcon, QKeyEvent, QPaintEvent, QWheelEvent
from PySide6.QtWidgets import (
    QComboBox,
    QListView,
    QStyle,
    QStyleOptionComboBox,
    QStylePainter,
    QWidget,
)

from app.views.choice import Choice

#: Side of the small pictures in the box and in the list that drops down.
_IN_BOX_PX, _IN_LIST_PX = 20, 40


class Chooser(QComboBox):
    """Shows choices and says which one the user took."""

    chosen = Signal(str)
    list_wanted = Signal()  # the list is about to drop down: now is the time to renew it

    def __init__(self, name: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(name)
        # A click leaves the keyboard to the window, whose keys are letters.
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        # Long names of files and cameras must not widen the window.
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(6)
        self.setIconSize(QSize(_IN_BOX_PX, _IN_BOX_PX))
        # The list that Qt makes itself draws all pictures as small as in the box.
        shown = QListView()
        shown.setIconSize(QSize(_IN_LIST_PX, _IN_LIST_PX))
        shown.setSpacing(1)
        self.setView(shown)
        shown.installEventFilter(self)
        self.setPlaceholderText(f"Choose: {name.lower()}")
        self._choices: tuple[Choice, ...] = ()
        self._current = ""
        self.activated.connect(self._on_activated)

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the choices."""
        return tuple(choice.key for choice in self._choices)

    def show_choices(self, choices: Sequence[Choice], current: str) -> None:
        """List the choices; without one of the current key nothing is selected."""
        self._current = current
        if tuple(choices) != self._choices:
            self._choices = tuple(choices)
            self.clear()
            for row, choice in enumerate(choices):
                self.addItem(choice.text, choice.key)
                self.setItemData(row, choice.details or choice.text, Qt.ItemDataRole.ToolTipRole)
                if choice.picture:
                    self.setItemIcon(row, QIcon(choice.picture))
            self._fit_list()
        self.show_current()

    def show_current(self) -> None:
        """Select what is really current, after a choice that came to nothing."""
        self.setCurrentIndex(self.findData(self._current))
        details = self.itemData(self.currentIndex(), Qt.ItemDataRole.ToolTipRole) or ""
        text = self.currentText()
        self.setToolTip(details if text in details else f"{text}: {details}")

    def showPopup(self) -> None:
        """Drop the list down."""
        self.list_wanted.emit()
        super().showPopup()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Let letters search in the open list, whatever they mean in the window."""
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.ShortcutOverride:
            event.setAccepted(event.text().isalnum())
            return event.isAccepted()
        return bool(super().eventFilter(watched, event))

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Choose nothing: the wheel scrolls what is around the box, or the open list."""
        event.ignore()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the box; a text without room ends in dots, and is whole in the tool tip."""
        if self.currentIndex() < 0:
            super().paintEvent(event)
            return
        option, field = QStyleOptionComboBox(), QStyle.SubControl.SC_ComboBoxEditField
        self.initStyleOption(option)
        kind = QStyle.ComplexControl.CC_ComboBox
        room = self.style().subControlRect(kind, option, field, self).width() - 6
        room -= 0 if self.itemIcon(self.currentIndex()).isNull() else self.iconSize().width() + 4
        elided = Qt.TextElideMode.ElideRight
        option.currentText = self.fontMetrics().elidedText(self.currentText(), elided, room)
        painter = QStylePainter(self)
        painter.drawComplexControl(kind, option)
        painter.drawControl(QStyle.ControlElement.CE_ComboBoxLabel, option)
        painter.end()

    def _fit_list(self) -> None:
        """Make the list wide enough for its entries, though the box is narrower."""
        widths = [self.fontMetrics().horizontalAdvance(one.text) for one in self._choices]
        self.view().setMinimumWidth(min(max(widths, default=0) + 40, 480))

    def _on_activated(self, row: int) -> None:
        self.chosen.emit(self.itemData(row))
