"""The HTTP application: routes, error shapes and guards around one context."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractAsyncContextManager
from importlib.metadata import version
from typing import Any

from fastapi import FastAPI, Request, Response
from fastapi.responses import HTMLResponse
from starlette.routing import BaseRoute

from drivora_service.api.answers.run_pictures import Pictures
from drivora_service.api.context import ApiContext
from drivora_service.api.documentation.docs_page import docs_page
from drivora_service.api.documentation.openapi import install_openapi
from drivora_service.api.guards.answer_memory import AnswerMemory
from drivora_service.api.guards.body_limit import BodyLimit
from drivora_service.api.guards.client_counts import ClientCounts
from drivora_service.api.guards.entity_tags import json_answer
from drivora_service.api.guards.load_guard import LoadGuard
from drivora_service.api.guards.method_table import HeadAsGet, MethodTable
from drivora_service.api.guards.origin_guard import OriginGuard
from drivora_service.api.guards.path_prefix import PathPrefix
from drivora_service.api.guards.request_times import RequestTimes, TimedRequests
from drivora_service.api.guards.security_headers import SecurityHeaders
from drivora_service.api.guards.write_gate import WriteGate
from drivora_service.api.problem_details import install_problem_handlers
from drivora_service.api.routes_on_demand import Resources, ResourcesOnDemand
from drivora_service.api_paths import PREFIX
from drivora_service.studies.coverage.coverage_memory import CoverageMemory

_NOTHING = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'"
)
"""Content security policy of the page of the API."""

Lifespan = Callable[[FastAPI], AbstractAsyncContextManager[None]]


def create_api(
    context: ApiContext,
    lifespan: Lifespan | None = None,
    *,
    page: Sequence[BaseRoute] = (),
    on_demand: bool = False,
) -> FastAPI:
    """Builds the application.

    Args:
        context: Everything below the HTTP layer.
        lifespan: Startup before the first request and shutdown after the last.
        page: Routes outside the API: the web page.
        on_demand: Whether the routes of a resource are added by the first request for it.
    """
    api = FastAPI(
        title="Drivora",
        version=version("drivora"),
        # FastAPI's own is without an `ETag`; it is written here.
        openapi_url=None,
        # FastAPI's pages load their scripts from elsewhere; /docs is written here.
        docs_url=None,
        redoc_url=None,
        lifespan=lifespan,
        # `/jobs/` is a job without an id, not the list of jobs.
        redirect_slashes=False,
    )
    api.state.context = context
    api.state.pictures = Pictures()
    api.state.coverages = CoverageMemory()
    times = api.state.request_times = RequestTimes()
    counts = api.state.client_counts = ClientCounts()
    methods = MethodTable()
    resources = Resources(api, methods)
    if on_demand:
        api.add_middleware(ResourcesOnDemand, resources=resources)
    else:
        resources.add_all()

    @api.get(f"{PREFIX}/openapi.json", include_in_schema=False)
    def openapi(request: Request) -> Response:
        return json_answer(request, dict[str, Any], api.openapi())

    @api.get("/docs", include_in_schema=False)
    def docs() -> HTMLResponse:
        return HTMLResponse(docs_page(api.openapi()), headers={"Content-Security-Policy": _NOTHING})

    api.router.routes.extend(page)
    methods.add(api.routes)
    install_problem_handlers(api, methods)
    install_openapi(
        api,
        tokens_needed=lambda: context.needed_tokens is not None,
        root_path=context.root_path,
    )
    # The last added is the outermost.
    api.add_middleware(HeadAsGet)
    api.add_middleware(WriteGate, storage_fault=context.storage_fault, stopping=context.stopping)
    api.add_middleware(
        BodyLimit,
        max_bytes=context.limits.body_bytes,
        of_paths={f"{PREFIX}/networks": context.limits.network_bytes},
        body_s=context.limits.body_s,
        of_a_client=context.limits.client_bodies,
        counts=counts,
    )
    api.add_middleware(LoadGuard)
    # A request that waits for an answer which is being made already is no load.
    api.add_middleware(
        AnswerMemory,
        version=lambda: _state_of_answers(context),
        tokens=lambda: context.needed_tokens,
        sessions=context.sessions,
    )
    api.add_middleware(OriginGuard, is_open=lambda: context.needed_tokens is None)
    api.add_middleware(SecurityHeaders)
    # Outside of all others, so that it sees what they refuse.
    api.add_middleware(TimedRequests, times=times)
    if context.root_path:
        api.add_middleware(PathPrefix, root_path=context.root_path)
    return api


def _state_of_answers(context: ApiContext) -> int | None:
    """Returns another number after each change that an answer may tell of; ``None``: not known."""
    revision = context.revision()
    # Either only grows. Road networks are files, which the database does not count.
    return None if revision is None else revision + context.imports.count
