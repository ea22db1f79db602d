"""The canonical text of a scenario: its identity, and its form for workers.

Keys are sorted, there is no white space, floats have the fewest digits that read back
to the same value. The text of equal scenarios is equal, and ``from_canonical`` returns the
identical scenario.

The text is the JSON of Python, not of pydantic, which writes 1e-07 as 1e-7 and 1e-05 as 0.00001:
the identities of all scenarios would change. Both are read to the same values.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache, lru_cache
from operator import attrgetter
from types import MappingProxyType
from typing import Any

from pydantic import TypeAdapter

from drivora_service.scenario import model

_LATER_FIELDS: Mapping[type, Mapping[str, object]] = MappingProxyType(
    {
        model.Scenario: {"stuck_after": None, "friction_patches": [], "weather_changes": []},
        model.EgoVehicle: {"reference_path": []},
        model.Waypoint: {"wait": None},
        model.NpcVehicle: {
            "at_end": model.RouteEnd.LEAVE,
            "deceleration": None,
            "lateral_acceleration": None,
            "joins": False,
        },
        model.NpcWalker: {"joins": False},
    }
)
"""Fields that were added later, by class, with the values that are omitted."""


def canonical_json(scenario: model.Scenario) -> str:
    """Writes a scenario as canonical JSON, in the network's plane, metres and radians.

    ``_LATER_FIELDS`` are omitted if they have their default, so that scenarios keep the identity
    that they had before these fields existed.
    """
    return json.dumps(
        _plain(scenario),
        sort_keys=True,
        separators=(",", ":"),
        ensure_ascii=False,
        allow_nan=False,
    )


def scenario_sha256(scenario: model.Scenario) -> str:
    """Returns the SHA-256 of the canonical JSON, hexadecimal: the scenario's identity."""
    return hashlib.sha256(canonical_json(scenario).encode()).hexdigest()


def from_canonical(text: str) -> model.Scenario:
    """Reads canonical JSON without checks, since it was made from a validated scenario."""
    return _reader().validate_json(text)


@cache
def _reader() -> TypeAdapter[model.Scenario]:
    return TypeAdapter(model.Scenario)


@lru_cache(maxsize=64)
def _fields(kind: type) -> tuple[tuple[str, ...], Callable[[Any], tuple[Any, ...]]]:
    """Returns the names of the fields of a dataclass, none for other classes, and their reader."""
    names = tuple(f.name for f in fields(kind)) if is_dataclass(kind) else ()
    if len(names) > 1:
        return names, attrgetter(*names)
    return names, lambda value: tuple(getattr(value, name) for name in names)


_AS_THEY_ARE = frozenset({float, type(None), int, str, bool})
"""Classes whose values JSON has, too; members of an enumeration are of another class."""


def _plain(value: Any) -> Any:
    kind: Any = type(value)
    if kind in _AS_THEY_ARE:
        return value
    names, read = _fields(kind)
    if names:
        parts = read(value)
        content = dict(zip(names, parts, strict=True))
        # Nearly all values are numbers of waypoints, which are not looked at one by one.
        if not _AS_THEY_ARE.issuperset(map(type, parts)):
            content = {name: _plain(part) for name, part in content.items()}
        for name, default in _LATER_FIELDS.get(kind, {}).items():
            if content[name] == default:
                del content[name]
        return content
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return value.value if isinstance(value, Enum) else value
