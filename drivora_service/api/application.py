"""The HTTP application: routes, error shapes and guards around one context."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractAsyncContextManager
from importlib.metadata import version

from fastapi import FastAPI
from fastapi.responses import HTMLResponse
from starlette.routing import BaseRoute

from drivora_service.api.answers.run_pictures import Pictures
from drivora_service.api.context import ApiContext
from drivora_service.api.documentation.docs_page import docs_page
from drivora_service.api.documentation.openapi import install_openapi
from drivora_service.api.guards.answer_memory import AnswerMemory
from drivora_service.api.guards.body_limit import BodyLimit
from drivora_service.api.guards.load_guard import LoadGuard
from drivora_service.api.guards.method_table import HeadAsGet, MethodTable
from drivora_service.api.guards.origin_guard import OriginGuard
from drivora_service.api.guards.path_prefix import PathPrefix
from drivora_service.api.guards.request_times import RequestTimes, TimedRequests
from drivora_service.api.guards.write_gate import WriteGate
from drivora_service.api.problem_details import install_problem_handlers
from drivora_service.api.routes_on_demand import Resources, ResourcesOnDemand
from drivora_service.api_paths import PREFIX
from drivora_service.studies.coverage.coverage_memory import CoverageMemory

_NOTHING = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
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
        openapi_url=f"{PREFIX}/openapi.json",
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
    methods = MethodTable()
    resources = Resources(api, methods)
    if on_demand:
        api.add_middleware(ResourcesOnDemand, resources=resources)
    else:
        resources.add_all()

    @api.get("/docs", include_in_schema=False)
    def docs() -> HTMLResponse:
        return HTMLResponse(docs_page(api.openapi()), headers={"Content-Security-Policy": _NOTHING})

    api.router.routes.extend(page)
    methods.add(api.routes)
    install_problem_handlers(api, methods)
    install_openapi(api, tokens_needed=context.tokens is not None, root_path=context.root_path)
    # The last added is the outermost.
    api.add_middleware(HeadAsGet)
    api.add_middleware(WriteGate, storage_fault=context.storage_fault, stopping=context.stopping)
    api.add_middleware(
        BodyLimit,
        max_bytes=context.limits.body_bytes,
        of_paths={f"{PREFIX}/networks": context.limits.network_bytes},
    )
    api.add_middleware(LoadGuard)
    # A request that waits for an answer which is being made already is no load.
    api.add_middleware(
        AnswerMemory,
        version=lambda: _state_of_answers(context),
        tokens=context.tokens,
        sessions=context.sessions,
    )
    api.add_middleware(OriginGuard, local_names_only=context.tokens is None)
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
