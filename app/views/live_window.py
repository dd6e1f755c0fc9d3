"""The live window: the source with its landmarks on the left, the avatar on the right.

Other features add to it, in app.controllers.desk:

- `add_panel(key, title, widget, shortcut, area)`: a panel beside the pictures, hidden at first,
  listed in the menu View, its place remembered.
- `menu(name)`: one of MENUS, to add actions to.
- `deeds[key]`: the actions of app.views.live_actions.
- `message_bar`: `tell` a trouble, `announce` good news, `offer` a text with buttons.
"""

from collections.abc import Callable, Sequence

from PySide6.QtCore import QEvent, QObject, QSize, Qt, Signal
from PySide6.QtGui import QAction, QCloseEvent, QKeyEvent, QPalette, QResizeEvent
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QCheckBox,
    QComboBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMainWindow,
    QMenu,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from app.views.choice import Choice
from app.views.chooser import Chooser
from app.views.files import ask_for_video
from app.views.job_row import JobRow
from app.views.live_actions import LiveActions
from app.views.message_bar import MessageBar
from app.views.narrow import fit_row
from app.views.new_profile import NewProfileDialog
from app.views.pane import Pane
from app.views.panels import Panels
from app.views.picture_pair import PicturePair
from app.views.setup_card import SetupCard
from app.views.status_row import LiveNumbers, StatusRow
from app.views.transport_row import TransportRow

#: Choices that open a dialog.
OPEN_FILE = Choice("?file", "Video file…", "Play a video in place of a camera (Ctrl+O)")
NEW_PROFILE = Choice("?new", "New profile…", "Make a profile from a video or pictures (Ctrl+N)")
#: What can be done with profiles, below their names: key of the action -> what people read.
PROFILE_DEEDS = {
    "guided": "Set up my face…", "edit": "Edit landmarks…", "folder": "Open the folder",
}  # fmt: skip
#: Key of the choice not to track.
NO_PROFILE = Choice("", "No profile")
MARGIN_PX = 8
#: The lists alone have room in it.
LEAST_ROW_PX = 330
#: Qt's word for no limit.
QWIDGETSIZE_MAX = 16777215
#: The menus from the left.
MENUS = ("File", "View", "Avatar", "Face", "Help")


class LiveWindow(QMainWindow):
    """Shows pictures and numbers; says what the user wishes."""

    source_chosen = Signal(str)
    sources_wanted = Signal()  # the list of sources is to be renewed
    profile_chosen = Signal(str)
    new_profile_wanted = Signal(str, str)  # name, source
    guided_wanted = Signal()
    cancel_wanted = Signal()
    avatar_chosen = Signal(str)
    closing = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setWindowTitle("facepuppet")
        self.source_pane, self.avatar_pane = Pane("Source picture"), Pane("Avatar picture")
        self.pair = PicturePair(self.source_pane, self.avatar_pane)
        self.sources, self.profiles = Chooser("Source"), Chooser("Profile")
        self.avatars = Chooser("Avatar")
        self.new_profile_button = QPushButton("&New profile…")
        self.mirror_box, self.landmarks_box = QCheckBox("&Mirror"), QCheckBox("&Landmarks")
        self.landmarks_box.setChecked(True)
        self.message_bar, self.job_row, self.status = MessageBar(), JobRow(), StatusRow()
        self.card = SetupCard()
        self.hint, self.choices, self.below = QLabel(), QWidget(), QWidget()
        self._name_trouble: Callable[[str], str] = lambda name: ""
        self._performer = Choice("", "")
        self._profile_names: tuple[str, ...] = ()
        self._menus = {name: self.menuBar().addMenu(f"&{name}") for name in MENUS}
        self.deeds = LiveActions(self, self._menus)
        deeds = self.deeds
        self.transport = TransportRow(
            (deeds["previous"], deeds["pause"], deeds["next"], deeds["loop"])
        )
        self.panels = Panels(self, self._menus["View"])
        self._build()
        self._connect()
        # Else the first list would have the keyboard, and take the letters.
        self.setFocus()

    def menu(self, name: str) -> QMenu:
        """Return one of MENUS, to add actions to."""
        return self._menus[name]

    def add_panel(
        self, key: str, title: str, widget: QWidget, shortcut: str = "", area: str = "right"
    ) -> QAction:
        """Add a panel beside the pictures; return the action that shows and hides it.

        Args:
            key: Of the panel, without spaces; never change it, its place is remembered under it.
            title: For people.
            widget: The content; it should do with a width of 300 px.
            shortcut: Such as "Ctrl+K".
            area: "right" or "bottom".
        """
        return self.panels.add(key, title, widget, shortcut, area)

    def sizeHint(self) -> QSize:
        """Return a size that shows two pictures of a usual webcam."""
        return QSize(1240, 600)

    # -- what is shown -------------------------------------------------------------------

    def show_sources(self, choices: Sequence[Choice], current: str) -> None:
        """List the sources."""
        self.sources.show_choices([*choices, OPEN_FILE], current)

    def show_profiles(self, names: Sequence[str], current: str) -> None:
        """List the profiles."""
        self._profile_names = tuple(names)
        listed = [Choice(name, name) for name in names]
        deeds = [Choice(f"?{key}", text) for key, text in PROFILE_DEEDS.items()]
        self.profiles.show_choices([NO_PROFILE, *listed, *deeds], current)
        for key in ("edit", "folder"):
            self.deeds[key].setEnabled(bool(current))

    def show_avatars(self, choices: Sequence[Choice], current: str) -> None:
        """List the avatars."""
        self.avatars.show_choices(choices, current)

    def show_numbers(self, numbers: LiveNumbers) -> None:
        """Show the state of tracking and the speeds."""
        self.status.show_numbers(numbers)

    def show_hint(self, text: str) -> None:
        """Say something that is no trouble, in small print below the pictures; or nothing."""
        self.hint.setText(text)
        self.hint.setVisible(bool(text))

    def show_mirrored(self, mirrored: bool) -> None:
        """Show both pictures as a mirror does, or as they are."""
        self.mirror_box.setChecked(mirrored)

    def set_profile_rules(self, name_trouble: Callable[[str], str], performer: Choice) -> None:
        """Say what the dialog for new profiles needs to know.

        Args:
            name_trouble: Returns what is wrong with a name, or an empty text.
            performer: The source that is no file.
        """
        self._name_trouble, self._performer = name_trouble, performer

    # -- what is asked -------------------------------------------------------------------

    def take(self, key: str) -> None:
        """Do what a choice of a notice or of the list of sources says."""
        if key == OPEN_FILE.key:
            self.ask_for_video()
        elif key == NEW_PROFILE.key:
            self.ask_for_profile()
        else:
            self.source_chosen.emit(key)

    def _take_profile(self, key: str) -> None:
        """Use a profile, or do with the one in use what its list offers."""
        if key.startswith("?"):
            self.profiles.show_current()
            self.deeds[key[1:]].trigger()
        else:
            self.profile_chosen.emit(key)

    def ask_for_video(self) -> None:
        """Let the user choose a video as the source."""
        ask_for_video(self, "Open a video", self.source_chosen.emit, self.sources.show_current)

    def ask_for_profile(self) -> None:
        """Let the user say from what a new profile is to be made."""
        if not self.new_profile_button.isEnabled():
            return
        dialog = NewProfileDialog(self._name_trouble, self._profile_names, self._performer, self)
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.wanted.connect(self.new_profile_wanted)
        dialog.guided_wanted.connect(self.guided_wanted)
        dialog.open()

    def show_bare(self, bare: bool) -> None:
        """Show nothing but the pictures, on the full screen; or all of the window again."""
        # Not hidden: the keys of a hidden menu bar are dead.
        self.menuBar().setMaximumHeight(0 if bare else QWIDGETSIZE_MAX)
        self.choices.setHidden(bare)
        self.below.setHidden(bare)
        self.status.setHidden(bare)
        margin = 0 if bare else MARGIN_PX
        self._layout.setContentsMargins(margin, margin, margin, 0 if bare else 2)
        if bare:
            self.showFullScreen()
        else:
            self.showNormal()

    def event(self, event: QEvent) -> bool:
        """Leave keys that are shortcuts as well to what has the focus and needs them."""
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.ShortcutOverride:
            event.setAccepted(self._is_needed(event))
        return bool(super().event(event))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Leave out of the row of choices what has no room."""
        if watched is self.choices and isinstance(event, QResizeEvent):
            fit_row(self._pieces, self._optional, event.size().width())
        return bool(super().eventFilter(watched, event))

    def _is_needed(self, event: QKeyEvent) -> bool:
        """Return whether what has the focus needs a key: Space presses, letters search in lists."""
        focus, plain = self.focusWidget(), Qt.KeyboardModifier.NoModifier
        if event.key() == Qt.Key.Key_Space:
            return isinstance(focus, (QAbstractButton, QComboBox))
        searched = isinstance(focus, (QComboBox, QAbstractItemView, QAbstractSpinBox, QLineEdit))
        return searched and event.modifiers() == plain and event.text().isalnum()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Leave the full screen with Esc."""
        if event.key() == Qt.Key.Key_Escape and self.deeds.on("full"):
            self.deeds["full"].setChecked(False)
        else:
            super().keyPressEvent(event)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Disappear at once, then let the work stop."""
        self.hide()
        self.closing.emit()
        super().closeEvent(event)

    # -- construction --------------------------------------------------------------------

    def _connect(self) -> None:
        self.sources.chosen.connect(self.take)
        self.sources.list_wanted.connect(self.sources_wanted)
        self.source_pane.chosen.connect(self.take)
        self.avatar_pane.chosen.connect(self.take)
        self.profiles.chosen.connect(self._take_profile)
        self.avatars.chosen.connect(self.avatar_chosen)
        self.card.wanted.connect(self.guided_wanted)
        self.new_profile_button.clicked.connect(self.ask_for_profile)
        self.job_row.cancel_wanted.connect(self.cancel_wanted)
        self.mirror_box.toggled.connect(self.source_pane.picture.set_mirrored)
        deeds = self.deeds
        deeds["open"].triggered.connect(self.ask_for_video)
        deeds["new"].triggered.connect(self.ask_for_profile)
        deeds["guided"].triggered.connect(self.guided_wanted)
        deeds["quit"].triggered.connect(self.close)
        for key, box in (("mirror", self.mirror_box), ("landmarks", self.landmarks_box)):
            deeds[key].toggled.connect(box.setChecked)
            box.toggled.connect(deeds[key].setChecked)

    def _build(self) -> None:
        self.new_profile_button.setToolTip(NEW_PROFILE.details)
        self.mirror_box.setToolTip("Show both pictures as a mirror does")
        self.landmarks_box.setToolTip("Draw the tracked landmarks over the source")
        self.hint.setWordWrap(True)
        self.hint.setAccessibleName("Hint")
        self.hint.setForegroundRole(QPalette.ColorRole.PlaceholderText)
        self._fill_choices()
        below = QVBoxLayout(self.below)
        below.setContentsMargins(0, 0, 0, 0)
        for widget in (self.transport, self.card, self.hint):
            below.addWidget(widget)
        center = QWidget()
        layout = QVBoxLayout(center)
        layout.setContentsMargins(MARGIN_PX, MARGIN_PX, MARGIN_PX, 2)
        layout.setSpacing(MARGIN_PX)
        layout.addWidget(self.choices)
        layout.addWidget(self.message_bar)
        layout.addWidget(self.job_row)
        layout.addWidget(self.pair, stretch=1)
        layout.addWidget(self.below)
        self._layout = layout
        self.setCentralWidget(center)
        self.setStatusBar(self.status)

    def _fill_choices(self) -> None:
        row = QHBoxLayout(self.choices)
        labels: list[QWidget] = []
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(6)
        for text, box in (
            ("&Source", self.sources),
            ("&Profile", self.profiles),
            ("&Avatar", self.avatars),
        ):
            label = QLabel(text)
            label.setBuddy(box)
            labels.append(label)
            row.addWidget(label)
            row.addWidget(box, stretch=1)
            row.addSpacing(8)
            if box is self.profiles:
                row.insertWidget(row.count() - 1, self.new_profile_button)
        row.addStretch(1)
        row.addWidget(self.landmarks_box)
        row.addWidget(self.mirror_box)
        # All that may be left out is in the menus, too.
        self._optional = [
            self.landmarks_box, self.mirror_box, self.new_profile_button, *labels,
        ]  # fmt: skip
        self._pieces = [*self._optional, self.sources, self.profiles, self.avatars]
        self.choices.setMinimumWidth(LEAST_ROW_PX)
        self.choices.installEventFilter(self)
