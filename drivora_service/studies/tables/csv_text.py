"""CSV files with text that spreadsheets do not take for formulas."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

_MARK = "'"
_MARKED = frozenset(
    ("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d", "\uff0b", "\uff0d", "\uff20", _MARK)
)
"""First characters of texts that get a mark: those of formulas, full-width ones among them."""


def safe_text(text: str) -> str:
    """Returns a text as it is written into a cell: behind a mark if it would be a formula.

    Labels and names come from clients and agents, and a spreadsheet would execute them. A text that
    begins with the mark itself gets one, too, so that removing the first mark of a cell always
    gives the text.
    """
    return _MARK + text if text[:1] in _MARKED else text


def safe_cells(cells: Iterable[object]) -> list[object]:
    """Returns the cells of a line, all texts as :func:`safe_text` writes them."""
    return [safe_text(cell) if isinstance(cell, str) else cell for cell in cells]


def write_csv(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Writes a CSV file: a line of columns, then the rows; ``None`` is an empty cell."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(map(safe_cells, rows))
