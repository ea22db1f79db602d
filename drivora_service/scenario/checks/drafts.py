"""Repair of documents with structural mistakes, so that the rest of them can be checked.

Malformed parts are removed or replaced by placeholders: then the document is complete, and the
checks against the road network find the problems of the well-formed parts. Problems at a
placeholder are not reported.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from drivora_service.errors import FurtherProblems, Problem
from drivora_service.known_names import similar_names
from drivora_service.scenario.document_problems import (
    NAMED_LISTS,
    model_at,
    structural_problems,
    tokens,
)
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.plain_data import MAX_PROBLEMS, pointer

Place = tuple[str | int, ...]

_NOBODY = "-"
"""Placeholder of a name, which no model or agent has."""
_ROUTE = [{"x": 0.0, "y": 0.0}, {"x": 0.0, "y": 0.0}]
_VEHICLE = {"id": _NOBODY, "model": _NOBODY, "route": _ROUTE}
_ACTORS: Mapping[str, Mapping[str, Any]] = {
    "ego_vehicles": _VEHICLE,
    "npc_vehicles": _VEHICLE,
    "npc_walkers": _VEHICLE,
    "npc_obstacles": {"id": _NOBODY, "model": _NOBODY, "location": _ROUTE[0]},
    "friction_patches": {
        "id": _NOBODY,
        "location": _ROUTE[0],
        "length": 1.0,
        "width": 1.0,
        "friction": 1.0,
    },
}
_STAND_INS: Mapping[str, Any] = {
    "ego_vehicles": [_VEHICLE],
    "map_region": {"town": _NOBODY},
    "town": _NOBODY,
    "id": _NOBODY,
    "model": _NOBODY,
    "name": _NOBODY,
    "route": _ROUTE,
    "location": _ROUTE[0],
    # The least demanding for a route.
    "behavior": "replay",
    # Exactly one of the two must be given, which removing one would violate.
    "count": 0,
    "density": 0.0,
}
"""Placeholders by key, for values that cannot be removed."""
_WHOLES = ("route", "location")
"""Parts of actors from which nothing can be removed without changing the meaning of the rest."""
_CONTRADICTIONS: Mapping[str, tuple[str, ...]] = {"two_agents": ("agent", "config_path")}
"""Keys to remove from an object, by code of the problem with the object as a whole."""
_SPELLING = 0.75
"""Similarity of keys, from 0 to 1, from which on one is read as the other: `fraem` for `frame`, but
not `name`."""
_ROUNDS = 3
"""Rules about an object as a whole are checked once its parts are well-formed: one round each."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Doubts:
    """The parts of a document that are unknown, because they were malformed.

    Attributes:
        replaced: Pointers to removed or replaced parts.
        flawed: Pointers to all parts with a structural mistake somewhere inside.
    """

    replaced: frozenset[str] = frozenset()
    flawed: frozenset[str] = frozenset()

    def cover(self, place: str) -> bool:
        """Returns whether the part at a pointer is unknown."""
        return any(above in self.replaced for above in _upwards(place))

    def touch(self, place: str) -> bool:
        """Returns whether any part at a pointer is unknown or malformed."""
        return place in self.flawed or self.cover(place)


@dataclass(frozen=True, slots=True, kw_only=True)
class Draft:
    """A repaired document.

    Attributes:
        problems: Structural mistakes, including those found during the repair.
    """

    document: ScenarioDocument
    problems: tuple[Problem, ...]
    doubts: Doubts


def make_whole(content: Mapping[str, Any], problems: Sequence[Problem]) -> Draft | None:
    """Repairs the structural mistakes of a document.

    Args:
        content: The document as plain data; it is not changed.
        problems: The mistakes.

    Returns:
        ``None`` if there are too many, or if they cannot be repaired.
    """
    found, fresh = list(problems), list(problems)
    replaced: set[Place] = set()
    whole: Mapping[str, Any] = content
    for _ in range(_ROUNDS):
        if len(found) > MAX_PROBLEMS or any(isinstance(p, FurtherProblems) for p in found):
            return None
        places = {place for problem in fresh for place in _repairs(problem, whole)}
        for place in places - replaced:
            whole = _repair(whole, place, place)
        replaced |= places
        try:
            document = ScenarioDocument.model_validate(whole)
        except ValidationError as error:
            fresh = structural_problems(error, ScenarioDocument, whole)
            found += fresh
            continue
        doubts = Doubts(
            replaced=frozenset(pointer(place) for place in replaced),
            flawed=frozenset(above for problem in found for above in _upwards(problem.pointer)),
        )
        return Draft(document=document, problems=tuple(found), doubts=doubts)
    return None


def _repairs(problem: Problem, content: Mapping[str, Any]) -> list[Place]:
    """Returns the places to remove or replace for one mistake."""
    place = tokens(problem.pointer, content)
    if problem.code in _CONTRADICTIONS:
        return [(*place, key) for key in _CONTRADICTIONS[problem.code]]
    repairs = [_find_removable_part(place)]
    if problem.code == "extra_forbidden":
        repairs.append(_guess_key(place, content))
    return [repair for repair in repairs if repair]


def _find_removable_part(place: Place) -> Place:
    """Returns the smallest part around a place that can be removed from a document."""
    if len(place) > 2 and place[0] in NAMED_LISTS and place[2] in _WHOLES:
        return place[:3]
    for end in range(len(place), 0, -1):
        key = place[end - 1]
        if isinstance(key, int):
            if end == 2 and place[0] in NAMED_LISTS:
                return place[:end]
            continue
        field = model_at(ScenarioDocument, place[: end - 1]).model_fields.get(key)
        if field is None or not field.is_required() or key in _STAND_INS:
            return place[:end]
    return ()


def _guess_key(place: Place, content: Any) -> Place:
    """Returns the place of the key that an unknown key was probably meant to be."""
    *above, key = place
    for token in above:
        content = content[token]
    if not isinstance(content, Mapping):
        return ()
    missing = model_at(ScenarioDocument, above).model_fields.keys() - content.keys()
    close = similar_names(str(key), sorted(missing), similar=_SPELLING)
    return (*above, *close) if close else ()


def _repair(content: Any, place: Place, rest: Place) -> Any:
    """Returns a copy without the part at a place, or with a placeholder; shares all else.

    Args:
        content: The document, or its part at the beginning of the place.
        place: The whole place.
        rest: The place relative to the content.
    """
    token, *below = rest
    if isinstance(token, int):
        # Another repair may have emptied the list.
        if not isinstance(content, list | tuple) or token >= len(content):
            return content
        item = _repair(content[token], place, tuple(below)) if below else _ACTORS[str(place[0])]
        return [*content[:token], item, *content[token + 1 :]]
    if not isinstance(content, Mapping):
        return content
    if below:
        if token not in content:
            return content
        return {**content, token: _repair(content[token], place, tuple(below))}
    without = {key: value for key, value in content.items() if key != token}
    if token in _STAND_INS and token in model_at(ScenarioDocument, place[:-1]).model_fields:
        without[token] = _STAND_INS[token]
    return without


def _upwards(place: str) -> Iterable[str]:
    """Yields a pointer and those of all parts around it, without the document."""
    while place:
        yield place
        place = place.rpartition("/")[0]
