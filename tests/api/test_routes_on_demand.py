"""The routes of a resource are added by the first request for it."""

from __future__ import annotations

import importlib
import pkgutil
import subprocess
import sys

import pytest
from fastapi import FastAPI
from fastapi.routing import APIRoute

from drivora_service.api import routes
from drivora_service.api.guards.method_table import MethodTable
from drivora_service.api.routes_on_demand import Resources
from drivora_service.api_paths import PREFIX

MODULES = tuple(found.name for found in pkgutil.iter_modules(routes.__path__))


def paths_of(module: str) -> list[str]:
    router = importlib.import_module(f"{routes.__name__}.{module}").router
    return [route.path for route in router.routes if isinstance(route, APIRoute)]


def resources() -> tuple[Resources, MethodTable]:
    methods = MethodTable()
    return Resources(FastAPI(), methods), methods


def an_example(path: str) -> str:
    for parameter, value in (
        ("{number}", "3"),
        ("{number:int}", "3"),
        ("{table}", "campaigns"),
        *((f"{{{name}:id}}", "a-1") for name in NAMES),
    ):
        path = path.replace(parameter, value)
    return path


NAMES = (
    "batch_id",
    "campaign_id",
    "group_id",
    "job_id",
    "minimization_id",
    "name",
    "run_id",
    "suite_run_id",
    "study_id",
)


@pytest.mark.parametrize("module", MODULES)
def test_a_request_for_a_path_adds_its_routes(module: str) -> None:
    for path in paths_of(module):
        for asked in {an_example(path)} | ({PREFIX + path} if module == "health" else set()):
            assert "{" not in asked
            on_demand, methods = resources()
            on_demand.add_for(asked)
            everything, all_methods = resources()
            everything.add_all()
            assert methods.allowed_methods(asked) == all_methods.allowed_methods(asked) != ()


@pytest.mark.parametrize("path", ["/", PREFIX, f"{PREFIX}/", f"{PREFIX}/run", "/runs", "/v2/runs"])
def test_a_request_for_another_path_adds_none(path: str) -> None:
    on_demand, methods = resources()
    on_demand.add_for(path)
    assert methods.allowed_methods(path) == ()
    assert not on_demand._added


@pytest.mark.parametrize("path", ["/docs", f"{PREFIX}/openapi.json"])
def test_a_description_has_all_routes(path: str) -> None:
    on_demand, _ = resources()
    on_demand.add_for(path)
    assert on_demand._added == set(MODULES)


def test_the_application_of_a_command_is_made_without_routes() -> None:
    program = (
        "import sys, drivora_service.command_app\n"
        f"print(*(n for n in sys.modules if n.startswith('{routes.__name__}.')))"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], check=True, capture_output=True, text=True
    )
    assert ended.stdout.split() == []
