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
    wrap: Collection[str] = (),
    cut: Collection[str] = (),
) -> None:
    """Prints a table; text is shown as it is, without markup.

    Args:
        title: Above it, if any.
        columns: Their heads.
        rows: A text each column.
        wrap: Columns of prose, which may break at their spaces where the terminal is too narrow.
        cut: Columns whose middle may be left out there. The others are always shown whole.
    """
    from rich.console import Console
    from rich.text import Text

    from drivora_service.cli.tables import table_lines, table_of

    console = Console(soft_wrap=True)
    head, body = table_lines(table_of(columns, [*rows], wrap=wrap, cut=cut), console.width)
    if title:
        console.print(Text(title, style="italic"))
    console.print()
    for line in head[:-1]:
        console.print(Text(line, style="bold"))
    for line in (head[-1], *body):
        console.print(Text(line))
    console.print()


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
