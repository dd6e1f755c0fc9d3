"""The control panel at work: settings changed, kept, taken back; keys heard, live values shown."""

import time

import numpy as np
from PySide6.QtCore import QObject, QTimer

from app.controllers.drive_history import DriveHistory
from app.controllers.expression_hotkeys import ExpressionHotkeys
from app.controllers.live import LiveController
from app.controllers.preset_desk import PresetDesk
from app.drive_files import Kept, SettingsUnwritableError, load_kept, save_kept
from app.views.choice import Choice
from app.views.control.control_panel import ControlPanel
from app.views.control.response_model import Live
from app.views.live_window import LiveWindow
from app.workers.live_loop import LiveResult
from core.drive_presets import KEYS
from core.drive_settings import DriveSettings
from core.geometry import head_angles_from_matrix, matrix_from_quaternion
from core.records import FaceState, FloatArray
from core.response import SHOWN, learn_full

#: Ten pictures of the live values per second.
LIVE_EVERY_MS = 100
#: Settings are kept when nothing was changed for so long.
KEEP_AFTER_MS = 1000
CENTRED = "Centre set: this is straight ahead now. To undo it later: Face > Forget centre."
CENTRED_TURNED = (
    "Your head is turned by {:.0f}°, and this is straight ahead now. If you did not mean that: "
    "Undo, look at the screen with a resting face, and recentre again."
)
CENTRED_LATER = "No face is seen: the centre is set as soon as one is."
UNCENTRED = "Centre forgotten: head and face are used as they are tracked."
#: Such a message goes by itself; a head turned further than this is rarely meant as the centre.
CENTRED_FOR_MS, TURNED_DEG = 6000, 25.0
#: Key of the message's button.
UNDO = Choice("centre.undo", "&Undo")
NO_FACE = "No face is tracked: look into the camera, then press it again."
NOT_SHOWN = "Nothing was changed: make the face, hold it, and press it again."


class Controlling(QObject):
    """Joins the control panel with the drive; settings are kept for each profile and avatar."""

    def __init__(self, controller: LiveController, window: LiveWindow) -> None:
        """Add the panel and the keys to the live window, and use the settings that are kept."""
        super().__init__(controller)
        self._controller, self._window, self._drive = controller, window, controller.drive
        self.panel = ControlPanel({key.name: key.weights for key in KEYS})
        window.add_panel("control", "&Control", self.panel, "Ctrl+K")
        self._role = (controller.wanted.profile, controller.scene.avatar)
        self._history, self._dirty = DriveHistory(), False
        self._timer, self._keep_timer = QTimer(self), QTimer(self)
        self._state: FaceState | None = None
        self._timer.setInterval(LIVE_EVERY_MS)
        self._keep_timer.setSingleShot(True)
        self._keep_timer.setInterval(KEEP_AFTER_MS)
        self.hotkeys = ExpressionHotkeys(window, self)
        self._presets = PresetDesk(self.panel.presets, lambda: self._drive.settings, self)
        self._connect_panel()
        self._connect_live()
        self._take_over(load_kept(*self._role))

    @property
    def kept(self) -> Kept:
        """Settings and centre as they are now."""
        return Kept(self._drive.settings, self._drive.centre)

    def keep(self) -> None:
        """Write what has changed."""
        self._keep_timer.stop()
        if not self._dirty:
            return
        self._dirty = self._drive.recentring
        if self._dirty:
            # What is to be kept comes with the next face.
            self._keep_timer.start()
        try:
            save_kept(*self._role, self.kept)
        except SettingsUnwritableError as error:
            self._window.message_bar.tell(str(error))

    # -- wiring ---------------------------------------------------------------------------

    def _connect_panel(self) -> None:
        panel = self.panel
        panel.changed.connect(self.apply)
        panel.opened.connect(self._on_opened)
        panel.feel.recentre_wanted.connect(self.recentre)
        panel.feel.uncentre_wanted.connect(self._on_uncentre_wanted)
        panel.responses.full_wanted.connect(lambda rows: self._make_full(rows, self._drive.now))
        panel.responses.range_wanted.connect(
            lambda rows: self._make_full(rows, self._drive.seen[:, 1])
        )
        panel.responses.forget_wanted.connect(self._drive.forget_seen)
        panel.keys.pressed.connect(self._drive.press)
        panel.keys.released.connect(self._drive.release)
        panel.keys.face_wanted.connect(self._on_face_wanted)
        panel.presets.undo_wanted.connect(self.undo)
        self._presets.chosen.connect(self.apply)
        self._presets.told.connect(self._window.message_bar.tell)

    def _connect_live(self) -> None:
        self.hotkeys.recentre_wanted.connect(self.recentre)
        self.hotkeys.uncentre_wanted.connect(self._on_uncentre_wanted)
        self._window.message_bar.chosen.connect(
            lambda key: self.undo() if key == UNDO.key else None
        )
        self._controller.solved.connect(self._on_solved)
        self.hotkeys.pressed.connect(self._drive.press)
        self.hotkeys.released.connect(self._drive.release)
        self._controller.profile_changed.connect(self._on_role_changed)
        self._controller.avatar_changed.connect(self._on_role_changed)
        self._controller.ending.connect(self.stop)
        self._timer.timeout.connect(self._show_live)
        self._keep_timer.timeout.connect(self.keep)

    def stop(self) -> None:
        """Keep what has changed; a centre that was learned by itself, too."""
        self._timer.stop()
        centring = self._drive.settings.centring
        self._dirty |= centring.head or centring.face
        self.keep()
        self._keep_timer.stop()

    # -- settings -------------------------------------------------------------------------

    def apply(self, settings: DriveSettings, what: str) -> None:
        """Use settings from now on, so that it can be taken back."""
        if settings == self._drive.settings:
            return
        self._remember(what)
        self._drive.use(settings)
        self._show_settings()
        self._keep_soon()

    def undo(self) -> None:
        """Take the last change back."""
        kept = self._history.back()
        if kept is not None:
            self._drive.use(kept.settings)
            self._drive.put_centre(kept.centre)
            self._show_settings()
            self._keep_soon()

    def recentre(self) -> None:
        """Take the next face for a head at its centre and a face at rest."""
        self._remember("recentre")
        self._drive.recentre()
        self._keep_soon()
        self._tell_centred()

    def _tell_centred(self) -> None:
        """Say what recentring means, for a while; of a head turned away until it is read."""
        bar, state = self._window.message_bar, self._state
        if state is None or state.lost:
            self._tell_awhile(CENTRED_LATER)
        elif (turned_deg := most_turned_deg(state)) > TURNED_DEG:
            bar.offer(CENTRED_TURNED.format(turned_deg), [UNDO])
        else:
            bar.offer(CENTRED, [UNDO])
            self._hide_later(CENTRED)

    def _tell_awhile(self, text: str) -> None:
        self._window.message_bar.announce(text)
        self._hide_later(text)

    def _hide_later(self, text: str) -> None:
        bar = self._window.message_bar
        QTimer.singleShot(CENTRED_FOR_MS, bar, lambda: bar.hide() if bar.text == text else None)

    def _on_solved(self, result: LiveResult) -> None:
        self._state = result.state

    def _on_uncentre_wanted(self) -> None:
        self._remember("forget the centre")
        self._drive.put_centre(None)
        self._keep_soon()
        self._tell_awhile(UNCENTRED)

    def _make_full(self, rows: list[int] | None, face: FloatArray) -> None:
        """Let a face (B,) count as 100 %: some coefficients of it, or all that it shows."""
        settings = before = self._drive.settings
        for row in [None] if rows is None else rows:
            settings = learn_full(settings, face, row)
        if not self._drive.sees_face:
            self._window.message_bar.tell(NO_FACE)
        elif settings == before:
            self._window.message_bar.tell(NOT_SHOWN)
        else:
            self.apply(settings, "100 %")

    def _on_face_wanted(self, key: int) -> None:
        if not self._drive.sees_face:
            self._window.message_bar.tell(NO_FACE)
        elif float(self._drive.now.max()) < SHOWN:
            self._window.message_bar.tell(NOT_SHOWN)
        else:
            self.panel.keys.take_face(key, self._drive.now)

    def _remember(self, what: str) -> None:
        """Keep the present state for undo."""
        self._history.remember(what, self.kept, time.monotonic())

    def _keep_soon(self) -> None:
        self._dirty = True
        self._keep_timer.start()
        self.panel.presets.show_undo(self._history.next)

    def _on_role_changed(self) -> None:
        """Use what is kept for the profile and avatar that are chosen now."""
        role = (self._controller.wanted.profile, self._controller.scene.avatar)
        if role == self._role:
            return
        self.keep()
        self._role = role
        self._take_over(load_kept(*role))

    def _take_over(self, kept: Kept) -> None:
        self._history.clear()
        self._drive.use(kept.settings)
        self._drive.put_centre(kept.centre)
        self._show_settings()
        self.panel.feel.show_centre(kept.centre is not None)
        self.panel.presets.show_undo("")
        if kept.notes:
            self._window.message_bar.tell("; ".join(kept.notes))

    # -- showing --------------------------------------------------------------------------

    def _show_settings(self) -> None:
        self.panel.show_settings(self._drive.settings)
        self._presets.show()

    def _on_opened(self, seen: bool) -> None:
        """Show live values only to somebody who sees them."""
        if seen:
            self._timer.start()
        else:
            self._timer.stop()

    def _show_live(self) -> None:
        drive, panel = self._drive, self.panel
        panel.feel.show_centre(drive.centre is not None)
        if panel.responses.isVisible():
            panel.responses.show_live(Live(drive.now, drive.shown, drive.seen))
        if panel.keys.isVisible():
            panel.keys.show_pressed(drive.keys_shown)


def most_turned_deg(state: FaceState) -> float:
    """Return the greatest of a head's angles, as tracked."""
    angles_rad = head_angles_from_matrix(matrix_from_quaternion(state.rotation_wxyz))
    return float(np.degrees(np.abs(angles_rad).max()))
