"""Clients of every kind."""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.client import (
    ApplicationTransport,
    AsyncApplicationTransport,
    AsyncClient,
    Client,
)
from drivora_service.command_app import create_command_app
from drivora_service.settings import load_settings
from tests.client.ways import blocking

MakeClient = Callable[..., Client]


@pytest.fixture
def scenario() -> dict[str, Any]:
    """A scenario that can be run; a copy of its own for each test."""
    return copy.deepcopy(SCENARIO)


@pytest.fixture(params=["waiting", "awaited"])
def client_at(request: pytest.FixtureRequest) -> Iterator[MakeClient]:
    """Makes clients of an address, of either kind."""
    with contextlib.ExitStack() as stack:

        def make(url: str, **options: Any) -> Client:
            if request.param == "waiting":
                return stack.enter_context(Client(url, **options))
            return stack.enter_context(
                contextlib.closing(blocking(lambda: AsyncClient(url, **options)))
            )

        yield make


@pytest.fixture(
    scope="module", params=["service", "application", "service, awaited", "application, awaited"]
)
def way(request: pytest.FixtureRequest) -> str:
    """What a client asks, and how."""
    way: str = request.param
    return way


@pytest.fixture(scope="module")
def is_local(way: str) -> bool:
    """Whether a client asks the application in this process."""
    return way.startswith("application")


@pytest.fixture(scope="module")
def client(
    way: str,
    is_local: bool,
    request: pytest.FixtureRequest,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[Client]:
    """A client of a real service or of the application in this process, of either kind."""
    is_awaited = way.endswith("awaited")
    if not is_local:
        url = request.getfixturevalue("service_url")
        made = blocking(lambda: AsyncClient(url)) if is_awaited else Client(url)
    elif is_awaited:
        app = _application(tmp_path_factory.mktemp("application"))
        made = blocking(lambda: AsyncClient(transport=AsyncApplicationTransport(app)))
    else:
        app = _application(tmp_path_factory.mktemp("application"))
        made = Client(transport=ApplicationTransport(app))
    with contextlib.closing(made):
        yield made


def _application(folder: Path) -> FastAPI:
    return create_command_app(load_settings(data_dir=folder, workers=1))
