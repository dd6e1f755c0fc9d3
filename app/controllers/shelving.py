"""The first page of the setup at work: profiles are listed, copied, emptied and deleted."""

from collections.abc import Callable
from typing import Protocol

from PySide6.QtCore import QObject, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QMessageBox

from app.errors import AppError
from app.shelf import Shelf, Shelved, name_taken, size_text
from app.views.setup.asking import CopyDialog, ask_to_confirm
from app.views.setup.start_page import StartPage
from core.errors import CoreError

CLEAR = (
    "{n} and the corrections of their landmarks will be deleted. The trained model stays, "
    "and your face is still followed with it. It can then only be improved with new pictures. "
    "This cannot be undone."
)
DELETE = "{what} ({size}) will be deleted. This cannot be undone."


class Tools(Protocol):
    """What is needed of the toolbox."""

    def shelf(self) -> Shelf:
        """Return the user's profiles."""
        ...

    def name_trouble(self, name: str) -> str:
        """Return what is wrong with the name of a profile, or an empty text."""
        ...


class ShelfController(QObject):
    """Joins the first page with the profiles on the disk."""

    copied = Signal(str)  # the name of a copy, to be opened
    failed = Signal(str)  # what to tell the user

    def __init__(
        self, page: StartPage, tools: Tools, release: Callable[[str], None],
        parent: QObject | None = None,
    ) -> None:  # fmt: skip
        """Prepare.

        Args:
            page: To show profiles in.
            tools: The rest of the program.
            release: Ends all work on the profile of a name, before something of it is deleted.
            parent: Of the object.
        """
        super().__init__(parent or page)
        self._page, self._tools, self._release = page, tools, release
        self._wishes: dict[str, Callable[[str], object]] = {
            "copy": self.copy, "clear": self.clear, "delete": self.delete, "folder": self._open,
        }  # fmt: skip
        page.wished.connect(lambda key, name: self._wishes[key](name))
        page.all_wanted.connect(lambda: self._open(""))

    def show(self) -> None:
        """List what is there now."""
        shelf = self._tools.shelf()
        self._page.show_place(str(shelf.folder), self._tools.name_trouble)
        self._page.show_profiles(shelf.profiles())

    def copy(self, name: str) -> CopyDialog:
        """Ask for the name of a copy, then make and open it."""
        dialog = CopyDialog(self._page, name, self._copy_trouble)
        dialog.accepted.connect(lambda: self._copy(name, dialog.chosen))
        dialog.open()
        return dialog

    def clear(self, name: str) -> QMessageBox:
        """Ask, then delete the pictures of a profile."""
        text = CLEAR.format(n=_counted(self._profile(name).n_pictures))
        return ask_to_confirm(
            self._page, f"Delete the pictures of {name}?", text, "&Delete the pictures",
            lambda: self._delete(self._tools.shelf().delete_pictures, name),
        )  # fmt: skip

    def delete(self, name: str) -> QMessageBox:
        """Ask, then delete a profile."""
        found = self._profile(name)
        text = DELETE.format(what=_contents(found), size=size_text(found.size_bytes))
        return ask_to_confirm(
            self._page, f"Delete the profile {name}?", text, "&Delete everything",
            lambda: self._delete(self._tools.shelf().delete, name),
        )  # fmt: skip

    def _profile(self, name: str) -> Shelved:
        return next(one for one in self._tools.shelf().profiles() if one.name == name)

    def _copy_trouble(self, name: str) -> str:
        if name_taken(self._tools.shelf().folder, name):
            return "there is a profile of this name already"
        return self._tools.name_trouble(name)

    def _copy(self, name: str, copy_name: str) -> None:
        try:
            self._tools.shelf().duplicate(name, copy_name)
        except AppError as error:
            self.failed.emit(str(error))
            return
        self.show()
        self.copied.emit(copy_name)

    def _delete(self, delete: Callable[[str], None], name: str) -> None:
        self._release(name)
        try:
            delete(name)
        except (CoreError, AppError) as error:
            self.failed.emit(str(error))
        self.show()

    def _open(self, name: str) -> None:
        """Show a folder in the system's file manager; without a name that of all profiles."""
        folder = self._tools.shelf().folder
        folder.mkdir(parents=True, exist_ok=True)
        QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder / name if name else folder)))


def _contents(found: Shelved) -> str:
    """Return what goes with a profile, without what it does not have."""
    whose = "its" if found.n_pictures == 1 else "their"
    parts = [_counted(found.n_pictures), f"{whose} landmarks"] if found.n_pictures else []
    parts += ["the trained model"] if found.trained else []
    told = " and ".join(filter(None, [", ".join(parts[:-1]), *parts[-1:]])) or "the empty profile"
    return told[:1].upper() + told[1:]


def _counted(n_pictures: int) -> str:
    return f"{n_pictures} picture{'' if n_pictures == 1 else 's'}"
