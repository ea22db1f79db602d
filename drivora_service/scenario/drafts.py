"""Documents with mistakes in their shape, made whole so that the rest of them can be checked.

What is malformed is taken out or replaced by a stand-in: then the document is one, and the checks
against the road network find what is wrong with the parts that were well-formed. What they say
about a stand-in is no finding.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from drivora_service.errors import Problem
from drivora_service.scenario.documents import ScenarioDocument
from drivora_service.scenario.plain_data import MAX_PROBLEMS, pointer
from drivora_service.scenario.problems import (
    ACTOR_LISTS,
    close_keys,
    model_at,
    structural_problems,
    tokens,
)

Place = tuple[str | int, ...]

_NOBODY = "-"
"""Passes for a name; no model and no agent is called so."""
_ROUTE = [{"x": 0.0, "y": 0.0}, {"x": 0.0, "y": 0.0}]
_VEHICLE = {"id": _NOBODY, "model": _NOBODY, "route": _ROUTE}
_ACTORS: Mapping[str, Mapping[str, Any]] = {
    "ego_vehicles": _VEHICLE,
    "npc_vehicles": _VEHICLE,
    "npc_walkers": _VEHICLE,
    "npc_obstacles": {"id": _NOBODY, "model": _NOBODY, "location": _ROUTE[0]},
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
    # Asks least of a route.
    "behavior": "replay",
    # Exactly one of the two must be given, which taking one out would change.
    "count": 0,
    "density": 0.0,
}
"""By key, for what cannot be taken out."""
_WHOLES = ("route", "location")
"""Parts of actors of which nothing can be taken out without changing what the rest means."""
_CONTRADICTIONS: Mapping[str, tuple[str, ...]] = {"two_agents": ("agent", "config_path")}
"""By code of a problem with an object as a whole: the keys to take out of it."""
_SPELLING = 0.75
"""How similar keys are, from 0 to 1, of which one is taken for the other: `fraem` for `frame`, but
not `name`."""
_ROUNDS = 3
"""Rules about an object as a whole are judged once its parts are well-formed: a round each."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Doubts:
    """What is not known of a document, because it was malformed.

    Attributes:
        replaced: Pointers to what was taken out or replaced.
        flawed: Pointers to everything that has a mistake in its shape somewhere inside.
    """

    replaced: frozenset[str] = frozenset()
    flawed: frozenset[str] = frozenset()

    def cover(self, place: str) -> bool:
        """Whether what stands at a pointer is not known."""
        return any(above in self.replaced for above in _upwards(place))

    def touch(self, place: str) -> bool:
        """Whether anything at a pointer is not known or malformed."""
        return place in self.flawed or self.cover(place)


@dataclass(frozen=True, slots=True, kw_only=True)
class Draft:
    """A document that was made whole.

    Attributes:
        problems: Mistakes in its shape, those included that only showed on the way.
    """

    document: ScenarioDocument
    problems: tuple[Problem, ...]
    doubts: Doubts


def make_whole(content: Mapping[str, Any], problems: Sequence[Problem]) -> Draft | None:
    """Takes the mistakes in the shape of a document out of it.

    Args:
        content: The document as plain data; it stays as it is.
        problems: The mistakes.

    Returns:
        ``None`` where there are too many, or where they cannot be taken out.
    """
    found, fresh = list(problems), list(problems)
    replaced: set[Place] = set()
    whole: Mapping[str, Any] = content
    for _ in range(_ROUNDS):
        if len(found) > MAX_PROBLEMS:
            return None
        places = {place for problem in fresh for place in _repairs(problem, whole)}
        for place in places - replaced:
            whole = _repaired(whole, place, place)
        replaced |= places
        try:
            document = ScenarioDocument.model_validate(whole)
        except ValidationError as error:
            fresh = structural_problems(error, ScenarioDocument)
            found += fresh
            continue
        doubts = Doubts(
            replaced=frozenset(pointer(place) for place in replaced),
            flawed=frozenset(above for problem in found for above in _upwards(problem.pointer)),
        )
        return Draft(document=document, problems=tuple(found), doubts=doubts)
    return None


def _repairs(problem: Problem, content: Mapping[str, Any]) -> list[Place]:
    """Returns the places to take out or replace for one mistake."""
    place = tokens(problem.pointer, content)
    if problem.code in _CONTRADICTIONS:
        return [(*place, key) for key in _CONTRADICTIONS[problem.code]]
    repairs = [_widened(place)]
    if problem.code == "extra_forbidden":
        repairs.append(_meant(place, content))
    return [repair for repair in repairs if repair]


def _widened(place: Place) -> Place:
    """Returns the smallest part around a place without which a document is still one."""
    if len(place) > 2 and place[0] in ACTOR_LISTS and place[2] in _WHOLES:
        return place[:3]
    for end in range(len(place), 0, -1):
        key = place[end - 1]
        if isinstance(key, int):
            if end == 2 and place[0] in ACTOR_LISTS:
                return place[:end]
            continue
        field = model_at(ScenarioDocument, place[: end - 1]).model_fields.get(key)
        if field is None or not field.is_required() or key in _STAND_INS:
            return place[:end]
    return ()


def _meant(place: Place, content: Any) -> Place:
    """Returns the place of the key that an unknown one was probably meant for."""
    *above, key = place
    for token in above:
        content = content[token]
    if not isinstance(content, Mapping):
        return ()
    missing = model_at(ScenarioDocument, above).model_fields.keys() - content.keys()
    close = close_keys(str(key), sorted(missing), similar=_SPELLING)
    return (*above, *close) if close else ()


def _repaired(content: Any, place: Place, rest: Place) -> Any:
    """Returns a copy without, or with a stand-in for, what is at a place; shares all else.

    Args:
        content: The document, or what is at the beginning of the place.
        place: The whole place.
        rest: The place as seen from the content.
    """
    token, *below = rest
    if isinstance(token, int):
        # Another repair may have emptied the list.
        if not isinstance(content, list | tuple) or token >= len(content):
            return content
        item = _repaired(content[token], place, tuple(below)) if below else _ACTORS[str(place[0])]
        return [*content[:token], item, *content[token + 1 :]]
    if not isinstance(content, Mapping):
        return content
    if below:
        if token not in content:
            return content
        return {**content, token: _repaired(content[token], place, tuple(below))}
    without = {key: value for key, value in content.items() if key != token}
    if token in _STAND_INS and token in model_at(ScenarioDocument, place[:-1]).model_fields:
        without[token] = _STAND_INS[token]
    return without


def _upwards(place: str) -> Iterable[str]:
    """Returns a pointer and those to everything around it, the document left out."""
    while place:
        yield place
        place = place.rpartition("/")[0]
