"""The profiles on the disk as a shelf: what each holds; copying one, emptying one, taking one off.

A copy is made under a name that no profile can have and then renamed; one that is taken off is
renamed first and then deleted. So whatever stops the program, the shelf holds whole profiles only.
"""

import shutil
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from app.drive_files import forget_kept
from app.errors import AppError
from app.own_looks import forget_looks, forget_skin
from app.replacing import REPLACING
from core.draft import Draft
from core.errors import CoreError
from core.generations import DRAFT_NAME, HEADER_NAME, read_generation, reason_of
from core.store import IMAGES, load, save

#: Beginnings of folder names that no profile can have.
COMING, GOING = ".coming-", ".going-"


class ShelfError(AppError):
    """A profile cannot be copied or deleted."""

    def __init__(self, what: str, name: str, reason: str) -> None:
        self.name, self.reason = name, reason
        super().__init__(
            f"cannot {what} the profile {name}: {reason}; expected a profile that no other program "
            "has open, and enough free space: close what uses it and try again"
        )


@dataclass(frozen=True, slots=True)
class Shelved:
    """What is on the disk of one profile.

    Attributes:
        name: Of the profile.
        folder: Where it is.
        trained: Whether there is a model that follows a face.
        n_pictures: Pictures that can be looked at.
        n_new: Of these, and of corrections, how many no training has seen.
        size_bytes: Of everything.
        trouble: Why it cannot be used, "" if it can.
    """

    name: str
    folder: Path
    trained: bool
    n_pictures: int
    n_new: int
    size_bytes: int
    trouble: str = ""

    @property
    def without_pictures(self) -> bool:
        """Whether the model is there, but no picture."""
        return self.trained and not self.n_pictures and not self.trouble

    @property
    def note(self) -> str:
        """What state it is in, in some words for people."""
        if self.trouble:
            return "cannot be read"
        if self.without_pictures:
            return "trained; pictures deleted"
        if not self.trained:
            return "not yet trained"
        return f"trained; {self.n_new} changed since" if self.n_new else "trained"


class Shelf:
    """Looks after all profiles of one folder."""

    def __init__(self, parent: Path) -> None:
        """Look at a folder of profiles, which need not be there."""
        self._parent = parent

    @property
    def folder(self) -> Path:
        """Where the profiles are."""
        return self._parent

    def profiles(self) -> list[Shelved]:
        """Return the profiles, finished or not, in alphabetical order."""
        if not self._parent.is_dir():
            return []
        folders = sorted(self._parent.iterdir(), key=lambda path: path.name.casefold())
        return [shelved(path) for path in folders if _is_profile(path)]

    def duplicate(self, name: str, copy_name: str) -> None:
        """Copy a profile with its pictures, its corrections and its model.

        Raises:
            ShelfError: There is no copy.
        """
        target, coming = self._parent / copy_name, self._parent / (COMING + copy_name)
        if target.exists():
            raise ShelfError("copy", name, f"there is a profile {copy_name} already")
        try:
            shutil.rmtree(coming, ignore_errors=True)
            shutil.copytree(self._parent / name, coming)
            coming.rename(target)
        except (OSError, shutil.Error) as error:
            shutil.rmtree(coming, ignore_errors=True)
            raise ShelfError("copy", name, _reason(error)) from None

    def delete_pictures(self, name: str) -> None:
        """Delete the pictures of a trained profile, those not yet trained on, too; not the model.

        Raises:
            CoreError: The profile cannot be read or written.
            ShelfError: Some pictures are still there.
        """
        with REPLACING:
            self._delete_pictures(name, self._parent / name)

    def _delete_pictures(self, name: str, folder: Path) -> None:
        profile = load(folder)
        forget_skin(folder)
        save(folder, profile, {})
        # Writing takes the older generations away as far as it can; here it is promised.
        left = len(list(folder.glob(f"data-*/{IMAGES}*")))
        try:
            Draft(folder).clear()
            shutil.rmtree(folder / DRAFT_NAME, ignore_errors=True)
        except OSError as error:
            raise ShelfError("delete the pictures of", name, _reason(error)) from None
        if left or (folder / DRAFT_NAME).exists():
            raise ShelfError("delete the pictures of", name, "some of them could not be removed")

    def delete(self, name: str) -> None:
        """Delete a profile with all that belongs to it.

        Raises:
            ShelfError: It is still there.
        """
        going = self._parent / (GOING + name)
        shutil.rmtree(going, ignore_errors=True)
        with REPLACING:
            try:
                (self._parent / name).rename(going)
            except OSError as error:
                raise ShelfError("delete", name, _reason(error)) from None
            forget_looks(self._parent / name)
        # A new person of this name sits elsewhere and rests otherwise.
        forget_kept(name)
        with suppress(OSError):
            shutil.rmtree(going)


def shelved(folder: Path) -> Shelved:
    """Return what is on the disk of one profile."""
    draft = Draft(folder)
    drafts = [draft.get(name) for name in draft.names()]
    trained, pictures, trouble = (folder / HEADER_NAME).exists(), set[str](), ""
    if trained:
        try:
            names = [name for name in read_generation(folder).files if name.startswith(IMAGES)]
            pictures = {Path(name).stem for name in names}
        except CoreError as error:
            trouble = str(error)
    pictures |= {Path(one.picture_name).stem for one in drafts if one and one.picture_name}
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    return Shelved(folder.name, folder, trained, len(pictures), len(drafts), size, trouble)


def size_text(size_bytes: int) -> str:
    """Return a size on the disk for people."""
    if size_bytes < 1_000_000:
        return f"{max(1, round(size_bytes / 1000))} kB"
    return f"{size_bytes / 1e6:.1f} MB" if size_bytes < 10_000_000 else f"{size_bytes / 1e6:.0f} MB"


def name_taken(folder: Path, name: str) -> bool:
    """Return whether a profile of this name is there, on disks that ignore case, too."""
    there = folder.iterdir() if folder.is_dir() else ()
    return name.casefold() in {path.name.casefold() for path in there}


def _is_profile(folder: Path) -> bool:
    if folder.name.startswith(".") or not folder.is_dir():
        return False
    return (folder / HEADER_NAME).exists() or bool(Draft(folder).names())


def _reason(error: Exception) -> str:
    return reason_of(error) if isinstance(error, OSError) and error.errno else str(error)
