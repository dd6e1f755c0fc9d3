"""The cells of the contact sheet: what a picture's quality means to people."""

from app.controllers.prompts import title_of_prompt
from app.views.setup.contact_sheet import SheetCell
from app.workbook import Workbook

AGAIN = "click to take it again"


def cell_of(book: Workbook | None, name: str) -> SheetCell:
    """Return the cell of a prompt.

    Args:
        book: The pictures that there are.
        name: The prompt's.
    """
    title = title_of_prompt(name)
    if book is None or name not in book.names:
        return SheetCell(name, title, "missing", "not taken yet; click to take it")
    if name in book.taken_out:
        return SheetCell(name, title, "weak", f"left out of the next training; {AGAIN}", "left out")
    weak = str(book.quality(name).get("weak", ""))
    if weak:
        return SheetCell(name, title, "weak", f"{weak}; {AGAIN}", weak)
    return SheetCell(name, title, "good", f"good; {AGAIN}")
