"""The live picture of the setup: which way to turn, how long to hold still."""

from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from app.views.picture_view import BADGE_COLOR, EMPTY_TEXT_COLOR, PictureView
from core.records import FloatArray

GHOST, GHOST_EDGE = QColor(255, 255, 255, 190), QColor(0, 0, 0, 90)
GUIDE, GOOD, TROUBLE = QColor(255, 220, 80), QColor(80, 220, 140), QColor(255, 170, 0)
#: Turns smaller than this need no arrow.
LEAST_DEG = 6.0
#: And beside a larger turn those smaller than this share of it can wait.
LEAST_SHARE = 0.5


@dataclass(frozen=True, slots=True)
class Guide:
    """What the picture says to the user.

    Attributes:
        yaw_deg: Still to turn, positive to the user's left.
        pitch_deg: Still to tilt, positive up.
        roll_deg: Still to lean, positive towards the user's left shoulder.
        held: How much of the hold has passed, in [0, 1].
        advice: A sentence over the picture, or "".
        flash: Whether a picture has just been taken.
        news: What came of the last picture, "" if that is long ago.
        good: Whether that is good news.
        ghost: Lines of a head that is held as asked, in the picture's pixels, closed one first.
    """

    yaw_deg: float = 0.0
    pitch_deg: float = 0.0
    roll_deg: float = 0.0
    held: float = 0.0
    advice: str = ""
    flash: bool = False
    news: str = ""
    good: bool = True
    ghost: tuple[FloatArray, ...] = ()


class GuideView(PictureView):
    """A mirrored picture with arrows and a ring that fills while the user holds still."""

    def __init__(self, name: str, parent: QWidget | None = None) -> None:
        super().__init__(name, parent)
        self.set_mirrored(True)
        self._guide = Guide()

    @property
    def guide(self) -> Guide:
        """What the picture says."""
        return self._guide

    def show_guide(self, guide: Guide) -> None:
        """Say something else."""
        self._guide = guide
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the picture, then what it says."""
        super().paintEvent(event)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint(painter, self.picture_rect(), self._guide)
        painter.end()

    def _paint(self, painter: QPainter, area: QRectF, guide: Guide) -> None:
        if guide.ghost:
            self._paint_ghost(painter, area, guide.ghost)
        _paint_turns(painter, area, guide)
        if guide.held > 0:
            _ring(painter, area, guide.held)
        if guide.flash:
            painter.setPen(QPen(GOOD if guide.good else TROUBLE, 10))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(area.adjusted(5, 5, -5, -5))
        if guide.news:
            _news(painter, area, guide.news, GOOD if guide.good else TROUBLE)
        if guide.advice:
            _sentence(painter, area, guide.advice)

    def _paint_ghost(self, painter: QPainter, area: QRectF, lines: tuple[FloatArray, ...]) -> None:
        """Paint lines that are in the picture's pixels over the mirrored picture."""
        if self._image is None:
            return
        scale = area.width() / self._image.width()
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for number, line in enumerate(lines):
            places = QPolygonF([
                QPointF(area.right() - scale * (x + 0.5), area.top() + scale * (y + 0.5))
                for x, y in line.tolist()
            ])  # fmt: skip
            draw = painter.drawPolygon if number == 0 else painter.drawPolyline
            for color, width in ((GHOST_EDGE, 4.5), (GHOST, 2.0)):
                pen = QPen(color, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap)
                pen.setStyle(Qt.PenStyle.DashLine if number == 0 else Qt.PenStyle.SolidLine)
                painter.setPen(pen)
                draw(places)


def _paint_turns(painter: QPainter, area: QRectF, guide: Guide) -> None:
    """Paint an arrow for the largest turn, and for others that are about as large."""
    largest = max(abs(guide.yaw_deg), abs(guide.pitch_deg), abs(guide.roll_deg))
    least = max(LEAST_DEG, LEAST_SHARE * largest)
    # In a mirror the user's left is on the left.
    if abs(guide.yaw_deg) > least:
        _arrow(painter, area, -1.0 if guide.yaw_deg > 0 else 1.0, 0.0)
    if abs(guide.pitch_deg) > least:
        _arrow(painter, area, 0.0, -1.0 if guide.pitch_deg > 0 else 1.0)
    if abs(guide.roll_deg) > least:
        _bend(painter, area, leftwards=guide.roll_deg > 0)


def _arrow(painter: QPainter, area: QRectF, x: float, y: float) -> None:
    """Paint an arrow at the edge of the picture towards which the head is to turn."""
    size = 0.075 * area.height()
    reach = QPointF(x * (area.width() / 2 - 1.5 * size), y * (area.height() / 2 - 1.5 * size))
    tip = area.center() + reach
    along, across = QPointF(x * size, y * size), QPointF(-y * size, x * size)
    head = QPolygonF([tip + along, tip + across, tip - across])
    painter.setPen(QPen(QColor(0, 0, 0, 160), 3, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap,
                        Qt.PenJoinStyle.RoundJoin))  # fmt: skip
    painter.setBrush(GUIDE)
    painter.drawPolygon(head)


def _bend(painter: QPainter, area: QRectF, leftwards: bool) -> None:
    """Paint a bent arrow over the head for a lean."""
    radius = 0.4 * area.height()
    box = QRectF(0, 0, 2 * radius, 2 * radius)
    box.moveCenter(area.center() + QPointF(0, 0.06 * area.height()))
    start, span = (90, 35) if leftwards else (90, -35)
    for color, width in ((QColor(0, 0, 0, 160), 9), (GUIDE, 5)):
        painter.setPen(QPen(color, width))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawArc(box, 16 * start, 16 * span)
    painter.save()
    painter.translate(box.center())
    painter.rotate(-span)
    size = 0.05 * area.height() * (-1 if leftwards else 1)
    painter.setPen(QPen(QColor(0, 0, 0, 160), 2))
    painter.setBrush(GUIDE)
    painter.drawPolygon(
        QPolygonF([QPointF(1.4 * size, -radius), QPointF(0, -radius - abs(size)),
                   QPointF(0, -radius + abs(size))])
    )  # fmt: skip
    painter.restore()


def _ring(painter: QPainter, area: QRectF, held: float) -> None:
    size = 0.14 * area.height()
    box = QRectF(area.right() - size - 16, area.top() + 16, size, size)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor(0, 0, 0, 150), 0.16 * size))
    painter.drawEllipse(box)
    painter.setPen(QPen(GOOD, 0.1 * size))
    painter.drawArc(box, 16 * 90, -round(16 * 360 * min(held, 1.0)))


def _news(painter: QPainter, area: QRectF, text: str, color: QColor) -> None:
    """Paint at the upper left what came of the last picture."""
    font = QFont(painter.font())
    font.setBold(True)
    painter.save()
    painter.setFont(font)
    metrics = painter.fontMetrics()
    most = 0.7 * area.width()
    text = metrics.elidedText(text, Qt.TextElideMode.ElideRight, round(most))
    box = QRectF(0, 0, metrics.horizontalAdvance(text) + 24, metrics.height() + 12)
    box.moveTopLeft(area.topLeft() + QPointF(14, 14))
    painter.setPen(QPen(color, 1.5))
    painter.setBrush(BADGE_COLOR)
    painter.drawRoundedRect(box, 8, 8)
    painter.setPen(EMPTY_TEXT_COLOR)
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
    painter.restore()


def _sentence(painter: QPainter, area: QRectF, text: str) -> None:
    font = QFont(painter.font())
    font.setPointSizeF(1.25 * font.pointSizeF())
    painter.setFont(font)
    flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
    room = QRectF(0, 0, 0.86 * area.width(), area.height())
    text_box = painter.fontMetrics().boundingRect(room.toRect(), int(flags), text)
    box = QRectF(text_box).adjusted(-14, -8, 14, 8)
    box.moveCenter(QPointF(area.center().x(), area.bottom() - box.height() / 2 - 14))
    painter.setPen(QPen(TROUBLE, 1.5))
    painter.setBrush(BADGE_COLOR)
    painter.drawRoundedRect(box, 8, 8)
    painter.setPen(EMPTY_TEXT_COLOR)
    painter.drawText(box.adjusted(12, 6, -12, -6), int(flags), text)
