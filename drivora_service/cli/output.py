"""What commands print: a table for people, JSON for programs; progress goes to standard error."""

from __future__ import annotations

import json
import sys
from collections.abc import Collection, Iterable, Sequence
from typing import Annotated, Any

import typer

JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON for programs.")]


def print_json(value: Any) -> None:
    """Prints one JSON value; what is not finite becomes null."""
    json.dump(_finite(value), sys.stdout, indent=2, ensure_ascii=False, allow_nan=False)
    sys.stdout.write("\n")


def print_table(
    title: str,
    columns: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    cut: Collection[str] = (),
) -> None:
    """Prints a table; text is shown as it is, without markup.

    Args:
        title: Above it, if any.
        columns: Their heads.
        rows: A text each column.
        cut: Columns that share what room is left on a line and whose texts are cut there; without
            any, all are wrapped.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    listed = [*rows]
    table = Table(
        title=title or None,
        title_justify="left",
        box=box.SIMPLE_HEAD,
        collapse_padding=True,
        pad_edge=False,
        expand=bool(cut),
    )
    for index, column in enumerate(columns):
        if column in cut:
            table.add_column(column, overflow="ellipsis", no_wrap=True, ratio=1)
        elif cut:
            table.add_column(column, width=max(len(row[index]) for row in [columns, *listed]))
        else:
            table.add_column(column, overflow="fold")
    for row in listed:
        table.add_row(*(Text.from_ansi(cell) for cell in row))
    Console().print(table)


def note(message: str) -> None:
    """Prints a remark for people to standard error."""
    typer.echo(message, err=True)


def fail(message: str) -> None:
    """Prints why something did not work to standard error."""
    typer.secho(message, err=True, fg=typer.colors.RED)


def number(value: float | None, digits: int = 1) -> str:
    """Writes a number for a table; what is not measurable is a dash."""
    return "-" if value is None else f"{value:.{digits}f}"


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if value - value == 0.0 else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return value
