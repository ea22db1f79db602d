"""Text and tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from drivora_service.visible_text import visible_text

# An underscore between letters or digits is none: names have them.
_MARKUP = re.compile(r"[\\`*\[\]<|&~]|_(?![^\W_])|(?<![^\W_])_")
_CODE = re.compile("(?<!`)`([^`]+)`(?!`)")
_MARKUP_AT_THE_BEGINNING = (">", "#", "-", "+", "=")


class Markdown(str):
    """A cell of a table that is Markdown already, without line breaks and bars of its own."""

    __slots__ = ()


def escape_markdown(text: str) -> str:
    """Returns a text on one line, without what Markdown would read as markup or HTML.

    Characters that act on what shows the text are made visible; see ``visible_text``.
    """
    line = _inline(text)
    return f"\\{line}" if line.startswith(_MARKUP_AT_THE_BEGINNING) else line


def escape_prose(text: str) -> str:
    """Returns sentences on one line, as :func:`escape_markdown`, but with code in them as code.

    Notes and advice name commands between backticks.
    """
    parts = _CODE.split(" ".join(text.split()))
    # Every second part is what was between two backticks.
    line = "".join(
        code_span(part) if number % 2 else _escape(part) for number, part in enumerate(parts)
    )
    return f"\\{line}" if line.startswith(_MARKUP_AT_THE_BEGINNING) else line


def code_span(text: str) -> str:
    """Returns a text as code on one line: a delimiter is longer than any that the text has."""
    line = visible_text(" ".join(text.split()))
    longest = max(map(len, re.findall("`+", line)), default=0)
    fence = "`" * (longest + 1)
    # Blanks beside a backtick, or beside blanks, are no part of the code.
    blank = " " if not line or line[0] in "` " or line[-1] in "` " else ""
    return f"{fence}{blank}{line}{blank}{fence}"


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
    return _escape(" ".join(text.split()))


def _escape(line: str) -> str:
    return _MARKUP.sub(r"\\\g<0>", visible_text(line))
