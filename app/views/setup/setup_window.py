"""The guided setup: its steps on the left, the page of one of them beside."""

from collections.abc import Mapping

from PySide6.QtCore import QEvent, QSize, Qt, Signal
from PySide6.QtGui import QCloseEvent, QResizeEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QListWidget,
    QListWidgetItem,
    QMainWindow,
    QPushButton,
    QScrollArea,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from app.views.message_bar import MessageBar
from app.views.setup.camera_page import CameraPage
from app.views.setup.capture_page import CapturePage
from app.views.setup.start_page import StartPage
from app.views.setup.train_page import TrainPage

#: The steps in their order: key, what people read.
STEPS = {
    "start": "1  Profile", "camera": "2  Camera", "capture": "3  Pictures",
    "check": "4  Landmarks", "train": "5  Training",
}  # fmt: skip


class SetupWindow(QMainWindow):
    """Steps unlock in order; one that was reached can be visited again."""

    step_chosen = Signal(str)
    closing = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setWindowTitle("Setup – facepuppet")
        self.steps, self.pages = QListWidget(), QStackedWidget()
        self.steps.setAccessibleName("Steps of the setup")
        self.start, self.camera = StartPage(), CameraPage()
        self.capture, self.train = CapturePage(), TrainPage()
        self.check = QWidget()
        QVBoxLayout(self.check).setContentsMargins(0, 0, 0, 0)
        self.message_bar = MessageBar()
        self.next_button = QPushButton("&Next")
        self._build()

    def sizeHint(self) -> QSize:
        """Return a size for small laptop screens."""
        return QSize(1240, 680)

    def show_step(self, key: str) -> None:
        """Show the page of a step."""
        row = list(STEPS).index(key)
        self.steps.blockSignals(True)
        self.steps.setCurrentRow(row)
        self.steps.blockSignals(False)
        self.pages.setCurrentIndex(row)
        self.next_button.setVisible(key in ("camera", "capture", "check"))

    def show_unlocked(self, unlocked: Mapping[str, bool]) -> None:
        """Say which steps can be visited."""
        for row, key in enumerate(STEPS):
            item = self.steps.item(row)
            flags = item.flags()
            enabled = Qt.ItemFlag.ItemIsEnabled
            item.setFlags(flags | enabled if unlocked[key] else flags & ~enabled)

    def set_check_page(self, page: QWidget | None) -> None:
        """Put a widget into the page of the landmarks."""
        layout = self.check.layout()
        while layout is not None and layout.count():
            taken = layout.takeAt(0)
            widget = taken.widget() if taken is not None else None
            if widget is not None:
                widget.hide()
                widget.deleteLater()
        if page is not None and layout is not None:
            layout.addWidget(page)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Let everything end before the window goes."""
        self.closing.emit()
        super().closeEvent(event)

    def _build(self) -> None:
        for text in STEPS.values():
            QListWidgetItem(text, self.steps)
        self.steps.setFixedWidth(16 * self.fontMetrics().averageCharWidth())
        self.steps.currentRowChanged.connect(self._on_row)
        for page in (self.start, self.camera, self.capture, self.check, self.train):
            self.pages.addWidget(_scrolled(page))
        side = QVBoxLayout()
        side.addWidget(self.steps, stretch=1)
        side.addWidget(self.next_button)
        main = QVBoxLayout()
        main.addWidget(self.message_bar)
        main.addWidget(self.pages, stretch=1)
        central = QWidget()
        layout = QHBoxLayout(central)
        layout.addLayout(side)
        layout.addLayout(main, stretch=1)
        self.setCentralWidget(central)

    def _on_row(self, row: int) -> None:
        self.step_chosen.emit(list(STEPS)[row])


def _scrolled(page: QWidget) -> QScrollArea:
    """Return a page that can be moved where the screen is too small for it."""
    area = QScrollArea()
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setWidgetResizable(True)
    area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    area.setWidget(_Least(page))
    return area


class _Least(QWidget):
    """Lets a page become as small as it can before it is moved: areas ask for what it likes."""

    def __init__(self, page: QWidget) -> None:
        super().__init__()
        self._page = page
        page.setParent(self)

    def minimumSizeHint(self) -> QSize:
        """Return the least room for the page at this width."""
        least, layout = self._page.minimumSizeHint(), self._page.layout()
        if layout is not None and layout.hasHeightForWidth():
            width = max(self.width(), least.width())
            least.setHeight(max(least.height(), layout.minimumHeightForWidth(width)))
        return least

    def event(self, event: QEvent) -> bool:
        """Pass on that the page needs other room."""
        if event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
        return super().event(event)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fill the room with the page."""
        self._page.setGeometry(self.rect())
        self.updateGeometry()
        super().resizeEvent(event)
