"""CSV files with text that spreadsheets do not take for formulas."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from drivora_service.visible_text import visible_text

_MARK = "'"
_MARKED = frozenset(
    ("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d", "\uff0b", "\uff0d", "\uff20", _MARK)
)
"""First characters of texts that get a mark: those of formulas, full-width ones among them."""


def safe_text(text: str) -> str:
    """Returns a text as it is written into a cell: behind a mark if it would be a formula.

    Labels and names come from clients and agents, and a spreadsheet would execute them. A text that
    begins with the mark itself gets one, too, so that removing the first mark of a cell always
    gives the text. Lines stay; other characters that would act on a terminal are made visible.
    """
    shown = visible_text(text, has_lines=True)
    return _MARK + shown if text[:1] in _MARKED else shown


def safe_cells(cells: Iterable[object]) -> list[object]:
    """Returns the cells of a line, all texts as :func:`safe_text` writes them."""
    return [safe_text(cell) if isinstance(cell, str) else cell for cell in cells]


def csv_lines(rows: Iterable[Iterable[object]]) -> str:
    """Returns lines of CSV, all texts as :func:`safe_text` writes them; ``None`` is empty."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(map(safe_cells, rows))
    return text.getvalue()


def write_csv(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Writes a CSV file: a line of columns, then the rows; ``None`` is an empty cell."""
    with path.open("w", newline="") as file:
        file.write(csv_lines([columns]))
        file.write(csv_lines(rows))
