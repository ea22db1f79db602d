"""The forms in which commands print what they list, show or start: tables, or for programs."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import wraps
from typing import Annotated, Any, TypeVar

import typer

from drivora_service.cli.terminal.output import finite, print_json, say
from drivora_service.errors import ConfigurationError

Item = Mapping[str, Any]
Command = TypeVar("Command", bound=Callable[..., None])

_FIELD = re.compile(r"\{([^{}]*)\}")
_ESCAPES = {r"\t": "\t", r"\n": "\n"}
_MOST_FIELDS = 40
"""Number of fields that an error lists."""


class FormKind(StrEnum):
    """The kind of a form."""

    TABLE = "table"
    JSON = "json"
    JSONL = "jsonl"
    CSV = "csv"
    IDS = "ids"
    TEMPLATE = "template"


_NAMED = (FormKind.TABLE, FormKind.JSON, FormKind.JSONL, FormKind.CSV)

_JSON_OPTION = typer.Option("--json", help="Print JSON for programs.")
_FORMAT_OPTION = typer.Option(
    "--format",
    metavar="FORM",
    help="Print a table, json, jsonl (an object a line), csv, or for each item a line of fields "
    "such as '{id} {name}'; fields are the keys of --json, inner ones 'failures.0.kind' "
    "[default: table].",
)
_ID_OPTION = typer.Option("--id-only", help="Print only the id, of a list one a line.")


@dataclass(frozen=True, slots=True)
class Form:
    """A form of printed results.

    Attributes:
        kind: Its kind.
        template: A line with fields in braces, if it is one.
    """

    kind: FormKind = FormKind.TABLE
    template: str = ""

    @property
    def is_table(self) -> bool:
        """Whether a command prints the table that it has for users."""
        return self.kind is FormKind.TABLE

    def print_content(
        self, content: Any, items: Sequence[Item] | None = None, *, id_field: str = ""
    ) -> None:
        """Prints results in a form for programs.

        Args:
            content: What ``--json`` prints.
            items: The things in it; ``None``: the content itself, or its elements if it is a list.
            id_field: Field with the id of a thing; "": ``id``, or ``name`` if it has none.

        Raises:
            ConfigurationError: There is no such field.
        """
        if items is None:
            items = content if isinstance(content, list) else [content]
        match self.kind:
            case FormKind.JSON | FormKind.TABLE:
                print_json(content)
            case FormKind.JSONL:
                for item in items:
                    say(json.dumps(finite(item), ensure_ascii=False, allow_nan=False))
            case FormKind.CSV:
                _print_csv(items)
            case FormKind.IDS:
                for item in items:
                    if found := _id(item, id_field):
                        say(found)
            case FormKind.TEMPLATE:
                for item in items:
                    say(_fill(self.template, item))

    def print_shape(self, kind: Any, value: object, *, id_field: str = "") -> None:
        """Prints a value of a type, or a tuple of them, as the API has it."""
        from drivora_service.shapes import adapter

        self.print_content(adapter(kind).dump_python(value, mode="json"), id_field=id_field)


TABLE = Form()


def with_forms(command: Command) -> Command:
    """Gives a command the options ``--json``, ``--format`` and ``--id-only``.

    They take the place of its parameter ``form``, which gets the form that they choose.
    """

    @wraps(command)
    def run(*, as_json: bool, form: str, id_only: bool, **others: Any) -> None:
        command(form=read_form(as_json=as_json, text=form, id_only=id_only), **others)

    options = {
        "as_json": (Annotated[bool, _JSON_OPTION], False),
        "form": (Annotated[str, _FORMAT_OPTION], ""),
        "id_only": (Annotated[bool, _ID_OPTION], False),
    }
    # Typer does not read texts of annotations in a signature that is given.
    own = inspect.signature(command, eval_str=True)
    parameters = [one for one in own.parameters.values() if one.name != "form"]
    parameters += [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=kind)
        for name, (kind, default) in options.items()
    ]
    # Typer reads both.
    run.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined] # as inspect
    run.__annotations__ = {one.name: one.annotation for one in parameters}
    return run  # type: ignore[return-value] # its options are those of the command line


def read_form(*, as_json: bool, text: str, id_only: bool) -> Form:
    """Returns the form that options choose.

    Args:
        as_json: ``--json``.
        text: Value of ``--format``; "": not given.
        id_only: ``--id-only``.

    Raises:
        typer.BadParameter: It is no form, or the options exclude one another.
    """
    if as_json + bool(text) + id_only > 1:
        raise typer.BadParameter("--json, --format and --id-only exclude one another: give one")
    if as_json:
        return Form(FormKind.JSON)
    if id_only:
        return Form(FormKind.IDS)
    if not text or text in _NAMED:
        return Form(FormKind(text or FormKind.TABLE))
    fields = _FIELD.findall(text)
    if not fields:
        raise typer.BadParameter(
            f"{text!r}; known: {', '.join(_NAMED)}, and fields such as '{{id}} {{name}}'",
            param_hint="--format",
        )
    if not all(field.strip() for field in fields):
        raise typer.BadParameter(
            f"{text!r} has a field without a name; write '{{id}}'", param_hint="--format"
        )
    for written, meant in _ESCAPES.items():
        text = text.replace(written, meant)
    return Form(FormKind.TEMPLATE, text)


def _print_csv(items: Sequence[Item]) -> None:
    # Imported here: few commands print CSV.
    from drivora_service.studies.tables.csv_text import csv_lines

    columns = list(dict.fromkeys(key for item in items for key in item))
    if columns:
        say(csv_lines([columns]), ends_line=False)
    for item in items:
        say(csv_lines([[_csv_cell(item.get(column)) for column in columns]]), ends_line=False)


def _csv_cell(value: Any) -> Any:
    """Returns a value as a cell of CSV: a number stays one, all else is text."""
    value = finite(value)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return value if is_number else _cell(value)


def _id(item: Item, field: str) -> str:
    if field:
        value: Any = item
        for part in field.split("."):
            value = value.get(part) if isinstance(value, Mapping) else None
        return _cell(value)
    return _cell(item["id"] if "id" in item else item.get("name"))


def _fill(template: str, item: Item) -> str:
    return _FIELD.sub(lambda field: _cell(_value(item, field[1])), template)


def _value(item: Item, field: str) -> Any:
    """Returns the value of a field; its parts are keys, and places in lists, from 0."""
    value: Any = item
    for part in field.strip().split("."):
        if isinstance(value, Mapping) and part in value:
            value = value[part]
        elif isinstance(value, list) and part.isdecimal() and int(part) < len(value):
            value = value[int(part)]
        elif value is None:
            return None
        else:
            raise ConfigurationError(f"--format: no field {field!r} here; {_fields_of(value)}")
    return value


def _fields_of(value: Any) -> str:
    """Says which fields a value has."""
    if isinstance(value, Mapping):
        known = [str(key) for key in value]
        more = ", …" if len(known) > _MOST_FIELDS else ""
        return f"there are: {', '.join(known[:_MOST_FIELDS])}{more}"
    if isinstance(value, list):
        return f"the list has {len(value)} elements, numbered from 0"
    return f"{value!r} has no fields"


def _cell(value: Any) -> str:
    """Returns a value as text: null as nothing, lists and objects as JSON."""
    value = finite(value)
    if value is None:
        return ""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
