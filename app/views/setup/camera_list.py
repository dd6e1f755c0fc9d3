"""The cameras, each with a small live picture and what is known of it."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QImage, QPainter, QPalette
from PySide6.QtWidgets import (
    QListWidget,
    QListWidgetItem,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QWidget,
)

from app.views.editor.painting import small
from app.views.picture_view import EMPTY_TEXT_COLOR, SURROUND_COLOR

THUMB = QSize(128, 96)
CARD_ROLE, THUMB_ROLE = Qt.ItemDataRole.UserRole, Qt.ItemDataRole.UserRole + 1
WARNING = QColor(255, 170, 0)


@dataclass(frozen=True, slots=True)
class CameraCard:
    """What is said of one camera.

    Attributes:
        key: For the program.
        name: For people.
        facts: Resolution and speed, or what is being done.
        trouble: Why it gives no picture, "" if it does.
    """

    key: str
    name: str
    facts: str
    trouble: str = ""

    @property
    def told(self) -> str:
        """All of it, for who cannot see the card."""
        return f"{self.name}: {self.trouble or self.facts}"


class CameraList(QListWidget):
    """Cards of cameras; a click or the arrow keys choose one."""

    chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Cameras")
        self.setItemDelegate(_CardPainter(self))
        self.setUniformItemSizes(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._filling = False
        self.currentItemChanged.connect(self._on_current)
        # A click on the chosen one tries it again.
        self.itemClicked.connect(self._on_current)

    def sizeHint(self) -> QSize:
        """Return a width for cards with some words beside the picture."""
        return QSize(THUMB.width() + 28 * self.fontMetrics().averageCharWidth(), 320)

    @property
    def cards(self) -> tuple[CameraCard, ...]:
        """The cards in the order shown."""
        return tuple(self.item(row).data(CARD_ROLE) for row in range(self.count()))

    def show_cards(self, cards: Sequence[CameraCard], chosen: str) -> None:
        """Show the cameras; cards of the same cameras only change."""
        self._filling = True
        if [card.key for card in cards] != [card.key for card in self.cards]:
            self.clear()
            for _ in cards:
                QListWidgetItem(self)
        for row, card in enumerate(cards):
            item = self.item(row)
            if item.data(CARD_ROLE) != card:
                item.setData(CARD_ROLE, card)
                item.setData(Qt.ItemDataRole.AccessibleTextRole, card.told)
                item.setToolTip(card.told)
            if card.key == chosen and self.currentRow() != row:
                self.setCurrentRow(row)
        self._filling = False

    def show_thumb(self, key: str, image: QImage | None) -> None:
        """Show a camera's picture."""
        for row, card in enumerate(self.cards):
            if card.key == key:
                self.item(row).setData(THUMB_ROLE, image)

    def _on_current(self, item: QListWidgetItem | None, *_: object) -> None:
        if item is not None and not self._filling:
            self.chosen.emit(item.data(CARD_ROLE).key)


class _CardPainter(QStyledItemDelegate):
    """Paints a picture with name and facts beside it."""

    def sizeHint(
        self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> QSize:
        """Return the size of a card."""
        return QSize(THUMB.width() + 100, THUMB.height() + 12)

    def paint(
        self, painter: QPainter, option: QStyleOptionViewItem,
        index: QModelIndex | QPersistentModelIndex,
    ) -> None:  # fmt: skip
        """Paint one card."""
        card, thumb = index.data(CARD_ROLE), index.data(THUMB_ROLE)
        if card is None:
            return
        painter.save()
        chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        if chosen:
            painter.fillRect(option.rect, option.palette.color(QPalette.ColorRole.Highlight))
        box = QRect(option.rect.left() + 6, option.rect.top() + 6, THUMB.width(), THUMB.height())
        painter.fillRect(box, SURROUND_COLOR)
        if thumb is not None:
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(_fitted(thumb, box), thumb)
        else:
            painter.setPen(EMPTY_TEXT_COLOR)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, "no picture")
        if card.trouble:
            painter.fillRect(QRect(box.left(), box.bottom() - 4, box.width(), 5), WARNING)
        role = QPalette.ColorRole.HighlightedText if chosen else QPalette.ColorRole.Text
        painter.setPen(option.palette.color(role))
        _paint_texts(painter, option, box.right() + 10, card)
        painter.restore()


def _fitted(image: QImage, box: QRect) -> QRectF:
    scale = min(box.width() / image.width(), box.height() / image.height())
    fitted = QRectF(0, 0, image.width() * scale, image.height() * scale)
    fitted.moveCenter(QRectF(box).center())
    return fitted


def _paint_texts(
    painter: QPainter, option: QStyleOptionViewItem, left: int, card: CameraCard
) -> None:
    room = option.rect.adjusted(0, 8, -6, -6)
    room.setLeft(left)
    font = QFont(option.font)
    font.setBold(True)
    painter.setFont(font)
    wrap = Qt.TextFlag.TextWordWrap | Qt.AlignmentFlag.AlignLeft
    name = painter.fontMetrics().elidedText(
        card.name, Qt.TextElideMode.ElideRight, 2 * room.width() - 20
    )
    needed = painter.boundingRect(room, int(wrap), name)
    painter.drawText(room, int(wrap), name)
    font.setBold(False)
    painter.setFont(small(font))
    room.setTop(needed.bottom() + 4)
    painter.drawText(room, int(wrap), card.trouble or card.facts)
