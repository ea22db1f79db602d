"""Text and tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

# An underscore between letters or digits is none: names have them.
_MARKUP = re.compile(r"[\\`*\[\]<|&~]|_(?![^\W_])|(?<![^\W_])_")
_MARKUP_AT_THE_BEGINNING = (">", "#", "-", "+")


class Markdown(str):
    """A cell of a table that is Markdown already, without line breaks and bars of its own."""

    __slots__ = ()


def escape_markdown(text: str) -> str:
    """Returns a text on one line, without what Markdown would read as markup or HTML."""
    line = _inline(text)
    return f"\\{line}" if line.startswith(_MARKUP_AT_THE_BEGINNING) else line


def table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Returns the lines of a table.

    Args:
        columns: Titles.
        rows: A cell a column: a text as it is meant, whatever it contains, or `Markdown`.
    """
    return [_line(columns), "|" + "---|" * len(columns), *map(_line, rows)]


def _line(cells: Sequence[str]) -> str:
    written = (cell if isinstance(cell, Markdown) else _inline(cell) for cell in cells)
    return f"| {' | '.join(written)} |"


def _inline(text: str) -> str:
    return " ".join(_MARKUP.sub(r"\\\g<0>", text).split())
