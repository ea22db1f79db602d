"""The names of oracles, metrics and egos in suites and gates, checked against what there is.

The content may have problems of its structure: what is not of the type that is needed is skipped
here, so that all problems of a file can be reported at once.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from drivora_service.errors import Problem
from drivora_service.known_names import unknown_name_message


def items_of(content: Any, key: str) -> tuple[tuple[int, Any], ...]:
    """Returns the items of a list in an object, with their places; none if it is no such list."""
    found = content.get(key) if isinstance(content, Mapping) else None
    return tuple(enumerate(found)) if isinstance(found, list | tuple) else ()


def unknown_oracles(content: Any, known: Collection[str], prefix: str = "") -> Iterator[Problem]:
    """Yields the unknown names in the list ``oracles`` of an object.

    Args:
        content: The object.
        known: Names that there are.
        prefix: Pointer to the object.
    """
    for place, name in items_of(content, "oracles"):
        if isinstance(name, str) and name not in known:
            yield unknown("oracle", name, known, f"{prefix}/oracles/{place}")


def is_metric(name: str, known: Collection[str]) -> bool:
    """Returns whether a name is that of a metric, or of its value for one ego, ``NAME[EGO]``."""
    metric, bracket, _ = name.partition("[")
    return metric in known and (not bracket or name.endswith("]"))


def unknown(kind: str, name: str, known: Collection[str], pointer: str) -> Problem:
    """Returns the problem of a name that is not in a catalogue."""
    return Problem(
        pointer=pointer,
        code=f"unknown_{kind}",
        message=unknown_name_message(kind, name, known),
    )
