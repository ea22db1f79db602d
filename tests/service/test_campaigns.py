"""Campaigns that a real server runs: the same as embedded ones, whatever happens to the server."""

from __future__ import annotations

import contextlib
import copy
import random
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from drivora_service.api.documentation.recorded_examples import SCENARIO
from drivora_service.campaigns.document.campaign_catalogues import Catalogues
from drivora_service.campaigns.document.campaign_reading import read_campaign
from drivora_service.campaigns.evaluation.local_evaluator import LOCAL
from drivora_service.campaigns.evaluator import EvaluatorContext
from drivora_service.campaigns.records.journal import MemoryJournal
from drivora_service.campaigns.records.store_journal import StoreJournal
from drivora_service.campaigns.search.conducting import conduct
from drivora_service.campaigns.search.search_preparation import prepare_search
from drivora_service.execution.executor import Limits
from drivora_service.networks.catalogue import NetworkCatalogue, shipped_networks
from drivora_service.store.campaigns.campaign_records import EvaluationRecord
from drivora_service.store.database import open_database
from drivora_service.worker.setup import WorkerSetup
from tests.campaign_engines import engine_pid
from tests.campaigns.analytic import sequence
from tests.forked_service import forked_service, killed_service

pytestmark = pytest.mark.slow(seconds=10)

TESTERS = ("random", "avfuzzer")
KILLS = 2
SIMULATIONS = 96
_LONG_S = 240.0


def document(tester: str, simulations: int = SIMULATIONS, **changes: Any) -> dict[str, Any]:
    return {
        "name": f"tee, {tester}",
        "tester": {"name": tester},
        "agent": {"name": "idm"},
        "scenario": copy.deepcopy(SCENARIO),
        "space": {"vehicles": 2, "walkers": 2},
        "oracles": ["collision", "discomfort"],
        "budget": {"simulations": simulations},
        "seed": 3,
        **changes,
    }


def embedded(content: dict[str, Any], folder: Path) -> list[EvaluationRecord]:
    """The evaluations of an uninterrupted campaign without a server, on one worker."""
    catalogues = Catalogues(NetworkCatalogue(shipped_networks()))
    search = prepare_search(read_campaign(content, catalogues), catalogues, run_prefix="embedded")
    context = EvaluatorContext(
        workers=1,
        setup=WorkerSetup(shipped_networks=shipped_networks()),
        limits=Limits(),
        folder=folder,
    )
    journal = MemoryJournal()
    with contextlib.closing(LOCAL.create(context)) as evaluator:
        conduct(search, evaluator, journal, confirm=False)
    return list(journal.evaluations())


@dataclass(frozen=True, slots=True)
class Served:
    """A service and its data folder."""

    url: str
    folder: Path


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service with two workers, which each test leaves with nothing to do."""
    folder = tmp_path_factory.mktemp("served")
    with forked_service(folder, workers=2) as url:
        yield Served(url, folder)


@pytest.fixture(scope="module")
def references(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[EvaluationRecord]]:
    return {
        tester: embedded(document(tester), tmp_path_factory.mktemp(tester)) for tester in TESTERS
    }


def evaluations(data_dir: Path, campaign_id: str) -> list[EvaluationRecord]:
    database = open_database(f"sqlite:///{data_dir / 'drivora.sqlite3'}")
    try:
        return list(StoreJournal(database, campaign_id).evaluations())
    finally:
        database.close()


@contextlib.contextmanager
def client_of(url: str) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as client:
        yield client


def post(client: httpx.Client, content: dict[str, Any]) -> str:
    answer = client.post("/campaigns", json=content)
    assert answer.status_code == 202, answer.text
    campaign_id: str = answer.json()["id"]
    return campaign_id


def state(client: httpx.Client, campaign_id: str) -> dict[str, Any]:
    campaign: dict[str, Any] = client.get(f"/campaigns/{campaign_id}").raise_for_status().json()
    return campaign


def follow(client: httpx.Client, campaign_id: str, *, until: str) -> list[dict[str, Any]]:
    """Polls a campaign until it is in a state; returns all answers."""
    seen = [state(client, campaign_id)]
    deadline = time.monotonic() + _LONG_S
    while seen[-1]["state"] != until:
        assert time.monotonic() < deadline, seen[-1]
        assert seen[-1]["state"] in ("queued", "running"), seen[-1]["message"]
        time.sleep(0.05)
        seen.append(state(client, campaign_id))
    return seen


def follow_simulations(client: httpx.Client, campaign_id: str, count: int) -> dict[str, Any]:
    """Waits until a campaign has made so many simulations."""
    deadline = time.monotonic() + _LONG_S
    while (campaign := state(client, campaign_id))["simulations"] < count:
        assert time.monotonic() < deadline, campaign
        assert campaign["state"] in ("queued", "running"), campaign["message"]
        time.sleep(0.02)
    return campaign


def test_campaigns_of_a_server_are_those_of_a_command(
    served: Served, references: dict[str, list[EvaluationRecord]]
) -> None:
    with client_of(served.url) as client:
        ids = {tester: post(client, document(tester)) for tester in TESTERS}
        seen = {tester: follow(client, ids[tester], until="finished") for tester in TESTERS}
        engine_log = (served.folder / "campaigns" / ids["random"] / "engine.log").read_text()
        failures = {
            tester: client.get(f"/campaigns/{ids[tester]}/failures", params={"limit": 500}).json()
            for tester in TESTERS
        }
    assert "is finished" in engine_log
    for tester in TESTERS:
        assert sequence(evaluations(served.folder, ids[tester])) == sequence(references[tester])
        found = failures[tester]["items"]
        assert found
        assert {failure["confirmation"] for failure in found} == {"confirmed"}
        last = seen[tester][-1]
        assert (last["simulations"], last["left_s"]) == (SIMULATIONS, 0.0)
        assert last["counts"]["violating"] == len({failure["evaluation"] for failure in found})
    progress = [campaign["simulations"] for campaign in seen["random"]]
    assert progress == sorted(progress)


def test_a_campaign_is_paused_and_resumed(
    served: Served, references: dict[str, list[EvaluationRecord]]
) -> None:
    with client_of(served.url) as client:
        campaign_id = post(client, document("avfuzzer"))
        follow_simulations(client, campaign_id, 5)
        asked = client.post(f"/campaigns/{campaign_id}:pause")
        assert asked.status_code == 202
        paused = follow(client, campaign_id, until="paused")[-1]
        assert 5 <= paused["simulations"] < SIMULATIONS
        # A paused campaign leaves the workers to others.
        job = client.post("/jobs", json=SCENARIO).json()["id"]
        deadline = time.monotonic() + _LONG_S
        while client.get(f"/jobs/{job}").json()["status"] != "finished":
            assert time.monotonic() < deadline
            time.sleep(0.05)
        assert state(client, campaign_id)["simulations"] == paused["simulations"]
        assert client.post(f"/campaigns/{campaign_id}:resume").json()["state"] == "queued"
        follow(client, campaign_id, until="finished")
    assert sequence(evaluations(served.folder, campaign_id)) == sequence(references["avfuzzer"])


def test_cancelling_leaves_what_was_found_and_no_run(served: Served) -> None:
    with client_of(served.url) as client:
        campaign_id = post(client, document("random", simulations=500))
        # Its progress is seen in steps while it runs, at least six of them.
        progress = [0]
        deadline = time.monotonic() + _LONG_S
        while len(set(progress)) <= 5:
            campaign = state(client, campaign_id)
            assert campaign["state"] in ("queued", "running"), campaign["message"]
            assert time.monotonic() < deadline, progress
            progress.append(campaign["simulations"])
            time.sleep(0.05)
        assert progress == sorted(progress)
        assert client.post(f"/campaigns/{campaign_id}:cancel").status_code == 202
        cancelled = follow(client, campaign_id, until="cancelled")[-1]
        deadline = time.monotonic() + _LONG_S
        while not (batch := client.get(f"/batches/{cancelled['batch_id']}").json())["done"]:
            assert time.monotonic() < deadline, batch
            time.sleep(0.05)
        assert batch["state"] == "cancelled"
        assert client.post(f"/campaigns/{campaign_id}:resume").status_code == 409
        listed = client.get(f"/campaigns/{campaign_id}/evaluations", params={"limit": 500}).json()
    assert len(listed["items"]) == cancelled["counts"]["evaluations"] >= 5


def test_a_batch_overtakes_a_campaign(served: Served) -> None:
    with client_of(served.url) as client:
        campaign_id = post(client, document("random", simulations=500))
        campaign = follow_simulations(client, campaign_id, 10)
        scenarios = [{**SCENARIO, "seed": seed} for seed in range(30)]
        batch_id = client.post("/batches", json=scenarios).json()["batch"]["id"]
        deadline = time.monotonic() + _LONG_S
        while not client.get(f"/batches/{batch_id}").json()["done"]:
            assert time.monotonic() < deadline
            time.sleep(0.05)
        assert state(client, campaign_id)["state"] == "running"
        client.post(f"/campaigns/{campaign_id}:cancel")
        batch = client.get("/jobs", params={"batch": batch_id, "limit": 500}).json()["items"]
        runs = client.get("/jobs", params={"batch": campaign["batch_id"], "limit": 500}).json()
    begun = sorted(job["started_at"] for job in batch)
    between = [
        job["id"]
        for job in runs["items"]
        if job["started_at"] and begun[0] < job["started_at"] < begun[-1]
    ]
    assert len(batch) == 30
    assert begun[0] < begun[-1]
    assert between == []


@pytest.mark.parametrize("tester", TESTERS)
def test_a_server_that_is_killed_again_and_again_runs_the_same_campaign(
    tmp_path: Path, references: dict[str, list[EvaluationRecord]], tester: str
) -> None:
    luck = random.Random(tester)
    campaign_id = ""
    moments: list[int] = []
    for kill in range(KILLS):
        with killed_service(tmp_path) as (_, url), client_of(url) as client:
            if kill == 0:
                campaign_id = post(client, document(tester))
            known = moments[-1] if moments else 0
            follow_simulations(client, campaign_id, known + luck.randint(1, 5))
            engine = psutil.Process(engine_pid(tmp_path / "campaigns" / campaign_id))
            # A look at its memory takes long enough for the campaign to end.
            engine.suspend()
            assert not [m.path for m in engine.memory_maps() if "libsumo" in m.path]
            engine.resume()
            time.sleep(luck.uniform(0.0, 0.1))
        # The kernel ends it with its parent.
        engine.wait(30.0)
        moments.append(len(evaluations(tmp_path, campaign_id)))
    assert 0 < moments[0] < moments[1] < SIMULATIONS
    with forked_service(tmp_path, workers=2) as url, client_of(url) as client:
        last = follow(client, campaign_id, until="finished")[-1]
        batch = client.get(f"/batches/{last['batch_id']}").json()
    # The run of the seed, one for each simulation, and one again for each failing one.
    assert batch["size"] == 1 + SIMULATIONS + last["counts"]["violating"]
    assert batch["counts"] == {"finished": batch["size"]}
    assert sequence(evaluations(tmp_path, campaign_id)) == sequence(references[tester])
