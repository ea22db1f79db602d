"""Structural problems of a document, with messages that name the correction."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from drivora_service.errors import FurtherProblems, Problem, further_problems
from drivora_service.known_names import list_names, similar_names
from drivora_service.scenario.fields import PATTERN_MEANINGS
from drivora_service.scenario.first_errors import first_errors
from drivora_service.scenario.plain_data import MAX_PROBLEMS, kind_of, pointer

ACTOR_LISTS = ("ego_vehicles", "npc_vehicles", "npc_walkers", "npc_obstacles")
NAMED_LISTS = (*ACTOR_LISTS, "friction_patches")
"""Lists of what has an id."""

_EXPECTED: Mapping[str, str] = {
    "float_type": "a number",
    "int_type": "an integer",
    "string_type": "text",
    "model_type": "an object",
    "model_attributes_type": "an object",
    "dict_type": "an object",
    "tuple_type": "a list",
    "list_type": "a list",
}


def structural_problems(
    error: ValidationError, model: type[BaseModel], content: object
) -> list[Problem]:
    """Returns the first errors that pydantic found in a document, and the number of the others.

    Args:
        error: The errors.
        model: Type of the document.
        content: The document.
    """
    first = first_errors(error, model, content)
    found = [one for one in first if not _is_echo(one)]
    problems = [
        Problem(pointer=pointer(_tokens(one)), code=one["type"], message=_message(one, model))
        for one in found[:MAX_PROBLEMS]
    ]
    if len(found) > MAX_PROBLEMS:
        echoes = len(first) - len(found)
        problems.append(further_problems(error.error_count() - echoes - MAX_PROBLEMS))
    return problems


def find_duplicate_ids(content: Mapping[str, Any]) -> list[Problem]:
    """Finds actors and patches whose id a preceding one has; skips items that are neither."""
    return find_repeated_ids(
        (pointer((name, index, "id")), actor["id"])
        for name in NAMED_LISTS
        if isinstance(content.get(name), list | tuple)
        for index, actor in enumerate(content[name])
        if isinstance(actor, Mapping) and isinstance(actor.get("id"), str)
    )


def find_repeated_ids(ids: Iterable[tuple[str, str]]) -> list[Problem]:
    """Finds repeated ids.

    Args:
        ids: Pointer to each id, and the id.
    """
    problems: list[Problem] = []
    first: dict[str, str] = {}
    for place, actor_id in ids:
        earlier = first.setdefault(actor_id, place)
        if earlier != place:
            message = f"found {actor_id[:80]!r} again (first at {earlier}); ids must be unique"
            problems.append(Problem(pointer=place, code="duplicate_id", message=message))
    return problems


def in_document_order(
    problems: Sequence[Problem], content: Mapping[str, Any]
) -> tuple[Problem, ...]:
    """Sorts problems by their places in the document, and bounds their number."""
    positions: dict[int, dict[str, int]] = {}
    further = [one for one in problems if isinstance(one, FurtherProblems)]
    listed = [one for one in problems if not isinstance(one, FurtherProblems)]
    ordered = sorted(listed, key=lambda problem: _rank(problem.pointer, content, positions))
    left_out = sum(one.count for one in further) + max(0, len(ordered) - MAX_PROBLEMS)
    stopped = any(one.stopped for one in further)
    if not left_out and not stopped:
        return tuple(ordered)
    return (*ordered[:MAX_PROBLEMS], further_problems(left_out, stopped=stopped))


def tokens(place: str, content: Any) -> tuple[str | int, ...]:
    """Splits a JSON pointer into keys and, where ``content`` has a list, indices."""
    result: list[str | int] = []
    for token in place.split("/")[1:]:
        key: str | int = token.replace("~1", "/").replace("~0", "~")
        if isinstance(content, list | tuple):
            key = int(token)
            content = content[key] if key < len(content) else None
        else:
            content = content.get(key) if isinstance(content, Mapping) else None
        result.append(key)
    return tuple(result)


def model_at(model: type[BaseModel], place: Iterable[str | int]) -> type[BaseModel]:
    """Returns the model that describes the object at a place of a document of type ``model``.

    Indices of lists and keys of free data are skipped.
    """
    for token in place:
        field = model.model_fields.get(str(token))
        if field is not None:
            model = _inner_model(field.annotation) or model
    return model


def _is_echo(details: ErrorDetails) -> bool:
    """Returns whether pydantic reports a list as too short because its items are invalid."""
    return details["type"] == "too_short" and len(details["input"]) >= details["ctx"]["min_length"]


def _rank(place: str, content: Any, positions: dict[int, dict[str, int]]) -> tuple[int, ...]:
    """Returns the sort key of a place; ``positions`` caches the order of each object's keys."""
    rank: list[int] = []
    for key in tokens(place, content):
        if isinstance(key, int):
            rank.append(key)
            content = content[key] if key < len(content) else None
        elif isinstance(content, Mapping):
            known = positions.get(id(content))
            if known is None:
                known = positions[id(content)] = {name: i for i, name in enumerate(content)}
            rank.append(known.get(key, len(known)))
            content = content.get(key)
    return tuple(rank)


def _tokens(details: ErrorDetails) -> tuple[str | int, ...]:
    """Returns the place of an error, without pydantic's ``[key]`` step for keys of mappings."""
    place = details["loc"]
    # A document may have a key of that name itself; a problem with a key is reported at the key.
    if place[-1:] == ("[key]",) and place[-2:-1] == (details["input"],):
        return place[:-1]
    return place


def _message(details: ErrorDetails, model: type[BaseModel]) -> str:
    kind, found, context = details["type"], details["input"], details.get("ctx", {})
    if kind == "missing":
        return f"{details['loc'][-1]!r} is missing"
    if kind == "extra_forbidden":
        return _unknown_key(details["loc"], model)
    if kind in _EXPECTED:
        unit = _unit(details["loc"], model) if isinstance(found, str) else ""
        return f"found {_format_value(found)}; {_EXPECTED[kind]} is needed{unit}"
    if kind in ("enum", "literal_error"):
        return f"found {_format_value(found)}; allowed: {context['expected']}"
    if kind == "string_pattern_mismatch":
        pattern = context["pattern"]
        return f"found {_format_value(found)}; allowed is {PATTERN_MEANINGS.get(pattern, pattern)}"
    if kind in ("too_long", "too_short"):
        items = f"found {len(found) or 'no'} {'item' if len(found) < 2 else 'items'}"
        if kind == "too_long":
            return f"{items}; at most {context['max_length']} are allowed"
        least = context["min_length"]
        return f"{items}; at least {least} {'is' if least == 1 else 'are'} needed"
    if details.get("msg", "").startswith("Input should be "):
        allowed = details["msg"].removeprefix("Input should be ")
        return f"found {_format_value(found)}; it should be {allowed}"
    if kind.startswith(("string_", "int_", "float_", "finite_")):
        return f"found {_format_value(found)}; {details['msg']}"
    return details["msg"]


def _unit(place: Sequence[str | int], model: type[BaseModel]) -> str:
    """Returns the unit of a number, which text that was given in its place may name wrongly."""
    field = model_at(model, place[:-1]).model_fields.get(str(place[-1]))
    extra = [field.json_schema_extra, *field.metadata] if field is not None else []
    for one in extra:
        extra_of = one if isinstance(one, Mapping) else getattr(one, "json_schema_extra", None)
        unit = extra_of.get("x-unit") if isinstance(extra_of, Mapping) else None
        if isinstance(unit, str) and unit != "1":
            return f", without a unit: it is in {unit}"
    return ""


def _format_value(value: object) -> str:
    if value is None or isinstance(value, Mapping | list | tuple):
        return kind_of(value)
    text = repr(value)
    text = text if len(text) <= 60 else f"{text[:57]}..."
    return f"{kind_of(value)} {text}" if isinstance(value, str | bool) else text


def _unknown_key(place: Sequence[str | int], model: type[BaseModel]) -> str:
    known = tuple(model_at(model, place[:-1]).model_fields)
    key = str(place[-1])
    close = similar_names(key, known)
    meant = f"; did you mean {close[0]!r}?" if close else ""
    return f"{key[:80]!r} is unknown here{meant} Allowed: {list_names(known)}".replace(
        "here Allowed", "here; allowed"
    )


def _inner_model(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for argument in get_args(annotation):
        inner = _inner_model(argument)
        if inner is not None:
            return inner
    return None
