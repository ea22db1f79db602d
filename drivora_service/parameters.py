"""Parameters of plug-ins: what a user wrote, checked against the fields of a dataclass."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from drivora_service.errors import DrivoraError, SearchError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

P = TypeVar("P", bound="DataclassInstance")

_ATTRIBUTE = re.compile(r"^    (\w+): (.+(?:\n     .+)*)", re.MULTILINE)


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterDescription:
    """A parameter that a plug-in takes.

    Attributes:
        default: Its value unless it is set, as it stands in JSON.
        schema: JSON Schema of the values that it may have.
        description: For people; "" where its author says nothing.
    """

    name: str
    default: Any
    schema: Mapping[str, Any]
    description: str


def describe_parameters(type_: type[DataclassInstance]) -> tuple[ParameterDescription, ...]:
    """Describes the fields of a dataclass as :func:`read_parameters` takes them.

    The descriptions come from the section ``Attributes`` of its docstring.
    """
    described = _adapter(type_).json_schema()
    section = (inspect.getdoc(type_) or "").partition("Attributes:\n")[2]
    texts = {name: " ".join(text.split()) for name, text in _ATTRIBUTE.findall(section)}
    return tuple(
        ParameterDescription(
            name=name,
            default=schema.get("default"),
            schema={key: value for key, value in schema.items() if key not in _NOT_TYPE},
            description=texts.get(name, ""),
        )
        for name, schema in described.get("properties", {}).items()
    )


@cache
def _adapter(type_: type[Any]) -> TypeAdapter[Any]:
    """Gives what checks a dataclass; to make it takes longer than a second of simulation."""
    return TypeAdapter(type_)


_NOT_TYPE = frozenset({"default", "title", "description"})


def read_parameters(
    type_: type[P],
    parameters: Mapping[str, Any],
    *,
    of: str,
    error: Callable[[str], DrivoraError] = SearchError,
) -> P:
    """Makes a dataclass from what a user wrote.

    Types are checked strictly: text is no number, and 1 is not true. Limits that the fields state
    (``Annotated[int, Field(ge=1)]``) hold.

    Args:
        type_: The dataclass; every field has a default.
        parameters: Values by field name, as they can stand in JSON.
        of: What takes the parameters, for messages: ``tester 'random'``.
        error: Makes the error to raise from its message.

    Raises:
        DrivoraError: As ``error`` makes it, if there is no such parameter, or its value is not
            allowed.
    """
    known = tuple(field.name for field in fields(type_))
    for name in parameters:
        if name not in known:
            allowed = f"known: {', '.join(known)}" if known else "it takes none: leave them out"
            raise error(f"{of} has no parameter {name!r}; {allowed}")
    try:
        text = json.dumps(dict(parameters), allow_nan=False)
    except (TypeError, ValueError) as problem:
        raise error(
            f"{of}: the parameters hold what JSON cannot ({problem}); allowed: finite numbers, "
            "text, true, false, lists"
        ) from problem
    try:
        read: P = _adapter(type_).validate_json(text, strict=True)
    except ValidationError as invalid:
        found = "; ".join(
            f"{'.'.join(map(str, problem['loc']))} is {problem['input']!r}: {problem['msg']}"
            for problem in invalid.errors(include_url=False)
        )
        raise error(f"{of}: {found}") from invalid
    return read
