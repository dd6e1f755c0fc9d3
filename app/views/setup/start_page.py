"""The first page of the setup: for whom, what will happen, and what there is already."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from app.shelf import Shelved, size_text
from app.views.setup.profile_table import ProfileTable

WELCOME = (
    "<h2>Teach facepuppet your face</h2>"
    "<p>You will be asked for up to 60 faces and head turns. Sit before the webcam as you usually "
    "do, with light from the front; the pictures are taken by themselves when you hold still. "
    "This takes ten minutes with the training. You can stop at any moment and go "
    "on later where you stopped.</p>"
)
#: What will happen, as long as there is room for it.
STEPS_AHEAD = (
    "<ol style='margin-left: 0px'>"
    "<li><b>Profile:</b> a name for what is learned. You are here.</li>"
    "<li><b>Camera:</b> choose it and see whether light and distance are good. One minute.</li>"
    "<li><b>Pictures:</b> copy what you are shown, as in a mirror. Five minutes; a quick choice of "
    "20 takes two.</li>"
    "<li><b>Landmarks:</b> look at the few pictures in which points may be wrong. Optional.</li>"
    "<li><b>Training:</b> the computer works for a minute or two, then you see how good it "
    "is and go live.</li></ol>"
)
STORED = (
    "<b>Nothing leaves this computer.</b> The pictures, the points found in them and the trained "
    "models are kept in <code>{folder}</code>{size} and are sent nowhere."
)
#: Key of a wish -> text of its button, what it does.
WISHES = {
    "open": ("&Open", "Go on with this profile, or add pictures to it"),
    "copy": ("&Copy for another look…", "For glasses, a beard or another lamp"),
    "clear": ("Delete &pictures…", "Keep the trained model, delete the pictures"),
    "delete": ("Delete p&rofile…", "Delete the pictures and the model"),
    "folder": ("Show &folder", "Open the folder of this profile"),
}


class StartPage(QWidget):
    """Asks for a name, or which profile to go on with."""

    chosen = Signal(str)  # a profile's name
    wished = Signal(str, str)  # a key of WISHES but "open", a profile's name
    all_wanted = Signal()  # to see the folder of all profiles

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._trouble: Callable[[str], str] = lambda name: ""
        self._folder = ""
        self.text, self.stored, self.ahead = QLabel(WELCOME), QLabel(), QLabel(STEPS_AHEAD)
        for label in (self.text, self.stored, self.ahead):
            label.setWordWrap(True)
        self.name, self.remark = QLineEdit(), QLabel()
        self.remark.setWordWrap(True)
        self.name.setPlaceholderText("For example your first name")
        self.name.setAccessibleName("Name of the profile")
        self.begin_button = QPushButton("&Begin")
        self.folder_button = QPushButton("Show d&ata folder")
        self.folder_button.setToolTip("Open the folder of all profiles")
        self.profiles = ProfileTable()
        self.buttons = {key: QPushButton(text) for key, (text, _) in WISHES.items()}
        self._build()
        self._connect()
        self._judge()

    def show_place(self, folder: str, trouble: Callable[[str], str]) -> None:
        """Say where profiles live, and what is wrong with a name.

        Args:
            folder: For people.
            trouble: Returns what is wrong, or an empty text.
        """
        self._folder, self._trouble = folder, trouble
        self.show_profiles([])

    def show_profiles(self, profiles: Sequence[Shelved]) -> None:
        """List the profiles, and say what they take of the disk."""
        total = sum(profile.size_bytes for profile in profiles)
        size = f" ({size_text(total)})" if profiles else ""
        self.stored.setText(STORED.format(folder=self._folder, size=size))
        self.profiles.show_profiles(profiles)
        self._box.setVisible(bool(profiles))
        self.ahead.setVisible(not profiles)
        self._show_possible()
        self._judge()

    def _build(self) -> None:
        label = QLabel("&Name of a new profile")
        label.setBuddy(self.name)
        row = QHBoxLayout()
        row.addWidget(label)
        row.addWidget(self.name, stretch=1)
        row.addWidget(self.begin_button)
        self._box = QGroupBox("Profiles on this computer")
        wishes = QVBoxLayout()
        for key, button in self.buttons.items():
            button.setToolTip(WISHES[key][1])
            wishes.addWidget(button)
        wishes.addStretch(1)
        inner = QHBoxLayout(self._box)
        inner.addWidget(self.profiles, stretch=1)
        inner.addLayout(wishes)
        foot = QHBoxLayout()
        foot.addWidget(self.stored, stretch=1)
        foot.addWidget(self.folder_button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(24, 12, 24, 12)
        layout.addWidget(self.text)
        layout.addLayout(row)
        layout.addWidget(self.remark)
        layout.addWidget(self.ahead)
        layout.addWidget(self._box, stretch=10)
        layout.addStretch(1)
        layout.addLayout(foot)

    def _connect(self) -> None:
        self.name.textChanged.connect(self._judge)
        self.name.returnPressed.connect(self.begin_button.click)
        self.begin_button.clicked.connect(lambda: self.chosen.emit(self.name.text().strip()))
        self.folder_button.clicked.connect(self.all_wanted)
        self.profiles.opened.connect(self.chosen)
        self.profiles.current_changed.connect(self._show_possible)
        for key, button in self.buttons.items():
            button.clicked.connect(lambda _=False, key=key: self._wish(key))

    def _judge(self) -> None:
        name = self.name.text().strip()
        trouble = self._trouble(name) if name else ""
        there = name in self.profiles.names
        text = "There is a profile of this name: you will go on with it." if there else ""
        self.remark.setText(trouble[:1].upper() + trouble[1:] if trouble else text)
        self.begin_button.setEnabled(bool(name) and not trouble)

    def _show_possible(self) -> None:
        """Offer what can be done with the selected profile."""
        profile = self.profiles.current
        whole = profile is not None and not profile.trouble
        can_clear = profile is not None and whole and profile.trained and profile.n_pictures > 0
        for button in self.buttons.values():
            button.setEnabled(profile is not None)
        self.buttons["open"].setEnabled(whole)
        self.buttons["copy"].setEnabled(whole)
        self.buttons["clear"].setEnabled(can_clear)

    def _wish(self, key: str) -> None:
        profile = self.profiles.current
        if profile is not None and key == "open":
            self.chosen.emit(profile.name)
        elif profile is not None:
            self.wished.emit(key, profile.name)
