"""Dialogs for files that do not make the program wait."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import QStandardPaths, Qt
from PySide6.QtWidgets import QFileDialog, QWidget

VIDEOS = ["Videos (*.mp4 *.mov *.avi *.mkv *.webm *.m4v)", "All files (*)"]


def ask_for_video(
    parent: QWidget, title: str, chosen: Callable[[str], object],
    cancelled: Callable[[], object] = lambda: None,
) -> QFileDialog:  # fmt: skip
    """Open a dialog for a video file; one of the functions is called when it closes."""
    return _ask(parent, title, QFileDialog.FileMode.ExistingFile, chosen, cancelled)


def ask_for_folder(parent: QWidget, title: str, chosen: Callable[[str], object]) -> QFileDialog:
    """Open a dialog for a folder."""
    return _ask(parent, title, QFileDialog.FileMode.Directory, chosen, lambda: None)


def ask_where_to_save(
    parent: QWidget, title: str, name: str, chosen: Callable[[str], object],
    filters: Sequence[str] = (),
) -> QFileDialog:  # fmt: skip
    """Open a dialog for the name of a new file; its ending follows the filter that is chosen."""
    folders = QStandardPaths.standardLocations(QStandardPaths.StandardLocation.DocumentsLocation)
    dialog = QFileDialog(parent, title, folders[0] if folders else "")
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    if filters:
        dialog.setNameFilters(list(filters))
        dialog.filterSelected.connect(lambda text: dialog.setDefaultSuffix(_suffix(text)))
        dialog.setDefaultSuffix(_suffix(filters[0]))
    dialog.selectFile(name)
    dialog.fileSelected.connect(chosen)
    dialog.open()
    return dialog


def _suffix(filter_text: str) -> str:
    """Return the ending of a filter such as "PDF (*.pdf)"."""
    return filter_text.rpartition("*.")[2].rstrip(")")


def _ask(
    parent: QWidget, title: str, mode: QFileDialog.FileMode, chosen: Callable[[str], object],
    cancelled: Callable[[], object],
) -> QFileDialog:  # fmt: skip
    folders = QStandardPaths.standardLocations(QStandardPaths.StandardLocation.MoviesLocation)
    dialog = QFileDialog(parent, title, folders[0] if folders else "")
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.setFileMode(mode)
    if mode == QFileDialog.FileMode.ExistingFile:
        dialog.setNameFilters(VIDEOS)
    else:
        dialog.setOption(QFileDialog.Option.ShowDirsOnly)
    dialog.fileSelected.connect(chosen)
    dialog.rejected.connect(cancelled)
    dialog.open()
    return dialog
