"""Presets of the drive: chosen, saved under a name, deleted."""

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtCore import QObject, Signal

from app.drive_files import delete_preset, load_preset, preset_names, save_preset
from app.errors import AppError
from app.views.choice import Choice
from app.views.control.preset_row import PresetRow
from core.drive_presets import PRESETS
from core.drive_settings import DriveSettings


class PresetDesk(QObject):
    """Joins the row of presets with the files; shows which preset is in use."""

    chosen = Signal(object, str)  # DriveSettings, what was changed
    told = Signal(str)  # a trouble

    def __init__(
        self, row: PresetRow, settings: Callable[[], DriveSettings], parent: QObject | None = None
    ) -> None:
        """Prepare to serve a row.

        Args:
            row: Of presets.
            settings: Returns those in use.
            parent: Of the object.
        """
        super().__init__(parent)
        self._row, self._settings = row, settings
        # The preset chosen last, which may be one of the user's own, and its settings.
        self._last: tuple[str, DriveSettings] = ("", DriveSettings())
        row.chosen.connect(self._on_chosen)
        row.save_wanted.connect(self._on_named)
        row.delete_wanted.connect(self._on_deleted)

    def show(self) -> None:
        """List the presets and select the one whose settings are in use, if there is one."""
        names = preset_names()
        details = {name: text for name, (text, _) in PRESETS.items()}
        choices = [Choice(name, name, details.get(name, "")) for name in names]
        self._row.show_presets(
            choices, [n for n in names if n not in PRESETS], self._current(names)
        )

    def _current(self, names: list[str]) -> str:
        """Return the preset in use; keys do not belong to it."""
        now = self._settings()
        known = dict([self._last]) | {name: preset for name, (_, preset) in PRESETS.items()}
        for name, preset in known.items():
            if name in names and replace(preset, keys=now.keys) == now:
                return name
        return ""

    def _on_chosen(self, name: str) -> None:
        kept = load_preset(name)
        if kept.notes:
            self.told.emit("; ".join(kept.notes))
        self._last = (name, kept.settings)
        # Keys are one's own: another feel shall not cost them.
        self.chosen.emit(replace(kept.settings, keys=self._settings().keys), f"preset {name}")
        self.show()

    def _on_named(self, name: str) -> None:
        try:
            save_preset(name, self._settings())
        except AppError as error:
            self.told.emit(str(error))
            return
        self._last = (name.strip(), self._settings())
        self.show()

    def _on_deleted(self, name: str) -> None:
        delete_preset(name)
        self.show()
