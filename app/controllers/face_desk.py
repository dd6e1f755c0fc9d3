"""Ways to a profile from the live window: the guided setup, or a video in the background."""

from PySide6.QtCore import QObject, QUrl, Signal
from PySide6.QtGui import QDesktopServices

from app.controllers.profile_maker import ProfileMaker
from app.controllers.tools import Editor, Guided, Tools
from app.errors import AppError
from app.views.live_window import LiveWindow
from core.errors import CoreError


class FaceDesk(QObject):
    """Makes profiles; says when the camera is needed and which profile to go live with."""

    camera_needed = Signal()  # the live view must give its source back
    camera_free = Signal(str)  # go on, with this profile if it is not empty
    made = Signal(object)  # MadeProfile
    retrained = Signal(str)  # profile whose landmarks were corrected
    changed = Signal()  # `busy` may have changed

    def __init__(self, window: LiveWindow, tools: Tools, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._window, self._tools = window, tools
        self._maker = ProfileMaker(self)
        self._guided: Guided | None = None
        self._editor: Editor | None = None
        self._maker.progressed.connect(window.job_row.show_progress)
        self._maker.made.connect(self.made)
        self._maker.failed.connect(lambda error: window.message_bar.tell(str(error)))
        self._maker.finished.connect(self._on_finished)
        window.cancel_wanted.connect(self._maker.cancel)
        window.new_profile_wanted.connect(self._on_new_profile_wanted)

    @property
    def busy(self) -> bool:
        """Whether a profile is being made in the background."""
        return self._maker.busy

    def stop(self) -> None:
        """Close the guided setup, end the background work and wait for that."""
        if self._guided is not None:
            self._guided.close()
        if self._editor is not None:
            self._editor.close()
        self._maker.stop()

    def show_guided(self, source: str) -> None:
        """Leave the camera to the guided setup until its window is closed."""
        if self._guided is not None:
            self._guided.show()
            return
        self.camera_needed.emit()
        self._guided = self._tools.guided_setup(source if source.startswith("camera") else "")
        self._guided.finished.connect(self._on_guided_finished)
        self._guided.show()

    def add_pictures(self, source: str, profile: str, key: str) -> None:
        """Let the guided setup ask for a set of more pictures for a profile."""
        self.show_guided(source)
        if self._guided is not None:
            self._guided.add_pictures(profile, key)

    def show_editor(self, profile: str) -> None:
        """Show the landmarks of a profile's pictures, to be corrected."""
        if self._editor is not None:
            self._editor.show()
        elif profile:
            self._editor = self._tools.profile_editor(profile)
            self._editor.finished.connect(lambda trained: self._on_edited(profile, trained))
            self._editor.failed.connect(self._on_not_edited)

    def show_folder(self, profile: str) -> None:
        """Let the system show the files of a profile."""
        if profile:
            folder = self._tools.profile_folder(profile)
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder)))

    def _on_edited(self, profile: str, trained: bool) -> None:
        self._editor = None
        if trained:
            self.retrained.emit(profile)

    def _on_not_edited(self, error: CoreError | AppError) -> None:
        self._editor = None
        self._window.message_bar.tell(str(error))

    def _on_guided_finished(self, name: str) -> None:
        self._guided = None
        self.camera_free.emit(name)

    def _on_new_profile_wanted(self, name: str, source: str) -> None:
        if self._maker.busy:
            return
        self._window.message_bar.tell("")
        self._window.new_profile_button.setEnabled(False)
        self._window.job_row.begin(f"Making the profile {name}")
        self._maker.start(self._tools.profile_steps(name, source))
        self.changed.emit()

    def _on_finished(self) -> None:
        self._window.new_profile_button.setEnabled(True)
        self._window.job_row.end()
        self.changed.emit()
