"""Long work on takes, in the background: solving again, exporting."""

from collections.abc import Generator
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from app.controllers.live import LiveController
from app.controllers.profile_maker import ProfileMaker
from app.controllers.take_list import entry_of
from app.controllers.take_tools import TakeTools
from app.render.look import AvatarLook
from app.takes.exporting import ARRAYS, FILM, FilmWish, export_arrays, export_table
from app.takes.library import Take
from app.takes.solving import MODE_TEXTS, SolveWish
from app.views.choice import Choice
from app.views.files import ask_where_to_save
from app.views.live_window import LiveWindow
from app.views.takes.export_dialog import FORMS, ExportDialog, ExportWish
from app.views.takes.solve_dialog import SolveDialog
from app.views.takes.takes_panel import TakesPanel
from core.drive import Drive
from core.records import Progress

ALREADY = (
    "There is a file {path} already: nothing was written. Export again and choose that very name "
    "to replace it, or another one."
)


class TakeWork(QObject):
    """Does one piece of work at a time; asks before what is wished exactly."""

    changed = Signal()  # begun or ended
    made = Signal(str)  # name of a new take

    def __init__(
        self, controller: LiveController, window: LiveWindow, panel: TakesPanel,
        tools: TakeTools, parent: QObject | None = None,
    ) -> None:  # fmt: skip
        super().__init__(parent)
        self._controller, self._window, self._tools = controller, window, tools
        self._maker = ProfileMaker(self)
        self._panel = panel
        panel.work.cancel_wanted.connect(self._maker.cancel)
        self._maker.progressed.connect(panel.work.show_progress)
        self._maker.made.connect(self._on_made)
        self._maker.failed.connect(lambda error: window.message_bar.tell(str(error)))
        self._maker.finished.connect(self._on_finished)

    @property
    def busy(self) -> bool:
        """Whether work goes on."""
        return self._maker.busy

    def stop(self) -> None:
        """End the work and wait for that; nothing unfinished stays."""
        self._maker.stop()

    def ask_to_solve(self, take: Take) -> None:
        """Ask how a take is to be solved again, then do it."""
        profiles = [key for key in self._window.profiles.keys if key]
        dialog = SolveDialog(
            take.name, profiles, self._controller.wanted.profile, MODE_TEXTS, self._window
        )
        dialog.wanted.connect(lambda profile, mode: self.solve(take, profile, mode))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()

    def solve(self, take: Take, profile: str, mode: str) -> None:
        """Solve the video of a take again; the result is another take."""
        wish = SolveWish(profile, mode, f"{take.name} {profile or mode}")
        drive = Drive(self._controller.drive.settings)
        self._begin(self._tools.solve(take, wish, drive))

    def ask_to_export(self, take: Take) -> None:
        """Ask in what form a take is wanted, and where; then write it."""
        box = self._window.avatars
        avatars = [Choice(box.itemData(n), box.itemText(n)) for n in range(box.count())]
        told = f"<b>{take.name}</b><br>{entry_of(take).details}"
        dialog = ExportDialog(
            told, avatars, self._controller.scene.avatar, take.film is not None, self._window
        )
        dialog.wanted.connect(lambda wish: self._ask_where(take, wish))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()

    def export(self, take: Take, wish: ExportWish, path: Path) -> None:
        """Write a take; the suffix of the path is that of the form."""
        if wish.form == FILM:
            film = FilmWish(wish.size_px, wish.fps, wish.beside)
            look = film_look(self._controller.scene.look_now, wish.background)
            self._begin(self._tools.film(take, path, film, wish.avatar, look))
        elif wish.form == ARRAYS:
            self._begin(export_arrays(take, path))
        else:
            self._begin(export_table(take, path, wish.driven))

    def _ask_where(self, take: Take, wish: ExportWish) -> None:
        def write(chosen: str) -> None:
            path = Path(chosen)
            named = path if path.suffix.lower() == wish.form else Path(f"{chosen}{wish.form}")
            if named != path and named.exists():
                # The dialog has asked about another name.
                self._window.message_bar.tell(ALREADY.format(path=named))
            else:
                self.export(take, wish, named)

        text = next(form.text for form in FORMS if form.key == wish.form).replace("&", "")
        ask_where_to_save(
            self._window, "Export the take", f"{take.name}{wish.form}", write,
            [f"{text} (*{wish.form})"],
        )  # fmt: skip

    def _begin(self, steps: Generator[Progress, None, object]) -> None:
        if self._maker.busy:
            return
        self._panel.work.show_progress("Preparing", 0)
        self._maker.start(steps)
        self.changed.emit()

    def _on_made(self, made: object) -> None:
        if isinstance(made, Take):
            self._window.message_bar.announce(f"Solved again, as the take {made.name}.")
            self.made.emit(made.name)
        else:
            self._window.message_bar.announce(f"Exported to {made}.")

    def _on_finished(self) -> None:
        self._panel.work.end()
        self.changed.emit()


def film_look(look: AvatarLook, background: str) -> AvatarLook:
    """Return how the pictures of a film are taken.

    Args:
        look: Of the live window.
        background: Another kind of background, or "".
    """
    kind = background or look.background.kind
    # No film has an alpha channel.
    kind = "key" if kind == "transparent" else kind
    return look.changed(background=look.background.changed(kind=kind))
