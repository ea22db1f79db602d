"""The routes of the API by resource, imported and added when they are needed.

A service has all of them from its begin. The application of a command answers requests for a few of
them only, and building all would take half of the command's start.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib import import_module

from fastapi import APIRouter, FastAPI
from starlette.types import ASGIApp, Receive, Scope, Send

from drivora_service.api.guards.method_table import MethodTable
from drivora_service.api_paths import PREFIX

_MODULES: Mapping[str, re.Pattern[str]] = {
    module: re.compile(pattern)
    for module, pattern in (
        ("scenarios", "/scenarios:.*"),
        ("jobs", "/jobs([/:].*)?"),
        ("batches", "/batches([/:].*)?"),
        ("batch_comparisons", "/batches:compare"),
        ("runs", "/runs([/:].*)?"),
        ("recordings", "/runs/[^/]*/(timeline|series|perception)"),
        ("minimizations", "/minimizations([/:].*)?|/runs/[^/]*:minimize"),
        ("campaigns", "/campaigns(:validate|:presets|/[^/]*)?"),
        ("comparisons", "/campaigns(:compare|/[^/]*/(figures|discoveries|coverage))"),
        ("evaluations", "/campaigns/[^/]*/(evaluations|failures|tables)(/.*)?"),
        ("failures", "/failures(:counts|/[0-9]*)?"),
        ("failure_groups", "/failures/groups([/:].*)?"),
        ("studies", "/studies([/:].*)?"),
        ("suites", "/suites(:history)?|/suite-runs(/.*)?"),
        ("tables", "/tables/[^/]*"),
        ("events", "/events"),
        ("ids", "/ids"),
        ("sessions", "/session"),
        ("workers", "/workers"),
        ("networks", "/networks([/:].*)?"),
        ("catalogues", "/((agents|models|testers|oracles)([/:].*)?|metrics:describe)"),
    )
}
"""Modules in ``routes``, and the paths that each serves below the prefix."""

_STATE = "health"
"""The module of the service's own state, served with and without the prefix."""

_STATE_PATHS = re.compile("/(healthz|readyz|metrics)")

_DESCRIPTIONS = frozenset({"/docs", f"{PREFIX}/openapi.json"})
"""Paths that describe all routes."""


class Resources:
    """The resources of an application that have been added to it."""

    def __init__(self, api: FastAPI, methods: MethodTable) -> None:
        """Creates the record; no resource is added yet.

        Args:
            api: The application.
            methods: Gets the methods of the paths of added routes.
        """
        self._api, self._methods = api, methods
        self._added: set[str] = set()

    def add_all(self) -> None:
        """Adds the routes of every resource."""
        for module in (*_MODULES, _STATE):
            self._add(module)

    def add_for(self, path: str) -> None:
        """Adds the routes that a request for a path needs."""
        if path in _DESCRIPTIONS:
            self.add_all()
            return
        below = path.removeprefix(PREFIX)
        if _STATE_PATHS.fullmatch(below):
            self._add(_STATE)
        elif below != path:
            for module, pattern in _MODULES.items():
                if pattern.fullmatch(below):
                    self._add(module)

    def _add(self, name: str) -> None:
        if name in self._added:
            return
        router: APIRouter = import_module(f"drivora_service.api.routes.{name}").router
        if name == _STATE:
            self._api.include_router(router)
            self._api.include_router(router, prefix=PREFIX, include_in_schema=False)
            self._methods.add(router.routes, PREFIX)
        else:
            # It has the prefix; included, each route would be built a second time.
            self._api.router.routes.extend(router.routes)
        self._methods.add(router.routes)
        self._added.add(name)


class ResourcesOnDemand:
    """ASGI middleware: adds the routes of a resource before the first request for it."""

    def __init__(self, app: ASGIApp, resources: Resources) -> None:
        self._app, self._resources = app, resources

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves a request."""
        if scope["type"] == "http":
            self._resources.add_for(scope["path"])
        await self._app(scope, receive, send)
