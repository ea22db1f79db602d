"""Output of commands: a table, or JSON for programs; progress goes to standard error."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, Protocol, TypeVar

import typer

from drivora_service.errors import UnknownName
from drivora_service.visible_text import visible_text


class Named(Protocol):
    """An entry of a catalogue."""

    @property
    def name(self) -> str:
        """Its name."""
        ...


Entry = TypeVar("Entry", bound=Named)

JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON for programs.")]


def say(text: str = "", *, is_error: bool = False, ends_line: bool = True) -> None:
    r"""Prints a text; all commands print by this function.

    Names and texts of agents may have characters that act on a terminal: it gets them as they are
    written in JSON, such as ``\u001b``.

    Args:
        text: One line or several.
        is_error: Whether it goes to standard error.
        ends_line: Whether a line feed follows.
    """
    typer.echo(visible_text(text, has_lines=True), err=is_error, nl=ends_line)


def print_json(value: Any) -> None:
    """Prints one JSON value; numbers that are not finite become null."""
    say(json.dumps(finite(value), indent=2, ensure_ascii=False, allow_nan=False))


def print_shape(kind: Any, value: object) -> None:
    """Prints a value of a type as the JSON that the API has for it."""
    from drivora_service.shapes import adapter

    print_json(adapter(kind).dump_python(value, mode="json"))


def find_entry(kind: str, name: str, entries: Iterable[Entry]) -> Entry:
    """Returns the entry of a catalogue with a name.

    Args:
        kind: Kind of the entries, for the message.
        name: Name of the entry.
        entries: All entries.

    Raises:
        UnknownName: There is no entry of that name.
    """
    known = {entry.name: entry for entry in entries}
    if name not in known:
        raise UnknownName(kind, name, tuple(known))
    return known[name]


def write_text(text: str, out: Path | None) -> None:
    """Writes a text to a file and prints its name, or prints the text itself."""
    if out is None:
        say(text, ends_line=False)
        return
    from drivora_service.cli.terminal.out_option import convert_write_errors

    with convert_write_errors(out):
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(text)
    say(str(out))


def print_table(
    title: str,
    columns: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    wrap: Collection[str] = (),
    cut: Collection[str] = (),
    headings: Sequence[str] = (),
) -> None:
    """Prints a table; text is shown as it is, without markup.

    Args:
        title: Above it, if any.
        columns: Their heads.
        rows: A text each column.
        wrap: Columns of prose, which may break at their spaces where the terminal is too narrow.
        cut: Columns whose middle may be left out there. The others are always shown whole.
        headings: A heading each row, above the rows that follow one another with it.
    """
    from rich.console import Console
    from rich.text import Text

    from drivora_service.cli.terminal.table_layout import table_lines, table_of

    console = Console(soft_wrap=True)
    table = table_of(columns, [*rows], wrap=wrap, cut=cut, headings=headings)
    head, body = table_lines(table, console.width)
    if title:
        console.print(Text(visible_text(title), style="italic"))
    console.print()
    for line in head[:-1]:
        console.print(Text(line, style="bold"))
    for line in (head[-1], *body):
        console.print(Text(line))
    console.print()


def print_prose(text: str) -> None:
    """Prints a paragraph, broken at spaces where the terminal ends."""
    import textwrap

    from rich.console import Console

    say(textwrap.fill(text, Console().width, break_long_words=False, break_on_hyphens=False))


def note(message: str) -> None:
    """Prints a remark to standard error."""
    say(message, is_error=True)


def fail(message: str) -> None:
    """Prints an error to standard error."""
    typer.secho(visible_text(message, has_lines=True), err=True, fg=typer.colors.RED)


def number(value: float | None, digits: int = 1) -> str:
    """Returns a number as text for a table; a dash if it is not measurable."""
    return "-" if value is None else f"{value:.{digits}f}"


def finite(value: Any) -> Any:
    """Returns a JSON value with null in place of numbers that are not finite."""
    if isinstance(value, float):
        return value if value - value == 0.0 else None
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return value
