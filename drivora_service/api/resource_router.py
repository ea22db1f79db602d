"""The router of a resource."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Sequence
from http import HTTPStatus
from typing import Any, get_args

from fastapi import APIRouter, Depends, Request, Response
from fastapi.params import Depends as Dependency
from fastapi.routing import APIRoute
from pydantic import BaseModel, ValidationError
from pydantic_core import from_json

from drivora_service.api.documentation.openapi import problem_answer
from drivora_service.api.guards.authorization import require_any
from drivora_service.api.guards.query_guard import refuse_unknown_parameters
from drivora_service.api.problem_details import ApiError, json_pointer
from drivora_service.api_paths import PREFIX
from drivora_service.errors import Problem, further_problems
from drivora_service.scenario.first_errors import first_errors
from drivora_service.scenario.plain_data import MAX_PROBLEMS

_LARGE_BODY = 64 << 10
"""Bytes of a body with, at most, some thousands of mistakes."""


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
        route_class=_BoundedRoute,
    )


class _BoundedRoute(APIRoute):
    """An operation that lists the first mistakes of a large body, to clients that may send one.

    FastAPI would list every one, several times over, in seconds and hundreds of megabytes.
    """

    def __init__(
        self,
        path: str,
        endpoint: Callable[..., Any],
        *,
        dependencies: Sequence[Dependency] | None = None,
        **options: Any,
    ) -> None:
        """Creates the operation as the base class does."""
        # The last one, so that no body is looked at of a client that may not send any.
        checks = [*(dependencies or ()), Depends(_check_body)]
        super().__init__(path, endpoint, dependencies=checks, **options)

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Returns what serves a request."""
        handle = super().get_route_handler()

        async def handle_read(request: Request) -> Response:
            if int(request.headers.get("content-length", _LARGE_BODY + 1)) > _LARGE_BODY:
                # FastAPI reads a body before it asks for a token: clients without one could have
                # the service hold as many large bodies as it waits for.
                require_any(request)
            # FastAPI would take the refusals of `BodyLimit` for a body that it cannot parse.
            await request.body()
            return await handle(request)

        return handle if self.body_field is None else handle_read


async def _check_body(request: Request) -> None:
    """Refuses a large body with many mistakes.

    Raises:
        ApiError: It has more than are listed.
    """
    route = request.scope.get("route")
    if not isinstance(route, _BoundedRoute) or route.body_field is None:
        return
    model = _model(route.body_field.field_info.annotation)
    # It was read before.
    body = b"" if model is None else await request.body()
    if model is not None and len(body) > _LARGE_BODY:
        _check_large(body, model)


def _model(annotation: Any) -> type[BaseModel] | None:
    candidates = (annotation, *get_args(annotation))
    return next((c for c in candidates if isinstance(c, type) and issubclass(c, BaseModel)), None)


def _check_large(body: bytes, model: type[BaseModel]) -> None:
    """Refuses a body with many mistakes; one with few, or that is no JSON, is left to FastAPI."""
    try:
        content = from_json(body)
    except ValueError:
        return
    try:
        model.model_validate(content)
    except ValidationError as error:
        count = error.error_count()
        if count <= MAX_PROBLEMS:
            return
        listed = first_errors(error, model, content)[:MAX_PROBLEMS]
        problems = [
            Problem(pointer=json_pointer(one["loc"]), code=one["type"], message=one["msg"])
            for one in listed
        ]
        raise ApiError(
            HTTPStatus.UNPROCESSABLE_ENTITY,
            "the request cannot be used",
            problems=(*problems, further_problems(count - len(listed))),
        ) from None
