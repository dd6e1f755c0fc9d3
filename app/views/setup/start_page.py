"""The first page of the setup: for whom, and what will happen."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

WELCOME = (
    "<h2>Teach facepuppet your face</h2>"
    "<p>You will be asked for up to 60 faces and head turns. Sit before the webcam as you usually "
    "do, with light from the front; the pictures are taken by themselves when you hold still. "
    "This takes five minutes, the training after it one or two.</p>"
    "<p>Everything stays on this computer, in <code>{folder}</code>: the pictures, the points "
    "found in them, and the trained model. Nothing is sent anywhere. You can stop at any moment "
    "and go on later where you stopped.</p>"
)


class StartPage(QWidget):
    """Asks for a name, or which setup to go on with."""

    chosen = Signal(str)  # a profile's name

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._trouble: Callable[[str], str] = lambda name: ""
        self.text = QLabel()
        self.text.setWordWrap(True)
        self.name, self.remark = QLineEdit(), QLabel()
        self.name.setPlaceholderText("For example your first name")
        self.name.setAccessibleName("Name of the profile")
        self.begin_button = QPushButton("&Begin")
        self.profiles = QListWidget()
        self.profiles.setAccessibleName("Profiles that there are")
        self._build()
        self.name.textChanged.connect(self._judge)
        self.name.returnPressed.connect(self.begin_button.click)
        self.begin_button.clicked.connect(lambda: self.chosen.emit(self.name.text().strip()))
        self.profiles.itemClicked.connect(self._on_profile)
        self.profiles.itemActivated.connect(self._on_profile)
        self._judge()

    def show_place(self, folder: str, trouble: Callable[[str], str]) -> None:
        """Say where profiles live, and what is wrong with a name.

        Args:
            folder: For people.
            trouble: Returns what is wrong, or an empty text.
        """
        self.text.setText(WELCOME.format(folder=folder))
        self._trouble = trouble

    def show_profiles(self, told: Sequence[tuple[str, str]]) -> None:
        """List the profiles, each with what is to be known about it."""
        self.profiles.clear()
        for name, note in told:
            item = QListWidgetItem(f"{name} – {note}", self.profiles)
            item.setData(Qt.ItemDataRole.UserRole, name)
        self._box.setVisible(bool(told))

    def _build(self) -> None:
        row = QHBoxLayout()
        row.addWidget(QLabel("&Name"))
        row.itemAt(0).widget().setBuddy(self.name)  # type: ignore[union-attr]
        row.addWidget(self.name, stretch=1)
        row.addWidget(self.begin_button)
        self._box = QGroupBox("Go on with, or add pictures to")
        inner = QVBoxLayout(self._box)
        inner.addWidget(self.profiles)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(24, 12, 24, 12)
        layout.addWidget(self.text)
        layout.addLayout(row)
        layout.addWidget(self.remark)
        layout.addSpacing(12)
        layout.addWidget(self._box, stretch=1)
        layout.addStretch(1)

    def _judge(self) -> None:
        name = self.name.text().strip()
        trouble = self._trouble(name) if name else ""
        self.remark.setText(trouble[:1].upper() + trouble[1:])
        self.begin_button.setEnabled(bool(name) and not trouble)

    def _on_profile(self, item: QListWidgetItem) -> None:
        self.name.setText(item.data(Qt.ItemDataRole.UserRole))
        self.begin_button.click()
