"""Refuses query parameters that an operation does not have."""

from __future__ import annotations

from fastapi import Request
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute

from drivora_service.errors import InvalidDocument, Problem
from drivora_service.known_names import advise_name

_MOST_NAMED = 20


async def refuse_unknown_parameters(request: Request) -> None:
    """Checks the names of a request's query parameters.

    Raises:
        InvalidDocument: The operation does not have some of them, of which the first are named, or
            a value holds NUL, which databases do not store.
    """
    route = request.scope.get("route")
    if not isinstance(route, APIRoute) or not request.query_params:
        return
    known = parameters_of(route)
    unknown = [name for name in dict.fromkeys(request.query_params) if name not in known]
    problems = tuple(_problem(name, known) for name in unknown[:_MOST_NAMED])
    problems += tuple(
        Problem(
            pointer="",
            code="odd_value",
            message=f"query parameter {name!r}: found the NUL character; it is not allowed",
        )
        for name in known
        if any("\0" in value for value in request.query_params.getlist(name))
    )
    if problems:
        raise InvalidDocument(problems)


def parameters_of(route: APIRoute) -> tuple[str, ...]:
    """Returns the names of an operation's query parameters, those of its dependencies included."""
    return tuple(dict.fromkeys(_names(route.dependant)))


def _names(dependant: Dependant) -> list[str]:
    own = [field.alias for field in dependant.query_params]
    return own + [name for inner in dependant.dependencies for name in _names(inner)]


def _problem(name: str, known: tuple[str, ...]) -> Problem:
    allowed = advise_name(name, sorted(known), word="allowed") or "this operation has none"
    return Problem(
        pointer="",
        code="unknown_query_parameter",
        message=f"found the query parameter {name[:80]!r}; {allowed}",
    )
