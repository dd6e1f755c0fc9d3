"""A coefficient as a bar: what is tracked, what was seen, what is shown."""

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRectF, Qt
from PySide6.QtGui import QPainter, QPalette
from PySide6.QtWidgets import QDoubleSpinBox, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from app.views.control.response_model import BAR_ROLE, LIMITS_ROLE, LiveValue

Index = QModelIndex | QPersistentModelIndex


class BarDelegate(QStyledItemDelegate):
    """Paints a LiveValue: the range that counts, the tracked value, marks, the shown value."""

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Paint one bar."""
        value: LiveValue = index.data(BAR_ROLE)
        palette: QPalette = option.palette
        rect = QRectF(option.rect).adjusted(3, 4, -3, -4)
        painter.save()
        painter.setPen(Qt.PenStyle.NoPen)

        def span(begin: float, end: float, role: QPalette.ColorRole, top: float, high: float,
                 alpha: float = 1.0) -> None:  # fmt: skip
            color = palette.color(role)
            color.setAlphaF(alpha)
            left = rect.left() + begin * rect.width()
            painter.fillRect(
                QRectF(left, rect.top() + top * rect.height(), (end - begin) * rect.width(),
                       high * rect.height()), color,
            )  # fmt: skip

        text, accent = QPalette.ColorRole.Text, QPalette.ColorRole.Highlight
        span(0.0, 1.0, text, 0.0, 1.0, 0.10)
        span(value.low, max(value.high, value.low), text, 0.0, 1.0, 0.12)
        span(0.0, value.tracked, accent, 0.0, 0.62)
        span(0.0, value.shown, text, 0.74, 0.26, 0.65)
        tick = 1.5 / max(rect.width(), 1.0)
        for seen in value.seen if value.seen[1] > 0 else ():
            left = min(max(seen - tick / 2, 0.0), 1.0 - tick)
            span(left, left + tick, text, 0.0, 0.62, 0.9)
        painter.restore()


class NumberDelegate(QStyledItemDelegate):
    """Edits a number within its limits."""

    def createEditor(
        self, parent: QWidget, option: QStyleOptionViewItem, index: Index
    ) -> QDoubleSpinBox:
        """Return a spin box."""
        box = QDoubleSpinBox(parent)
        low, high = index.data(LIMITS_ROLE)
        box.setRange(low, high)
        box.setSingleStep(0.05)
        box.setDecimals(2)
        box.setFrame(False)
        box.setAccessibleName(str(index.data(Qt.ItemDataRole.AccessibleTextRole)))
        return box

    def setEditorData(self, editor: QWidget, index: Index) -> None:
        """Show the number in the spin box."""
        if isinstance(editor, QDoubleSpinBox):
            editor.setValue(float(index.data(Qt.ItemDataRole.EditRole)))
            editor.selectAll()
