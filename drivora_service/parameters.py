"""Parameters of plug-ins: a user's values, checked against the fields of a dataclass."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from drivora_service.errors import DrivoraError, Problem, SearchError
from drivora_service.known_names import advise_name, list_names

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

P = TypeVar("P", bound="DataclassInstance")

_ATTRIBUTE = re.compile(r"^    (\w+): (.+(?:\n     .+)*)", re.MULTILINE)


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterDescription:
    """A parameter of a plug-in.

    Attributes:
        default: Its default value, as in JSON.
        schema: JSON Schema of its values.
        description: Description in words; "" if it has none.
    """

    name: str
    default: Any
    schema: Mapping[str, Any]
    description: str


def describe_parameters(type_: type[DataclassInstance]) -> tuple[ParameterDescription, ...]:
    """Describes the fields of a dataclass as :func:`read_parameters` takes them.

    The descriptions come from the section ``Attributes`` of its docstring, or from the fields.
    """
    section = (inspect.getdoc(type_) or "").partition("Attributes:\n")[2]
    texts = {name: " ".join(text.split()) for name, text in _ATTRIBUTE.findall(section)}
    return tuple(
        ParameterDescription(
            name=name,
            default=schema.get("default"),
            schema={key: value for key, value in schema.items() if key not in _NOT_TYPE},
            description=texts.get(name, schema.get("description", "")),
        )
        for name, schema in _schemas(type_).items()
    )


def _schemas(type_: type[DataclassInstance]) -> Mapping[str, Mapping[str, Any]]:
    """Returns the JSON Schema of each field, in which no reference leads elsewhere."""
    described = _adapter(type_).json_schema()
    definitions = described.get("$defs", {})
    return {
        name: _inline_references(schema, definitions)
        for name, schema in described.get("properties", {}).items()
    }


def _inline_references(schema: Any, definitions: Mapping[str, Any]) -> Any:
    """Returns a schema with what its references stand for; a reference's own keys go before."""
    if isinstance(schema, list):
        return [_inline_references(one, definitions) for one in schema]
    if not isinstance(schema, dict):
        return schema
    own = {
        key: _inline_references(value, definitions)
        for key, value in schema.items()
        if key != "$ref"
    }
    if "$ref" not in schema:
        return own
    name = schema["$ref"].rpartition("/")[2]
    # What contains itself ends here.
    others = {key: value for key, value in definitions.items() if key != name}
    stands_for = _inline_references(definitions.get(name, {}), others)
    return {**{key: stands_for[key] for key in stands_for if key not in _NOT_TYPE}, **own}


@cache
def _adapter(type_: type[Any]) -> TypeAdapter[Any]:
    """Returns the validator of a dataclass; making it takes longer than a second of simulation."""
    return TypeAdapter(type_)


WITHIN_BUDGET = "x-within-budget"
"""Key of the schema of a parameter that may not exceed the budget of simulations."""

_NOT_TYPE = frozenset({"default", "title", "description"})
_SHOWN = 60
"""Greatest number of characters of a value in a message."""


def parameter_problems(
    type_: type[DataclassInstance], parameters: Mapping[str, Any], *, of: str
) -> tuple[Problem, ...]:
    """Returns all problems of a user's values.

    Args:
        type_: As for :func:`read_parameters`.
        parameters: As for :func:`read_parameters`.
        of: As for :func:`read_parameters`.

    Returns:
        Problems with pointers that begin at the parameters: ``/rate``.
    """
    known = tuple(field.name for field in fields(type_))
    problems = [_unknown(name, known, of) for name in parameters if name not in known]
    taken = {name: value for name, value in parameters.items() if name in known}
    try:
        text = json.dumps(taken, allow_nan=False)
    except (TypeError, ValueError) as error:
        message = (
            f"{of}: the parameters are not valid in JSON ({error}); allowed: finite numbers, text, "
            "true, false, lists"
        )
        return (*problems, Problem(pointer="", code="not_json", message=message))
    try:
        _adapter(type_).validate_json(text, strict=True)
    except ValidationError as invalid:
        schemas = _schemas(type_)
        for flaw in invalid.errors(include_url=False):
            place = _place(flaw["loc"], taken)
            schema = schemas.get(place[0], {}) if place else {}
            allowed = f"allowed: {describe_allowed_values(schema)}" if schema else flaw["msg"]
            problems.append(
                Problem(
                    pointer="".join(f"/{_escape_key(key)}" for key in place),
                    code=flaw["type"],
                    message=f"{of}: {'.'.join(place)} is {_format_value(flaw['input'])}; {allowed}",
                )
            )
    return tuple(problems)


def describe_allowed_values(schema: Mapping[str, Any]) -> str:
    """Describes the allowed values of a parameter in words.

    Args:
        schema: JSON Schema, as in :class:`ParameterDescription`.
    """
    if "anyOf" in schema:
        return " or ".join(describe_allowed_values(choice) for choice in schema["anyOf"])
    if "enum" in schema or "const" in schema:
        return list_names([json.dumps(one) for one in schema.get("enum", (schema.get("const"),))])
    match schema.get("type"):
        case "number" | "integer" as kind:
            words = _number_in_words("a number" if kind == "number" else "an integer", schema)
            return f"{words}, not above the budget" if schema.get(WITHIN_BUDGET) else words
        case "boolean":
            return "true or false"
        case "string":
            return "text"
        case "null":
            return "null"
        case "array":
            return f"a list, each of it {describe_allowed_values(schema.get('items', {}))}"
        case _:
            return json.dumps({k: v for k, v in schema.items() if k not in _NOT_TYPE})


def _number_in_words(noun: str, schema: Mapping[str, Any]) -> str:
    low, high = schema.get("minimum"), schema.get("maximum")
    if low is not None and high is not None:
        return f"{noun} from {low:g} to {high:g}"
    bounds = {
        "of at least": low,
        "above": schema.get("exclusiveMinimum"),
        "of at most": high,
        "below": schema.get("exclusiveMaximum"),
    }
    told = " and ".join(
        f"{words} {limit:g}" for words, limit in bounds.items() if limit is not None
    )
    return f"{noun} {told}" if told else noun


def _unknown(name: str, known: tuple[str, ...], of: str) -> Problem:
    allowed = advise_name(name, known) or "it takes none: leave them out"
    return Problem(
        pointer=f"/{_escape_key(name)}",
        code="unknown_parameter",
        message=f"{of} has no parameter {name[:80]!r}; {allowed}",
    )


def _place(keys: Iterable[str | int], content: Any) -> list[str]:
    """Returns the keys that exist in the content; further ones are names of types."""
    place = []
    for key in keys:
        try:
            content = content[key]
        except (IndexError, KeyError, TypeError):
            break
        place.append(str(key))
    return place


def _format_value(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."


def _escape_key(key: str) -> str:
    """Escapes a key for a JSON pointer."""
    return key.replace("~", "~0").replace("/", "~1")


def read_parameters(
    type_: type[P],
    parameters: Mapping[str, Any],
    *,
    of: str,
    error: Callable[[str], DrivoraError] = SearchError,
) -> P:
    """Makes a dataclass from a user's values.

    Types are checked strictly: text is no number, and 1 is not true. Limits that the fields state
    (``Annotated[int, Field(ge=1)]``) hold.

    Args:
        type_: The dataclass; every field has a default.
        parameters: Values by field name, as in JSON.
        of: Owner of the parameters, for messages: ``tester 'random'``.
        error: Makes the error to raise from its message.

    Raises:
        DrivoraError: As ``error`` makes it, naming every unknown parameter and every value that is
            not allowed.
    """
    problems = parameter_problems(type_, parameters, of=of)
    if problems:
        raise error("; ".join(problem.message for problem in problems))
    read: P = _adapter(type_).validate_json(json.dumps(dict(parameters)), strict=True)
    return read
