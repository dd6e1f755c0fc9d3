"""Rows that do with little room: what matters least is left out first."""

from collections.abc import Sequence

from PySide6.QtWidgets import QWidget

#: Between two pieces of a row, with what a layout adds.
GAP_PX = 12


def fit_row(pieces: Sequence[QWidget], optional: Sequence[QWidget], room_px: int) -> None:
    """Hide of a row what has no room.

    Args:
        pieces: All of the row.
        optional: Those that may be left out, the first to go first.
        room_px: The width of the row.
    """
    widths = {piece: max(piece.minimumSizeHint().width(), piece.minimumWidth()) for piece in pieces}
    needed = sum(widths.values()) + GAP_PX * len(pieces)
    for piece in optional:
        piece.setVisible(needed <= room_px)
        if needed > room_px:
            needed -= widths[piece] + GAP_PX
