"""The router of a resource."""

from __future__ import annotations

from fastapi import APIRouter, Depends
from fastapi.params import Depends as Dependency

from drivora_service.api.documentation.openapi import problem_answer
from drivora_service.api.guards.query_guard import refuse_unknown_parameters
from drivora_service.api_paths import PREFIX


def resource_router(tag: str, *dependencies: Dependency) -> APIRouter:
    """Returns a router for the operations of a resource, below the prefix of the API.

    Args:
        tag: Group of the operations in the documentation.
        dependencies: What each of them depends on.
    """
    return APIRouter(
        prefix=PREFIX,
        tags=[tag],
        dependencies=[Depends(refuse_unknown_parameters), *dependencies],
        responses={422: problem_answer(422), 503: problem_answer(503)},
    )
