"""The report of a training as a file of its own: HTML or PDF, with the plots in it."""

import os
from base64 import b64encode
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from PySide6.QtCore import QBuffer, QIODevice, QMarginsF, QUrl
from PySide6.QtGui import QFont, QImage, QPageLayout, QPageSize, QPdfWriter, QTextDocument

from app.errors import AppError
from app.report import report_page

FILTERS = ["Web page (*.html)", "PDF (*.pdf)"]
#: Width of a plot on paper in dots of a usual screen: two stand side by side.
PLOT_WIDTH = 310


class ReportUnwritableError(AppError):
    """A report cannot be written where it was asked for."""

    def __init__(self, path: Path, reason: str) -> None:
        self.path, self.reason = path, reason
        super().__init__(f"cannot write {path}: {reason}. Choose another folder or name")


def write_report(path: Path, title: str, body: str, plots: Mapping[str, QImage]) -> Path:
    """Write a report; what the name ends on says how.

    Args:
        path: Ends on .pdf, or else becomes a web page.
        title: Of the document.
        body: HTML without links.
        plots: Title -> picture, shown at the end.

    Returns:
        Where it is.

    Raises:
        ReportUnwritableError: It cannot be written.
    """
    if path.suffix.lower() == ".pdf":
        _replace(path, _pdf(title, body, plots))
        return path
    path = path if path.suffix.lower() in (".html", ".htm") else path.with_name(f"{path.name}.html")
    pictures = "".join(
        f"<figure><img src='data:image/png;base64,{b64encode(_png(image)).decode()}' "
        f"alt='{name}'></figure>"
        for name, image in plots.items()
    )
    _replace(path, report_page(title, body + pictures).encode("utf-8"))
    return path


def _replace(path: Path, content: bytes) -> None:
    """Write a file, whole or not at all: a report of that name stays until the new one is there."""
    fresh = path.with_name(path.name + ".new")
    try:
        fresh.write_bytes(content)
        os.replace(fresh, path)
    except OSError as error:
        with suppress(OSError):
            fresh.unlink()
        raise ReportUnwritableError(path, (error.strerror or str(error)).lower()) from None


def _png(image: QImage) -> bytes:
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    image.save(buffer, "PNG")  # type: ignore[call-overload]
    return bytes(buffer.data().data())


def _pdf(title: str, body: str, plots: Mapping[str, QImage]) -> bytes:
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    writer = QPdfWriter(buffer)
    writer.setTitle(f"facepuppet: {title}")
    # The document brings its own margins of 2 cm.
    page, none = QPageSize(QPageSize.PageSizeId.A4), QMarginsF(0, 0, 0, 0)
    writer.setPageLayout(QPageLayout(page, QPageLayout.Orientation.Portrait, none))
    document = QTextDocument()
    font = QFont()
    font.setPointSizeF(9.0)
    document.setDefaultFont(font)
    cells = []
    for number, (name, image) in enumerate(plots.items()):
        address = QUrl(f"plot:{number}")
        document.addResource(QTextDocument.ResourceType.ImageResource.value, address, image)
        cells.append(f"<td><img src='plot:{number}' width='{PLOT_WIDTH}' alt='{name}'></td>")
    rows = ["".join(cells[n : n + 2]) for n in range(0, len(cells), 2)]
    document.setHtml(f"{body}<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>")
    document.print_(writer)
    return bytes(buffer.data().data())
