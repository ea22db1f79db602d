"""The layout of tables in a terminal: no name, id or kind is ever broken over lines.

A table that is wider than the terminal gives way in this order: columns of text wrap at spaces and
others are cut in the middle, heads break at their spaces, gaps shrink, text moves below its row,
and at last the first column stands on a line of its own above the others. Rows may have headings,
which stand above them at any width.
"""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from rich.cells import cell_len, chop_cells
from rich.text import Text

from drivora_service.visible_text import visible_text

_MARGIN = " "
_STEP = "  "
_LEAST_WRAPPED = 24
_LEAST_CUT = 14


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """The content of a table.

    Attributes:
        columns: The heads; a newline in one always breaks it.
        rows: A text each column.
        wrap: Columns of prose, which may break at their spaces.
        cut: Columns whose middle may be left out.
        headings: A heading each row, which stands above the rows that follow one another with it;
            empty: none.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    wrap: frozenset[str]
    cut: frozenset[str]
    headings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class _Layout:
    shown: tuple[int, ...]
    widths: tuple[int, ...]
    heads: tuple[tuple[str, ...], ...]
    gap: int
    below: tuple[int, ...] = ()
    above: bool = False


def table_of(
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    wrap: Collection[str] = (),
    cut: Collection[str] = (),
    headings: Sequence[str] = (),
) -> Table:
    """Returns a table of plain text: colors and line breaks in cells are removed."""
    return Table(
        columns=tuple(map(_visible_head, columns)),
        rows=tuple(tuple(_plain(cell) for cell in row) for row in rows),
        wrap=frozenset(map(_visible_head, wrap)),
        cut=frozenset(map(_visible_head, cut)),
        headings=tuple(map(_plain, headings)),
    )


def table_lines(table: Table, width: int) -> tuple[list[str], list[str]]:
    """Lays a table out.

    Args:
        table: The content.
        width: Width of the terminal, characters.

    Returns:
        The lines of its head, and those of its rows.
    """
    margin = _MARGIN + (_STEP if table.headings else "")
    layout = _layout(table, width - len(margin))
    indent = margin + (_STEP if layout.above else "")
    head = [
        *([margin + " ".join(table.columns[0].split())] if layout.above else []),
        *_lines(layout.heads, layout, indent),
    ]
    body: list[str] = []
    heading = ""
    for number, row in enumerate(table.rows):
        if table.headings and table.headings[number] != heading:
            heading = table.headings[number]
            body += _wrap_text(heading, width - len(_MARGIN), _MARGIN)
        if layout.above:
            body.append(margin + row[0])
        cells = [
            _fit_text(row[index], width_of, wraps=table.columns[index] in table.wrap)
            for index, width_of in zip(layout.shown, layout.widths, strict=True)
        ]
        body += _lines(cells, layout, indent)
        for index in layout.below:
            below = margin + _STEP + _MARGIN
            body += _wrap_text(row[index], width - len(below), below)
    head = [line for line in head if line]
    ruler = max((cell_len(line) for line in (*head, *body)), default=0)
    return [*head, _MARGIN + "─" * max(ruler - len(_MARGIN), 0)], body


def _layout(table: Table, width: int) -> _Layout:
    every = tuple(range(len(table.columns)))
    flexible = {
        index: _LEAST_WRAPPED if name in table.wrap else _LEAST_CUT
        for index, name in enumerate(table.columns)
        if name in table.wrap | table.cut
    }
    prose = tuple(index for index in every if table.columns[index] in table.wrap)
    without_prose = tuple(index for index in every if index not in prose)
    attempts = [
        (every, False, 2, False, False),
        (every, False, 2, True, False),
        (every, True, 2, True, False),
        (every, True, 1, True, False),
        (without_prose, True, 2, True, False),
        (without_prose, True, 1, True, False),
        (without_prose[1:], False, 2, True, True),
        (without_prose[1:], True, 1, True, True),
    ]
    layout = None
    for shown, breaks, gap, gives_way, above in attempts:
        heads = tuple(_head(table.columns[index], breaks=breaks) for index in shown)
        natural = [
            max(cell_len(text) for text in (*head, *(row[index] for row in table.rows)))
            for index, head in zip(shown, heads, strict=True)
        ]
        room = width - (len(_STEP) if above else 0) - gap * max(len(shown) - 1, 0)
        least = [
            min(wide, flexible[index]) if gives_way and index in flexible else wide
            for index, wide in zip(shown, natural, strict=True)
        ]
        layout = _Layout(
            shown=shown,
            widths=tuple(_shared(least, natural, room)),
            heads=heads,
            gap=gap,
            below=tuple(index for index in prose if index not in shown),
            above=above,
        )
        if sum(least) <= room:
            break
    assert layout is not None
    return layout


def _shared(least: Sequence[int], natural: Sequence[int], room: int) -> list[int]:
    """Hands the room that is left to the columns that lack some, the narrowest first."""
    widths = [*least]
    left = room - sum(least)
    lacking = sorted(
        (index for index in range(len(least)) if natural[index] > least[index]),
        key=lambda index: natural[index],
    )
    while left > 0 and lacking:
        index = lacking.pop(0)
        more = min(natural[index] - widths[index], left // (len(lacking) + 1))
        widths[index] += more
        left -= more
    return widths


def _head(name: str, *, breaks: bool) -> tuple[str, ...]:
    return tuple(name.split() if breaks else name.split("\n")) or ("",)


def _fit_text(text: str, width: int, *, wraps: bool) -> tuple[str, ...]:
    if cell_len(text) <= width:
        return (text,)
    if wraps:
        return tuple(_wrap_text(text, width, ""))
    return (shorten_text(text, width),)


def shorten_text(text: str, width: int) -> str:
    """Returns a text with its middle replaced by ``…`` where it is wider than `width` cells."""
    if cell_len(text) <= width:
        return text
    front = chop_cells(text, (width - 1 + 1) // 2)[0]
    back = chop_cells(text[::-1], max(width - 1 - cell_len(front), 1))[0][::-1]
    return f"{front}…{back}"


def _wrap_text(text: str, width: int, indent: str) -> list[str]:
    return [
        indent + line
        for line in textwrap.wrap(
            text, max(width, 1), break_long_words=False, break_on_hyphens=False
        )
    ]


def _lines(cells: Sequence[Sequence[str]], layout: _Layout, indent: str) -> list[str]:
    """Joins cells of several lines each."""
    gap = " " * layout.gap
    lines = []
    for number in range(max((len(cell) for cell in cells), default=0)):
        texts = [cell[number] if number < len(cell) else "" for cell in cells]
        padded = [
            text + " " * (width - cell_len(text))
            for text, width in zip(texts, layout.widths, strict=True)
        ]
        lines.append((indent + gap.join(padded)).rstrip())
    return lines


def _visible_head(text: str) -> str:
    return visible_text(text, has_lines=True)


def _plain(text: str) -> str:
    """Returns a text on one line, without colors, and with what else would act made visible."""
    if not text:
        return ""
    return visible_text(" ".join(Text.from_ansi(text).plain.split("\n")))
