"""Takes in the live window: recorded, listed, played, solved again, exported."""

from pathlib import Path

from PySide6.QtCore import QObject, QUrl
from PySide6.QtGui import QAction, QDesktopServices, QKeySequence
from PySide6.QtWidgets import QMessageBox

from app.controllers.live import LiveController
from app.controllers.playing import PlayingDesk
from app.controllers.recording import RecordingDesk
from app.controllers.take_list import TakeShelf, entry_of
from app.controllers.take_tools import TakeTools, TakeWorkshop
from app.controllers.take_work import TakeWork
from app.errors import AppError
from app.takes.library import Take, TakeError, delete, name_trouble, renamed
from app.takes.recorder import Ending
from app.views.live_window import LiveWindow
from app.views.takes.name_dialog import NameDialog
from app.views.takes.record_row import RecordingDot, TakeBadge, clock
from app.views.takes.takes_panel import TakesPanel

PANEL = "takes"


class TakesController(QObject):
    """Joins the panel of the takes with the live view."""

    def __init__(
        self, controller: LiveController, window: LiveWindow, tools: TakeTools | None = None
    ) -> None:
        """Add the panel, its menu entries and the badge of the status line.

        Args:
            controller: Of the live view; parent of this.
            window: Gets the panel.
            tools: The workshop of the takes.
        """
        super().__init__(controller)
        self._controller, self._window = controller, window
        tools = tools or TakeWorkshop()
        self.panel, self.badge = TakesPanel(), TakeBadge()
        self.dot = RecordingDot(window.source_pane)
        self.shelf = TakeShelf(self)
        self.recording = RecordingDesk(controller, self)
        self.playing = PlayingDesk(controller, self.panel.player, tools.user, self)
        self.work = TakeWork(controller, window, self.panel, tools, self)
        self._wanted_name = ""
        window.status.addPermanentWidget(self.badge)
        window.add_panel(PANEL, "Takes", self.panel, "Ctrl+Shift+T")
        self._add_actions()
        self._connect()
        self.shelf.refresh()

    def _add_actions(self) -> None:
        menu = self._window.menu("File")
        self.record_action = QAction("&Record a take", self._window)
        self.record_action.setShortcut(QKeySequence("R"))
        self.record_action.triggered.connect(self.toggle)
        self.pause_action = QAction("Pau&se recording", self._window)
        self.pause_action.setShortcut(QKeySequence("P"))
        self.pause_action.triggered.connect(self.recording.pause)
        leave = self._window.deeds["quit"]
        menu.insertActions(leave, [self.record_action, self.pause_action])
        menu.insertSeparator(leave)

    def _connect(self) -> None:
        panel = self.panel
        panel.record.record_wanted.connect(self.toggle)
        panel.record.pause_wanted.connect(self.recording.pause)
        panel.wished.connect(self._on_wished)
        self.recording.changed.connect(self._show_state)
        self.recording.ended.connect(self._on_recorded)
        self.playing.changed.connect(self._show_state)
        self.playing.trimmed.connect(lambda take: self._show_again(take.name))
        self.playing.failed.connect(self._tell)
        self.work.changed.connect(self._show_possible)
        self.work.made.connect(self._show_again)
        self.shelf.changed.connect(self._show_list)
        self.shelf.mended.connect(self._on_mended)
        self._controller.ending.connect(self._on_ending)
        self._show_state()

    # -- recording -----------------------------------------------------------------------

    def toggle(self) -> None:
        """Begin to record, or end the recording."""
        if self.recording.state != "off":
            self.recording.stop()
            return
        try:
            self.recording.begin(self.panel.record.with_video)
        except AppError as error:
            self._tell(error)

    def _show_state(self) -> None:
        state, seconds = self.recording.state, self.recording.seconds
        self.panel.record.show_state(state, seconds)
        self.dot.show_state(state, seconds)
        self.record_action.setText("&Record a take" if state == "off" else "Stop &recording")
        self.pause_action.setEnabled(state in ("recording", "paused"))
        self.pause_action.setText("Go on recording" if state == "paused" else "Pau&se recording")
        texts = {
            "recording": f"Recording {clock(seconds)}",
            "paused": f"Recording paused {clock(seconds)}",
            "saving": "Saving the take…",
        }
        played = self.playing.take
        text = texts.get(state, "" if played is None else f"Playing the take {played.name}")
        self.badge.show_state(text, recording=state != "off")

    def _on_recorded(self, ending: Ending) -> None:
        self._show_state()
        if ending.trouble is not None:
            self._tell(ending.trouble)
        if ending.take is None:
            return
        self._show_again(ending.take.name)
        if ending.trouble is None:
            self._window.message_bar.announce(recorded_text(ending.take))

    def _on_mended(self, found: list[Take | TakeError]) -> None:
        texts = [
            f"The recording {one.name} was broken off; {clock(one.facts.seconds)} of it were saved."
            if isinstance(one, Take) else str(one) for one in found
        ]  # fmt: skip
        self._window.message_bar.announce(" ".join(texts))

    # -- the list ------------------------------------------------------------------------

    def _show_again(self, name: str) -> None:
        """Read the list anew and choose a take."""
        self._wanted_name = name
        self.shelf.refresh()

    def _show_list(self) -> None:
        current = self._wanted_name or self.panel.list.current
        self._wanted_name = ""
        self.panel.list.show_entries([entry_of(take) for take in self.shelf.takes], current)
        self._show_possible()

    def _show_possible(self) -> None:
        take = self.shelf.named(self.panel.list.current)
        has_video = take is not None and take.film is not None
        self.panel.show_possible("" if take is None else take.name, has_video, self.work.busy)

    def _on_wished(self, key: str, name: str) -> None:
        self._show_possible()
        take = self.shelf.named(name)
        if take is None:
            return
        deeds = {
            "play": self._play, "export": self.work.ask_to_export, "rename": self._ask_for_name,
            "solve": self.work.ask_to_solve, "delete": self._ask_to_delete, "folder": open_folder,
        }  # fmt: skip
        if key in deeds:
            deeds[key](take)

    def _play(self, take: Take) -> None:
        self.recording.stop()
        self.playing.play(take)

    def _ask_for_name(self, take: Take) -> None:
        taken = {one.name for one in self.shelf.takes} - {take.name}

        def trouble(name: str) -> str:
            return f"There is a take {name!r} already." if name in taken else name_trouble(name)

        dialog = NameDialog(take.name, trouble, self._window)
        dialog.wanted.connect(lambda name: self._rename(take, name))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()

    def _rename(self, take: Take, name: str) -> None:
        played = self.playing.take
        try:
            now = renamed(take, name)
        except AppError as error:
            self._tell(error)
            return
        if played is not None and played.name == take.name:
            self.playing.renamed(now)
        self._show_again(name)

    def _ask_to_delete(self, take: Take) -> None:
        box = QMessageBox(self._window)
        box.setIcon(QMessageBox.Icon.Warning)
        box.setWindowTitle("Delete the take")
        box.setText(f"Delete the take “{take.name}”?")
        box.setInformativeText(f"{entry_of(take).details}. It cannot be brought back.")
        button = box.addButton("&Delete", QMessageBox.ButtonRole.DestructiveRole)
        box.setDefaultButton(box.addButton("&Keep", QMessageBox.ButtonRole.RejectRole))
        button.clicked.connect(lambda: self._delete(take))
        box.finished.connect(box.deleteLater)
        box.open()

    def _delete(self, take: Take) -> None:
        played = self.playing.take
        if played is not None and played.name == take.name:
            self.playing.leave()
        try:
            delete(take)
        except AppError as error:
            self._tell(error)
        self.shelf.refresh()

    def _tell(self, error: object) -> None:
        self._window.message_bar.tell(str(error))

    def _on_ending(self) -> None:
        self.work.stop()
        self.shelf.stop()


def recorded_text(take: Take) -> str:
    """Return what was recorded, for people."""
    facts = take.facts
    text = f"Recorded {facts.seconds:.1f} s, {facts.frames} frames, as the take {take.name}."
    if facts.pictures_left_out:
        left_out = facts.pictures_left_out
        text += f" {left_out} pictures came too fast for the disk; their states are kept."
    return text


def open_folder(take: Take) -> None:
    """Show a take's files."""
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(Path(take.folder))))
