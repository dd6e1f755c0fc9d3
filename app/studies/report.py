"""What a study found: tables for people, the same as plain values for programs."""

from collections.abc import Sequence
from dataclasses import dataclass, field

#: What a cell may hold; None where there is nothing to tell.
Cell = str | float | int | None


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table.

    Attributes:
        name: Its heading, with the unit.
        digits: After the point of its numbers.
    """

    name: str
    digits: int = 2


@dataclass(frozen=True, slots=True)
class Table:
    """Named rows of cells.

    Attributes:
        title: What it shows.
        columns: After the name of the row.
        rows: Name of the row -> its cells, one per column.
    """

    title: str
    columns: Sequence[Column]
    rows: dict[str, Sequence[Cell]]

    def text(self) -> str:
        """Return the table in columns of even width."""
        body = [
            [name, *(_cell(c, column) for c, column in zip(cells, self.columns, strict=True))]
            for name, cells in self.rows.items()
        ]
        lines = [["", *(column.name for column in self.columns)], *body]
        widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
        out = [
            "  ".join(
                cell.ljust(width) if k == 0 else cell.rjust(width)
                for k, (cell, width) in enumerate(zip(line, widths, strict=True))
            ).rstrip()
            for line in lines
        ]
        return "\n".join([self.title, *out])

    def values(self) -> dict[str, object]:
        """Return the table by row and column."""
        return {
            name: dict(zip((column.name for column in self.columns), cells, strict=True))
            for name, cells in self.rows.items()
        }


@dataclass(frozen=True, slots=True)
class Report:
    """What a study found.

    Attributes:
        study: Its name.
        tables: What was measured.
        notes: How to read it, one sentence or two each.
    """

    study: str
    tables: Sequence[Table]
    notes: Sequence[str] = field(default_factory=tuple)

    def text(self) -> str:
        """Return the report for people."""
        return "\n\n".join(
            [*(table.text() for table in self.tables), "\n".join(self.notes)]
        ).strip()

    def values(self) -> dict[str, object]:
        """Return the report for programs."""
        return {
            "study": self.study,
            "tables": {table.title: table.values() for table in self.tables},
            "notes": list(self.notes),
        }


def _cell(cell: Cell, column: Column) -> str:
    if cell is None:
        return ""
    return f"{cell:.{column.digits}f}" if isinstance(cell, float) else str(cell)
