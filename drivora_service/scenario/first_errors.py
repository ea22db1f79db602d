"""The first of many structural errors of a document, at a cost that their number does not set.

pydantic lists either all errors of a document or none, a dictionary each. A document of a few
megabytes may have half a million. So of a document with very many, its beginning is checked again:
of each list the first items, of each object the known keys and the first others.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from drivora_service.scenario.plain_data import MAX_PROBLEMS

_FEW = 2000
"""Errors that are listed within some milliseconds."""
_FIRST = 2 * MAX_PROBLEMS
_MORE = 8
"""Factor by which the beginning grows while it has too few errors."""
_OF_WHOLES = frozenset({"value_error", "assertion_error"})
"""Errors that a value may have only because a part of it was left out. A list is not too short for
that: what is left of it is longer than any least length."""

Place = tuple[str | int, ...]


def first_errors(
    error: ValidationError, model: type[BaseModel], content: object
) -> list[ErrorDetails]:
    """Returns all errors, or of very many at least the first that are to be listed.

    Args:
        error: The errors of the document.
        model: Type of the document.
        content: The document, as it was validated.
    """
    if error.error_count() <= _FEW:
        return error.errors(include_url=False)
    names = _known_names(model)
    most = _FIRST
    while True:
        shortened: set[Place] = set()
        beginning = _beginning(content, names, most, (), shortened)
        if not shortened:
            return error.errors(include_url=False)
        found: list[ErrorDetails] = []
        try:
            model.model_validate(beginning)
        except ValidationError as again:
            found = [
                one
                for one in again.errors(include_url=False)
                if one["type"] not in _OF_WHOLES or not _holds_any(one["loc"], shortened)
            ]
        if len(found) > MAX_PROBLEMS:
            return found
        most *= _MORE


def _beginning(
    content: object, names: frozenset[str], most: int, place: Place, shortened: set[Place]
) -> Any:
    """Returns a copy of the beginning of a value.

    Args:
        content: The value.
        names: Keys that are kept.
        most: Number of items, and of other keys, that are kept of each list or object.
        place: Place of the value in the document.
        shortened: Receives the places of what was shortened.
    """
    if isinstance(content, Mapping):
        kept: dict[Any, Any] = {}
        others = 0
        for key, value in content.items():
            if key not in names:
                others += 1
                if others > most:
                    shortened.add(place)
                    continue
            kept[key] = _beginning(value, names, most, (*place, key), shortened)
        return kept
    if isinstance(content, list | tuple):
        if len(content) > most:
            shortened.add(place)
        return [
            _beginning(value, names, most, (*place, number), shortened)
            for number, value in enumerate(content[:most])
        ]
    return content


def _holds_any(place: Place, shortened: set[Place]) -> bool:
    return any(one[: len(place)] == place for one in shortened)


@lru_cache(maxsize=32)
def _known_names(model: type[BaseModel]) -> frozenset[str]:
    """Returns the names of all fields of a document, at any place."""
    schema = model.model_json_schema()
    objects = (schema, *schema.get("$defs", {}).values())
    return frozenset(name for one in objects for name in one.get("properties", ()))
