"""Shapes: dataclasses that are read from rows, written as JSON and documented in one declaration.

A shape is declared once. The store fills it from columns of the same names, the API serves it, and
clients read it back; the descriptions in the JSON schema are those of its docstring.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Mapping
from dataclasses import fields
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from pydantic import GetJsonSchemaHandler, TypeAdapter
    from pydantic.json_schema import JsonSchemaValue
    from pydantic_core import CoreSchema

T = TypeVar("T")

_ATTRIBUTE = re.compile(r"^    (\w+): (.*(?:\n {8,}.*)*)", re.MULTILINE)


class Shape:
    """A dataclass that is part of the public JSON."""

    __slots__ = ()

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Returns the JSON schema with the descriptions of the docstring."""
        schema = handler(core_schema)
        own = handler.resolve_ref_schema(schema)
        own["description"] = (inspect.getdoc(cls) or "").partition("\n\nAttributes:")[0]
        described = descriptions(cls)
        for name, part in own.get("properties", {}).items():
            if name in described:
                part["description"] = described[name]
        return schema


def descriptions(kind: Any) -> Mapping[str, str]:
    """Returns the descriptions of attributes in the docstrings of a class and its bases."""
    found: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        _, _, attributes = (inspect.cleandoc(base.__doc__ or "")).partition("\n\nAttributes:\n")
        for match in _ATTRIBUTE.finditer(attributes):
            found[match[1]] = re.sub(r"\s+", " ", match[2]).replace("``", "`")
    return found


def field_names(kind: Any) -> tuple[str, ...]:
    """Returns the names of the fields of a dataclass."""
    return _field_names(kind)


def combine(kind: type[T], /, *sources: object, **given: object) -> T:
    """Makes a dataclass of the attributes of others.

    Args:
        kind: Class to make.
        sources: Objects in which each field that is not given is looked up by its name, in order. A
            field that none has keeps its default.
        given: Fields by name.
    """
    values = dict(given)
    for name in field_names(kind):
        if name in values:
            continue
        for source in sources:
            if hasattr(source, name):
                values[name] = getattr(source, name)
                break
    return kind(**values)


def read_all(kind: type[T], values: Iterable[Mapping[str, object]]) -> tuple[T, ...]:
    """Reads dataclasses from mappings such as the rows of a query; text becomes enums."""
    read = adapter(kind).validate_python
    return tuple(read(dict(one)) for one in values)


def adapter(kind: Any) -> TypeAdapter[Any]:
    """Returns the adapter that reads and writes a type as JSON; made on first use."""
    return _adapter(kind)


def to_json(kind: Any, value: object) -> bytes:
    """Writes a value of a type as JSON; NaN and infinities become ``null``."""
    return adapter(kind).dump_json(value)


@cache
def _field_names(kind: Any) -> tuple[str, ...]:
    return tuple(one.name for one in fields(kind))


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    from pydantic import TypeAdapter

    return TypeAdapter(kind)
