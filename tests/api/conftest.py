"""Clients of a real service, and an application that hands out no runs."""

from __future__ import annotations

import copy
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
import uvicorn
from fastapi import FastAPI

from drivora_service.api.answers.network_imports import NetworkImports
from drivora_service.api.application import create_api
from drivora_service.api.context import ApiContext, Limits
from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.api.guards.api_tokens import TokenFile
from drivora_service.api.guards.page_sessions import SessionFile
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.stored_gene_spaces import GeneSpaces
from drivora_service.campaigns.hosts.campaign_requests import hand_over
from drivora_service.campaigns.records.campaign_folder import CampaignFolder
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.store.database import Database, Transaction, open_database
from drivora_service.store.traces.trace_folders import TraceFolder
from drivora_service.studies.service_studies import ServiceStudies

BODY_LIMIT = 200_000
NETWORK_LIMIT = 1_000_000


@dataclass(frozen=True)
class Unattended:
    """Takes campaigns as the service does, and runs none."""

    database: Database
    woken: list[int]

    def open(self, transaction: Transaction, campaign_id: str) -> None:
        transaction.campaign_runs.open(campaign_id)

    def resume(self, campaign_id: str) -> None:
        hand_over(self.database, campaign_id)
        self.wake()

    def wake(self) -> None:
        self.woken.append(1)


@dataclass(frozen=True)
class UnattendedMinimizations:
    """Takes minimisations as the service does, and runs none."""

    woken: list[int]

    def wake(self) -> None:
        self.woken.append(1)


@pytest.fixture
def scenario() -> dict[str, Any]:
    """A scenario that can be run; a copy of its own for each test."""
    return copy.deepcopy(SCENARIO)


@pytest.fixture
def http(service_url: str) -> Iterator[httpx.Client]:
    """A client of the real service."""
    # The certificates, which plain HTTP does not need, take longer to load than most tests.
    with httpx.Client(base_url=service_url, timeout=60, verify=False) as client:
        yield client


def wait_until_final(client: httpx.Client, job_id: str, timeout: float = 90.0) -> dict[str, Any]:
    """Polls a job until it has ended."""
    deadline = time.monotonic() + timeout
    while time.monotonic() < deadline:
        job: dict[str, Any] = client.get(f"/api/v1/jobs/{job_id}").json()
        if job["status"] not in ("queued", "running"):
            return job
        time.sleep(0.05)
    raise AssertionError(f"job {job_id} did not end: {job}")


@pytest.fixture(scope="session")
def finished_run(service_url: str) -> dict[str, Any]:
    """A run that the real service has judged."""
    with httpx.Client(base_url=service_url, timeout=60) as client:
        posted = client.post("/api/v1/jobs", json=SCENARIO, params={"label": "first"})
        assert posted.status_code == 202, posted.text
        job = wait_until_final(client, posted.json()["id"])
        assert job["status"] == "finished", job
        run: dict[str, Any] = client.get(job["run_url"]).json()
        return run


@dataclass(frozen=True, slots=True, kw_only=True)
class Offline:
    """The application in this process, which hands out no runs.

    Attributes:
        woken: Grows each time that the dispatcher would be told of new work.
    """

    client: httpx.Client
    app: FastAPI
    context: ApiContext
    woken: list[int]


MakeOffline = Callable[..., Offline]


@pytest.fixture
def make_offline(tmp_path: Path, empty_database: Path) -> Iterator[MakeOffline]:
    """Builds applications with limits and tokens of the test's choice."""
    opened: list[Database] = []

    def make(
        *,
        queued_runs: int = 1000,
        batch_items: int = 50,
        body_bytes: int = BODY_LIMIT,
        network_bytes: int = NETWORK_LIMIT,
        tokens: TokenFile | None = None,
        patience_s: float = 30.0,
        storage_fault: Callable[[], str] = lambda: "",
        is_public_https: bool = False,
    ) -> Offline:
        file = shutil.copy(empty_database, tmp_path / f"{len(opened)}.sqlite3")
        database = open_database(f"sqlite:///{file}", patience_s=patience_s)
        woken: list[int] = []
        imported = tmp_path / "networks"
        catalogues = Catalogues(NetworkCatalogue(shipped_networks(), imported))

        def folder(campaign_id: str) -> CampaignFolder:
            return CampaignFolder(tmp_path / "campaigns", campaign_id)

        campaigns = Unattended(database, woken)
        context = ApiContext(
            opened=lambda: database,
            revision=database.changes.value,
            catalogues=catalogues,
            tokens=tokens,
            sessions=None
            if tokens is None
            else SessionFile(tmp_path / f"sessions-{len(opened)}.json", tokens),
            limits=Limits(
                body_bytes=body_bytes,
                network_bytes=network_bytes,
                batch_items=batch_items,
                queued_runs=queued_runs,
            ),
            trace_path=TraceFolder(tmp_path / "traces").path,
            gene_spaces=GeneSpaces(catalogues),
            campaign_folder=folder,
            wake=lambda: woken.append(1),
            campaigns=campaigns,
            studies=ServiceStudies(database, campaigns),
            minimizations=UnattendedMinimizations(woken),
            imports=NetworkImports(imported),
            reserve=lambda _runs: "",
            faults=lambda: {"workers": "there are none"},
            storage_fault=storage_fault,
            stopping=lambda: False,
            is_public_https=is_public_https,
        )
        app = create_api(context)
        url = stack.enter_context(served(app))
        client = stack.enter_context(httpx.Client(base_url=url, timeout=30, verify=False))
        opened.append(database)
        return Offline(client=client, app=app, context=context, woken=woken)

    with ExitStack() as stack:
        yield make
    for database in opened:
        database.close()


@contextmanager
def served(app: FastAPI) -> Iterator[str]:
    """Serves an application from a thread and gives its address."""
    config = uvicorn.Config(app, port=0, log_config=None, lifespan="off")
    socket = config.bind_socket()
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [socket]})
    thread.start()
    while not server.started:
        time.sleep(0.005)
    yield f"http://127.0.0.1:{socket.getsockname()[1]}"
    server.should_exit = True
    thread.join()


@pytest.fixture
def offline(make_offline: MakeOffline) -> Offline:
    """An application with the usual limits."""
    return make_offline()
